"""The child that decodes, within this process: what it answers of made-up captures."""

import io
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import cv2
import numpy as np
import pytest

from common.platform.platform import Asker
from common.video import decoder
from common.video.decoder import Grabbed, OpenVideo, Refused, grabs, judged, opened, say
from common.video.decoding import DAMAGED, END, FRAME, HEADER, INFO, MAGIC, REFUSED, SKIPPED, TIMES
from common.video.pictures import Image, Source
from common.video.reduction import reduced


class Capture:
    """A capture of so many frames; each grab takes 2 s and each picture 5 s of a clock."""

    now_s = 100.0

    def __init__(self, frames: int, fps: float = 12.5, count: float = 0.0) -> None:
        self.left, self.at = frames, -1
        self.facts = {
            cv2.CAP_PROP_FPS: fps,
            cv2.CAP_PROP_FRAME_COUNT: count,
            cv2.CAP_PROP_FOURCC: 0.0,
        }

    def grab(self) -> bool:
        self.at += 1
        self.now_s += 2.0
        return self.at < self.left

    def retrieve(self) -> tuple[bool, Image]:
        self.now_s += 5.0
        return True, picture_of(self.at)

    def get(self, fact: int) -> float:
        return self.facts[fact]


class Words:
    """What FFmpeg complains of, in turn; nothing after that."""

    def __init__(self, *said: bytes) -> None:
        self.said = [*said]

    def taken(self) -> bytes:
        return self.said.pop(0) if self.said else b""


class Answers(io.BytesIO):
    """A pipe that knows what had gone into it at each flush."""

    def __init__(self) -> None:
        super().__init__()
        self.flushed: list[int] = []

    def flush(self) -> None:
        self.flushed.append(self.tell())

    def parted(self) -> Iterator[tuple[bytes, int, float, bytes]]:
        """Kind, index, time and what follows of each answer."""
        left = self.getvalue()
        while left:
            magic, kind, index, grabbed_s, length = HEADER.unpack(left[: HEADER.size])
            assert magic == MAGIC
            payload, left = left[HEADER.size :][:length], left[HEADER.size + length :]
            assert len(payload) == length
            yield kind, index, grabbed_s, payload


def picture_of(index: int, height: int = 6, width: int = 8) -> Image:
    return np.random.default_rng(index).integers(0, 256, (height, width, 3), dtype=np.uint8)


def request(**other: object) -> dict[str, Any]:
    return {"source": "a.avi", "sizes": [], "every": 1, "start": 0, "quarters": 0, **other}


def served(
    monkeypatch: pytest.MonkeyPatch, taken: list[Grabbed], *said: bytes, **asked: object
) -> list[tuple[bytes, int, float, bytes]]:
    """What is answered of a film of 29.5 pictures a second that claims 7."""

    def film(source: Source, every: int, start: int, _: object) -> OpenVideo:
        assert (source, every, start) == ("a.avi", asked.get("every", 1), asked.get("start", 0))
        return OpenVideo(29.5, 7, iter(taken))

    answers = Answers()
    monkeypatch.setattr(decoder, "opened", film)
    monkeypatch.setattr("time.monotonic", lambda: 77.0)
    decoder.serve(request(**asked), answers, Words(*said))  # type: ignore[arg-type]
    return [*answers.parted()]


def test_every_third_frame_from_the_fifth_on_is_decoded_and_the_very_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    capture: Any = Capture(11)
    monkeypatch.setattr("time.monotonic", lambda: capture.now_s)
    taken = [*grabs(capture, 3, 5)]
    assert [grab.index for grab in taken] == [*range(11)]
    assert [grab.index for grab in taken if grab.picture is not None] == [0, 6, 9]
    for index in (0, 6, 9):
        np.testing.assert_array_equal(taken[index].picture, picture_of(index))
    assert [grab.grabbed_s for grab in taken[:3]] == [102.0, 109.0, 111.0]  # before it is decoded
    assert not any(grab.damaged for grab in taken)


def test_from_the_frame_that_is_asked_for_on_each_is_decoded() -> None:
    capture: Any = Capture(6)
    decoded = [grab.index for grab in grabs(capture, 1, 4) if grab.picture is not None]
    assert decoded == [0, 4, 5]


def test_a_frame_is_damaged_when_something_is_said_of_it_and_it_is_not_the_first() -> None:
    words: Any = Words(b"no keyframe", b"", b"error while decoding MB 3 4", b"")
    taken = [Grabbed(n, 10.0 + n, None) for n in range(4)]
    marked = [*judged(iter(taken), "a.avi", words)]
    assert [grab.damaged for grab in marked] == [False, False, True, False]
    assert [(grab.index, grab.grabbed_s) for grab in marked] == [(n, 10.0 + n) for n in range(4)]


def test_a_frame_of_fields_is_refused_with_the_file_and_the_cure() -> None:
    words: Any = Words(b"", b"swscale: interlaced picture")
    marked = judged(iter([Grabbed(n, 0.0, None) for n in range(3)]), "b.dv", words)
    assert next(marked).index == 0
    with pytest.raises(Refused, match=r"^b\.dv is interlaced: make it progressive \(ffmpeg -i IN"):
        next(marked)


