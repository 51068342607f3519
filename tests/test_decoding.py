"""What is asked of a decoder's child and made of its answers, by a child that has a script."""

import io
import json
from typing import Any

import numpy as np
import pytest

from common.platform.platform import Broken
from common.video import decoding
from common.video.decoding import (
    DAMAGED,
    END,
    FRAME,
    HEADER,
    INFO,
    MAGIC,
    MAX_TEXT_BYTES,
    REFUSED,
    SKIPPED,
    TIMES,
    Decoder,
)
from common.video.pictures import (
    CameraLost,
    Decoded,
    DecoderDied,
    Ending,
    Undecodable,
    VideoInfo,
    Wanted,
    cure,
    named,
)


def said(kind: bytes, payload: bytes = b"", index: int = 0, grabbed_s: float = 0.0) -> bytes:
    return HEADER.pack(MAGIC, kind, index, grabbed_s, len(payload)) + payload


def picture(index: int, width: int, height: int) -> bytes:
    return bytes((index + n) % 256 for n in range(3 * width * height))


INFO_SAID = said(INFO, b'{"width": 64, "height": 48, "fps": 12.5, "frames": 7}')


class Scripted:
    """Children that answer what is left of a script, and then die."""

    def __init__(self, *answers: bytes) -> None:
        self.answers = [*answers]
        self.begun: list[tuple[str, float]] = []
        self.asked: list[dict[str, Any]] = []
        self.done: list[str] = []
        self.pid = 4711

    def child(self, module: str, stall_s: float) -> "Scripted":
        self.begun.append((module, stall_s))
        return self

    def ask(self, request: bytes) -> None:
        self.asked.append(json.loads(request))
        self.left = io.BytesIO(self.answers.pop(0))

    def read_into(self, room: memoryview) -> None:
        if self.left.readinto(room) != len(room):
            raise Broken("exit code 3")

    def kill(self) -> None:
        self.done.append("killed")

    def close(self) -> None:
        self.done.append("closed")


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> Scripted:
    child = Scripted()
    monkeypatch.setattr(decoding, "platform", lambda: child)
    return child


def test_a_probe_asks_for_no_size_and_joins_the_times(script: Scripted) -> None:
    times = [np.array(some, "<f8").tobytes() for some in ([0.0, 0.1, 0.3], [0.35])]
    script.answers = [INFO_SAID + said(TIMES, times[0]) + said(TIMES, times[1])]
    script.answers[0] += said(END, DAMAGED.pack(0), 1)
    assert Decoder().pid is None
    own = Decoder(stall_s=2.5)
    assert own.probe("a.avi") == VideoInfo(64, 48, 12.5, 7, (0.0, 0.1, 0.3, 0.35))
    assert script.begun == [("common.video.decoder", 2.5)]
    due = {"source": "a.avi", "sizes": [], "every": 1, "start": 0, "quarters": 0}
    assert script.asked == [due]
    assert own.pid == 4711
    assert script.done == []


def test_a_camera_has_no_times(script: Scripted) -> None:
    script.answers = [INFO_SAID + said(END, DAMAGED.pack(0), 1)]
    assert Decoder().probe(3).shown_s == ()
    assert script.asked[0]["source"] == 3


def test_frames_have_both_pictures_from_the_start_on_and_the_end_is_kept(script: Scripted) -> None:
    """The very first is decoded too, to learn what the source is; it was not asked for."""
    frames = [
        said(FRAME, picture(n, 4, 3) + picture(9 * n, 2, 5), n, 10.0 + n) for n in (0, 5, 6, 8)
    ]
    script.answers = [INFO_SAID + frames[0] + said(SKIPPED, b"", 1) + b"".join(frames[1:])]
    script.answers[0] += said(END, DAMAGED.pack(3), 11)
    own = Decoder()
    wanted = Wanted(every=2, start=6, large=(2, 5), quarters=3)
    got = list(own.frames("a.avi", (4, 3), wanted))
    assert [(one.index, one.grabbed_s) for one in got] == [(6, 16.0), (8, 18.0)]
    for one in got:
        assert one.large is not None
        assert (one.picture.shape, one.large.shape) == ((3, 4, 3), (5, 2, 3))
        assert one.picture.tobytes() == picture(one.index, 4, 3)
        assert one.large.tobytes() == picture(9 * one.index, 2, 5)
    assert own.ending == Ending(11, 3)
    due = {"source": "a.avi", "sizes": [[4, 3], [2, 5]], "every": 2, "start": 6, "quarters": 3}
    assert script.asked == [due]


def test_one_size_has_one_picture(script: Scripted) -> None:
    frame = said(FRAME, picture(0, 4, 3))
    script.answers = [INFO_SAID + frame + said(END, DAMAGED.pack(0), 1)]
    (only,) = Decoder().frames("a.avi", (4, 3))
    assert only.large is None
    assert script.asked[0]["sizes"] == [[4, 3]]