def test_a_pixel_is_the_mean_of_what_it_covers_also_when_turned() -> None:
    """By hand: a clockwise quarter turn takes the left column, from its foot up, to the top row."""
    large = picture_of(3)
    means = large.reshape(3, 2, 4, 2, 3).mean(axis=(1, 3))
    lying = reduced(large, (4, 3), 0)
    assert np.abs(lying - means).max() <= 0.5
    once, twice, thrice = (
        reduced(large, size, n) for n, size in ((1, (3, 4)), (2, (4, 3)), (3, (3, 4)))
    )
    assert (once.shape, twice.shape, thrice.shape) == ((4, 3, 3), (3, 4, 3), (4, 3, 3))
    for row in range(3):
        for column in range(4):
            there = lying[row, column].tolist()
            assert once[column, 2 - row].tolist() == there
            assert twice[2 - row, 3 - column].tolist() == there
            assert thrice[3 - column, row].tolist() == there
    assert once.flags.c_contiguous


def test_a_picture_that_has_its_size_is_not_touched() -> None:
    large = picture_of(1)
    assert reduced(large, (8, 6), 0) is large
    np.testing.assert_array_equal(reduced(large, [8, 6], 2), large[::-1, ::-1])


def test_an_answer_has_its_number_its_time_and_its_parts_in_order_and_pictures_go_at_once() -> None:
    answers = Answers()
    say(answers, SKIPPED, Grabbed(200, 3.25, None))
    assert answers.flushed == []
    say(answers, FRAME, Grabbed(7, 1.5, None), b"abc", np.array([[1, 2]], np.uint16).data)
    assert answers.flushed == [2 * HEADER.size + 7]
    say(answers, INFO, None, b"{}")
    assert answers.flushed == [2 * HEADER.size + 7]
    assert [*answers.parted()] == [
        (SKIPPED, 200, 3.25, b""),
        (FRAME, 7, 1.5, b"abc\x01\x00\x02\x00"),
        (INFO, 0, 0.0, b"{}"),
    ]