def test_a_refusal_is_one_and_the_child_serves_on(script: Scripted) -> None:
    script.answers = [said(REFUSED, b"a.txt gives no picture"), INFO_SAID + said(END, bytes(4))]
    own = Decoder()
    with pytest.raises(Undecodable, match=r"^a\.txt gives no picture$"):
        own.probe("a.txt")
    own.probe("b.avi")
    assert (len(script.begun), script.done) == (1, [])


def test_a_child_that_died_is_told_with_how_many_frames_came_and_replaced(script: Scripted) -> None:
    frames = (
        said(FRAME, picture(0, 4, 3)) + said(SKIPPED, b"", 1) + said(FRAME, picture(2, 4, 3), 2)
    )
    script.answers = [INFO_SAID + frames, INFO_SAID + said(END, bytes(4))]
    own, came = Decoder(), list[Decoded]()
    with pytest.raises(DecoderDied) as caught:
        came.extend(own.frames("a.avi", (4, 3)))
    assert (caught.value.source, caught.value.frames, caught.value.how) == (
        "a.avi",
        2,
        "exit code 3",
    )
    assert str(caught.value).startswith(
        "a.avi broke the decoder after 2 frames (exit code 3): conv"
    )
    assert script.done == ["closed"]
    assert own.pid is None
    own.probe("b.avi")
    assert len(script.begun) == 2


def test_a_source_left_in_its_middle_costs_the_child(script: Scripted) -> None:
    script.answers = [INFO_SAID + 2 * said(FRAME, picture(0, 4, 3))]
    with Decoder() as own:
        frames = own.frames("a.avi", (4, 3))
        next(frames)
        assert script.done == []
        frames.close()
        assert (script.done, own.pid) == (["closed"], None)
    assert script.done == ["closed"]


def test_a_decoder_that_was_stopped_kills_its_child_and_begins_none(script: Scripted) -> None:
    script.answers = [INFO_SAID + said(END, bytes(4))]
    own = Decoder()
    own.probe("a.avi")
    own.stop()
    assert script.done == ["killed"]
    with pytest.raises(
        DecoderDied, match=r"^camera 2 broke the decoder after 0 frames \(it was sto"
    ):
        own.probe(2)
    own.close()
    assert script.done == ["killed", "closed"]
    never = Decoder()
    never.stop()
    never.close()
    assert len(script.begun) == 1


@pytest.mark.parametrize(
    "answer",
    [
        HEADER.pack(b"ttf0", INFO, 0, 0.0, 2) + b"{}",
        said(INFO, b" " * (MAX_TEXT_BYTES + 1)),
        said(END, bytes(3)),
        said(END, bytes(5)),
        said(FRAME, picture(0, 4, 3) + b"1"),
        said(FRAME, picture(0, 4, 3)[1:]),
    ],
    ids=["magic", "text", "short end", "long end", "long picture", "short picture"],
)
def test_what_is_no_answer_breaks_the_source(script: Scripted, answer: bytes) -> None:
    script.answers = [answer]
    with pytest.raises(DecoderDied, match="it sent what is no answer"):
        list(Decoder().frames("a.avi", (4, 3)))
    assert script.done == ["closed"]


def test_a_picture_that_was_not_asked_for_is_no_answer_and_a_long_text_is_one(
    script: Scripted,
) -> None:
    script.answers = [said(FRAME)]
    with pytest.raises(DecoderDied, match="no answer"):
        Decoder().probe("a.avi")
    script.answers = [said(REFUSED, b"x" * MAX_TEXT_BYTES)]
    with pytest.raises(Undecodable, match=f"^x{{{MAX_TEXT_BYTES}}}$"):
        Decoder().probe("a.avi")


def test_a_source_is_named_with_its_cure() -> None:
    assert (named(0), named("a/b.avi")) == ("camera 0", "a/b.avi")
    assert str(CameraLost(2, 31)) == (
        "camera 2 gives no more pictures after 31: see that it is plugged in and that no other "
        "program holds it"
    )
    assert CameraLost(2, 31).how == "no more pictures"
    for name in ("a.png", "a.JPG", "a.tiff"):
        assert cure(name) == "save the picture anew, as PNG or JPEG"
    assert cure("a.mp4").startswith("convert it, for example to MJPEG (ffmpeg -i IN -c:v mjpeg")
    assert cure("a.mp4").endswith("or copy it again where it was cut off")


def test_a_child_may_begin_before_its_first_source_which_it_then_reads(script: Scripted) -> None:
    script.answers = [INFO_SAID + said(END, DAMAGED.pack(0), 1)]
    own = Decoder()
    own.start("a.avi")
    assert (len(script.begun), own.pid, script.asked) == (1, 4711, [])
    assert own.probe("a.avi").frames == 7
    assert len(script.begun) == 1
    own.stop()
    with pytest.raises(DecoderDied, match="it was stopped"):
        own.start("a.avi")