def test_frames_are_answered_at_each_size_and_the_end_counts_them_and_their_damage(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    taken = [
        Grabbed(0, 5.0, picture_of(0)),
        Grabbed(1, 6.0, None, damaged=True),
        Grabbed(2, 7.0, picture_of(2), damaged=True),
    ]
    sizes = [(4, 3), (8, 6)]
    info, *frames, end = served(monkeypatch, taken, b"of another", b"lost", sizes=sizes)
    assert info[:3] == (INFO, 0, 0.0)
    assert json.loads(info[3]) == {"width": 8, "height": 6, "fps": 29.5, "frames": 7}
    assert [answer[:3] for answer in frames] == [(FRAME, 0, 5.0), (FRAME, 2, 7.0)]
    for _, index, _, payload in frames:
        large = picture_of(index)
        assert payload == reduced(large, (4, 3), 0).tobytes() + large.tobytes()
    assert end == (END, 3, 77.0, DAMAGED.pack(3))  # two frames, and what is said behind the last


def test_a_whole_film_has_no_damage(monkeypatch: pytest.MonkeyPatch) -> None:
    taken = [Grabbed(n, 1.0, picture_of(n)) for n in range(2)]
    *_, end = served(monkeypatch, taken, b"of the source before", sizes=[(8, 6)])
    assert end[1:] == (2, 77.0, DAMAGED.pack(0))


def test_frames_are_answered_turned(monkeypatch: pytest.MonkeyPatch) -> None:
    taken = [Grabbed(0, 5.0, picture_of(9))]
    _, frame, _ = served(monkeypatch, taken, sizes=[(6, 8)], quarters=3)
    assert frame[3] == np.ascontiguousarray(np.rot90(picture_of(9), 1)).tobytes()


def test_of_each_hundredth_frame_that_is_passed_over_the_asker_hears(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    picture = picture_of(0)
    taken = [Grabbed(n, float(n), picture if n in (0, 200, 203) else None) for n in range(305)]
    asked = {"every": 203, "start": 150, "sizes": [(8, 6)]}
    _, *answered, end = served(monkeypatch, taken, **asked)
    said = [(kind, index) for kind, index, _, _ in answered]
    assert said == [(FRAME, 0), (SKIPPED, 100), (FRAME, 200), (FRAME, 203), (SKIPPED, 300)]
    assert end[1] == 305


def test_a_sign_of_life_does_not_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    taken = [Grabbed(0, 0.0, picture_of(0)), Grabbed(100, 1.0, None)]
    monkeypatch.setattr(decoder, "opened", lambda *_: OpenVideo(1.0, 2, iter(taken)))
    answers, words = Answers(), cast(Any, Words())
    decoder.serve(request(sizes=[(8, 6)]), answers, words)
    parts = [HEADER.size + len(payload) for *_, payload in answers.parted()]
    assert answers.flushed == [sum(parts[:2]), sum(parts[:3])]


def test_what_comes_before_the_first_picture_is_passed_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    taken = [Grabbed(0, 5.0, None), Grabbed(1, 6.0, picture_of(1)), Grabbed(2, 7.0, picture_of(2))]
    _, *frames, end = served(monkeypatch, taken, sizes=[(8, 6)])
    assert [index for _, index, _, _ in frames] == [1, 2]
    assert end[1] == 3


def test_a_source_without_a_picture_is_refused_with_its_name_and_cure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(Refused, match=r"^a\.avi gives no picture: convert it, for example to MJP"):
        served(monkeypatch, [Grabbed(0, 0.0, None)], sizes=[(8, 6)])


def test_a_probe_decodes_one_picture_and_gets_the_times(monkeypatch: pytest.MonkeyPatch) -> None:
    taken = [Grabbed(0, 5.0, picture_of(0)), Grabbed(1, 6.0, picture_of(1), damaged=True)]

    def times(source: Source, answers: Any) -> None:
        say(answers, TIMES, None, str(source).encode())

    monkeypatch.setattr(decoder, "say_times", times)
    info, told, end = served(monkeypatch, taken)
    assert (info[0], told) == (INFO, (TIMES, 0, 0.0, b"a.avi"))
    assert end == (END, 1, 77.0, DAMAGED.pack(0))


def test_a_still_picture_is_a_film_of_one_frame(tmp_path: Path) -> None:
    words: Any = Words()
    path = str(tmp_path / "plate.png")
    cv2.imwrite(path, picture_of(4))
    film = opened(path, 5, 3, words)
    assert (film.fps, film.frames) == (0.0, 1)
    (only,) = film.grabs
    assert only.index == 0
    np.testing.assert_array_equal(only.picture, picture_of(4))


def test_what_a_capture_does_not_know_is_0_and_a_file_alone_is_judged(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Source] = []

    def capture(source: Source) -> Capture:
        asked.append(source)
        return Capture(5, *((-1.0, -3.0) if source == 2 else (12.5, 4.6)))

    monkeypatch.setattr("cv2.VideoCapture", capture)
    said = (b"", b"damage", b"", b"damage", b"")
    ours: Any = Words(*said)
    camera, file = opened(2, 2, 3, ours), opened("none.avi", 2, 3, ours)
    assert asked == [2, "none.avi"]
    assert (camera.fps, camera.frames, file.fps, file.frames) == (0.0, 0, 12.5, 5)
    assert [grab.damaged for grab in camera.grabs] == [False] * 5
    assert ours.said == [*said]
    taken = [*file.grabs]
    assert [grab.damaged for grab in taken] == [False, True, False, True, False]
    assert [grab.index for grab in taken if grab.picture is not None] == [0, 4]


def test_the_times_of_packets_come_in_parts_and_end_with_one_that_is_not_full(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(decoder, "TIMES_AT_ONCE", 3)
    path = str(tmp_path / "a.avi")
    writer = cv2.VideoWriter(path, cv2.VideoWriter.fourcc(*"MJPG"), 8.0, (64, 48))
    for n in range(7):
        writer.write(np.full((48, 64, 3), 9 * n, np.uint8))
    writer.release()
    answers = Answers()
    decoder.say_times(path, answers)
    parts = [*answers.parted()]
    assert [kind for kind, *_ in parts] == [TIMES] * 3
    times = [np.frombuffer(payload, "<f8") for *_, payload in parts]
    assert [len(some) for some in times] == [3, 3, 1]
    assert np.concatenate(times) == pytest.approx(np.arange(7) / 8)
    assert answers.flushed == np.cumsum([len(p) + HEADER.size for *_, p in parts]).tolist()


def test_a_camera_and_a_picture_have_no_times(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "plate.png"), picture_of(4))
    answers = Answers()
    decoder.say_times(0, answers)
    decoder.say_times(str(tmp_path / "plate.png"), answers)
    assert answers.getvalue() == b""


def test_a_refusal_is_an_answer_and_the_next_source_is_served(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The main job, without a child: two requests, the first of which is refused."""
    read, write = os.pipe()
    os.set_blocking(read, False)
    done: list[Any] = []
    came: list[bytes] = []

    def serve(asked: dict[str, Any], answers: Any, _: object) -> None:
        done.append(asked)
        if asked["source"] == "bad":
            raise Refused("bad is bad: mend it")
        came.append(os.read(read, 1 << 12))  # what was answered before does not wait
        say(answers, INFO, None, b"good")

    with os.fdopen(read, "rb") as heard, os.fdopen(write, "wb") as said:
        lines = io.BytesIO(b'{"source": "bad"}\n{"source": "good"}\n')
        monkeypatch.setattr(decoder, "Complaints", Words)
        monkeypatch.setattr(decoder, "serve", serve)
        monkeypatch.setattr("cv2.setNumThreads", done.append)
        decoder.main(Asker(lines, said))
        answers = Answers()
        answers.write(came[0] + os.read(heard.fileno(), 1 << 12))
        assert done == [1, {"source": "bad"}, {"source": "good"}]
    assert [*answers.parted()] == [
        (REFUSED, 0, 0.0, b"bad is bad: mend it"),
        (INFO, 0, 0.0, b"good"),
    ]
