"""Frames through the child that decodes: real files, broken files, a child that dies or hangs."""

import io
import os
import signal
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import psutil
import pytest

from common.body.observation import Landmarks
from common.video.clip_facts import ClipView
from common.video.decoding import DAMAGED, END, FRAME, HEADER, INFO, MAGIC, STALL_S, Decoder
from common.video.pictures import CameraLost, Decoded, DecoderDied, Image, Undecodable, Wanted
from viewer.capture import WAITING, Live, RoomClock, recorded
from viewer.captured_frame import CapturedFrame

SIZE = (64, 48)
FRAMES = 40


@pytest.fixture(scope="module")
def decoder() -> Iterator[Decoder]:
    with Decoder() as shared:
        yield shared


def picture_of(index: int, size: tuple[int, int] = SIZE) -> Image:
    """Grey, brighter with every frame: it can be told from its neighbours after JPEG."""
    return np.full((size[1], size[0], 3), 5 * (index % 40) + 20, np.uint8)


def written(path: Path, frames: int = FRAMES, size: tuple[int, int] = SIZE, fps: float = 15) -> str:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), fps, size)
    for index in range(frames):
        writer.write(picture_of(index, size))
    writer.release()
    return str(path)


def view_of(source: str | int, fps: float = 15.0, frames: int = FRAMES) -> ClipView:
    return ClipView(1, source, SIZE, SIZE, fps, frames)


def shown(picture: Image) -> int:
    """The index that a picture was written with."""
    return round((float(picture.mean()) - 20) / 5)


def uncompressed(path: Path, size: tuple[int, int] = (160, 120), frames: int = 20) -> str:
    """A bgr24 AVI as old capture cards write it: valid, bottom row first, and OpenCV aborts."""
    width, height = size
    rows = 3 * width * height

    def chunk(name: bytes, body: bytes) -> bytes:
        return name + struct.pack("<I", len(body)) + body

    head = (66667, rows * 15, 0, 16, frames, 0, 1, rows, width, height, 0, 0, 0, 0)
    stream = struct.pack(
        "<4s4sIHHIIIIIIII4H", b"vids", b"DIB ", 0, 0, 0, 0, 1, 15, 0, frames, rows, 0, 0, 0, 0,
        width, height,
    )  # fmt: skip
    form = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, rows, 0, 0, 0, 0)
    streams = chunk(b"LIST", b"strl" + chunk(b"strh", stream) + chunk(b"strf", form))
    header = chunk(b"LIST", b"hdrl" + chunk(b"avih", struct.pack("<14I", *head)) + streams)
    noise = np.random.default_rng(0)
    movie = b"".join(chunk(b"00db", noise.bytes(rows)) for _ in range(frames))
    path.write_bytes(chunk(b"RIFF", b"AVI " + header + chunk(b"LIST", b"movi" + movie)))
    return str(path)


def test_every_frame_comes_in_order_at_the_size_asked_for(tmp_path: Path, decoder: Decoder) -> None:
    video = written(tmp_path / "cam1.avi", size=(128, 96))
    frames = list(decoder.frames(video, SIZE))
    assert [frame.index for frame in frames] == list(range(FRAMES))
    assert [shown(frame.picture) for frame in frames] == list(range(FRAMES))
    assert {frame.picture.shape for frame in frames} == {(48, 64, 3)}
    assert decoder.ending.frames == FRAMES


def test_a_pixel_is_the_mean_of_what_it_covers(tmp_path: Path, decoder: Decoder) -> None:
    """P1: pictures are resampled by area, so a third of the size means the mean of nine."""
    full = np.random.default_rng(3).integers(0, 256, (144, 192, 3)).astype(np.uint8)
    cv2.imwrite(str(tmp_path / "plate.png"), full)
    (still,) = decoder.frames(str(tmp_path / "plate.png"), SIZE)
    means = full.reshape(48, 3, 64, 3, 3).mean(axis=(1, 3))
    assert np.abs(still.picture - means).max() <= 0.5


def test_a_second_larger_picture_comes_beside_the_first(tmp_path: Path, decoder: Decoder) -> None:
    video = written(tmp_path / "cam1.avi", size=(128, 96))
    both = list(decoder.frames(video, SIZE, Wanted(large=(128, 96))))
    alone = list(decoder.frames(video, SIZE))
    for one, same in zip(both, alone, strict=True):
        assert one.large is not None
        assert same.large is None
        assert one.large.shape == (96, 128, 3)
        np.testing.assert_array_equal(one.picture, same.picture)
        means = one.large.reshape(48, 2, 64, 2, 3).mean(axis=(1, 3))
        assert np.abs(one.picture - means).max() <= 0.5


def test_every_third_frame_keeps_its_index_and_the_rest_is_counted(
    tmp_path: Path, decoder: Decoder
) -> None:
    frames = list(decoder.frames(written(tmp_path / "cam1.avi"), SIZE, Wanted(3)))
    assert [frame.index for frame in frames] == list(range(0, FRAMES, 3))
    assert [shown(frame.picture) for frame in frames] == list(range(0, FRAMES, 3))
    assert decoder.ending.frames == FRAMES


def test_one_child_reads_video_after_video(tmp_path: Path, decoder: Decoder) -> None:
    videos = [written(tmp_path / f"{n}.avi", frames=n) for n in (3, 5, 8)]
    list(decoder.frames(videos[0], SIZE))
    pid = decoder.pid
    assert [len(list(decoder.frames(video, SIZE))) for video in videos] == [3, 5, 8]
    with pytest.raises(Undecodable):
        decoder.probe(str(tmp_path / "none.avi"))
    assert decoder.probe(videos[2]).frames == 8
    assert decoder.pid == pid


def test_a_video_left_in_the_middle_does_not_leak_into_the_next(
    tmp_path: Path, decoder: Decoder
) -> None:
    first, second = written(tmp_path / "1.avi"), written(tmp_path / "2.avi", frames=4)
    frames = decoder.frames(first, SIZE)
    next(frames)
    frames.close()
    assert [shown(frame.picture) for frame in decoder.frames(second, SIZE)] == [0, 1, 2, 3]


def test_the_probe_tells_size_rate_and_length(tmp_path: Path, decoder: Decoder) -> None:
    info = decoder.probe(written(tmp_path / "cam1.avi", frames=7, size=(160, 120), fps=25))
    assert (info.width, info.height, info.fps, info.frames) == (160, 120, 25.0, 7)


def test_a_film_that_aborts_opencv_costs_the_child_alone(tmp_path: Path) -> None:
    video, good = uncompressed(tmp_path / "raw.avi"), written(tmp_path / "cam1.avi")
    with Decoder() as own:
        with pytest.raises(DecoderDied, match=r"raw\.avi .* frames \(killed by SIG.*convert"):
            list(own.frames(video, SIZE))
        assert len(list(own.frames(good, SIZE))) == FRAMES


def test_a_killed_child_is_reported_with_how_far_it_came(tmp_path: Path) -> None:
    video = written(tmp_path / "cam1.avi", frames=400, size=(320, 240))
    with Decoder() as own:
        frames = own.frames(video, (320, 240))
        for _ in range(5):
            next(frames)
        assert own.pid is not None
        os.kill(own.pid, signal.SIGKILL)
        with pytest.raises(DecoderDied) as caught:
            list(frames)
    assert (caught.value.source, caught.value.how) == (video, "killed by SIGKILL")
    assert 5 <= caught.value.frames < 400
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_a_stuck_child_is_waited_for_in_bounded_time(tmp_path: Path) -> None:
    video = written(tmp_path / "cam1.avi", frames=400, size=(320, 240))
    with Decoder(stall_s=3.0) as own:  # a busy machine takes a second to start it
        frames = own.frames(video, (320, 240))
        next(frames)
        assert own.pid is not None
        os.kill(own.pid, signal.SIGSTOP)
        with pytest.raises(DecoderDied, match="gave nothing for 3 s"):
            list(frames)


TOLD_ALL_THE_TIME = """
import os, signal, sys, threading, time
from common.video.decoding import Decoder
signal.signal(signal.SIGINT, lambda *_: None)
def tell():
    while True:
        time.sleep(0.0005)
        os.killpg(0, signal.SIGINT)
threading.Thread(target=tell, daemon=True).start()
with Decoder() as own:
    print(len(list(own.frames(sys.argv[1], (320, 240)))))
"""


def test_ctrl_c_is_not_taken_for_a_broken_film(tmp_path: Path) -> None:
    """A terminal sends it to the process that will end the child in order, and to its group; the
    child may still be importing."""
    video = written(tmp_path / "cam1.avi", frames=400, size=(320, 240))
    done = subprocess.run(
        [sys.executable, "-c", TOLD_ALL_THE_TIME, video],
        capture_output=True,
        text=True,
        check=False,
        start_new_session=True,
    )
    assert (done.stdout, done.stderr) == ("400\n", "")


def test_what_opencv_prints_does_not_mix_with_the_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its log goes to standard output from the level INFO on."""
    monkeypatch.setenv("OPENCV_LOG_LEVEL", "VERBOSE")
    with Decoder() as own:
        assert len(list(own.frames(written(tmp_path / "cam1.avi"), SIZE))) == FRAMES


def babbles(monkeypatch: pytest.MonkeyPatch, answer: bytes) -> None:
    """Let decoders have a child that answers so, whatever it is asked."""
    platform = SimpleNamespace(child=partial(Babbler, answer))
    monkeypatch.setattr("common.video.decoding.platform", lambda: platform)


class Babbler:
    """A child that gives an answer of its own."""

    def __init__(self, answer: bytes, module: str, stall_s: float) -> None:
        self.said = io.BytesIO(answer)

    def ask(self, request: bytes) -> None: ...

    def read_into(self, room: memoryview) -> None:
        assert self.said.readinto(room) == len(room)

    def close(self) -> None: ...


@pytest.mark.parametrize(
    "answer",
    [
        b"INFO: a library talks" * 99,
        HEADER.pack(MAGIC, FRAME, 0, 0.0, 7) + bytes(7),
        HEADER.pack(MAGIC, INFO, 0, 0.0, 1 << 31),
    ],
    ids=["words", "short picture", "endless"],
)
def test_what_is_no_answer_ends_the_child(answer: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    babbles(monkeypatch, answer)
    own = Decoder()
    with pytest.raises(DecoderDied, match="sent what is no answer"):
        list(own.frames("cam1.avi", SIZE))
    assert own.pid is None


class Mortal(Babbler):
    """A child that may not be touched once it is closed."""

    def __init__(self, module: str, stall_s: float) -> None:
        super().__init__(b"", module, stall_s)
        self.calls: list[str] = []

    def kill(self) -> None:
        self.calls.append("kill")

    def close(self) -> None:
        self.calls.append("close")


class Hesitant(Decoder):
    """A decoder whose `stop` looks at the child so slowly that a `close` can come between."""

    def __init__(self) -> None:
        self.looking, self.closed = threading.Event(), threading.Event()
        self.child: Mortal | None = Mortal("", 0.0)
        super().__init__()
        self.child = Mortal("", 0.0)

    @property  # type: ignore[override]
    def _child(self) -> Mortal | None:
        child = self.child
        if threading.current_thread() is threading.main_thread():
            self.looking.set()
            self.closed.wait(0.2)
        return child

    @_child.setter
    def _child(self, child: Mortal | None) -> None:
        self.child = child


def test_a_decoder_can_be_stopped_while_its_reader_closes_it() -> None:
    """One after the other: a child that is gone is not killed, nor looked for in vain."""
    own = Hesitant()
    child = own.child

    def close() -> None:
        own.looking.wait()
        own.close()
        own.closed.set()

    reader = threading.Thread(target=close)
    reader.start()
    own.stop()
    reader.join()
    assert child is not None
    assert child.calls == ["kill", "close"]
    assert own.child is None


def test_a_decoder_that_was_stopped_begins_no_other_source(tmp_path: Path) -> None:
    """Who leaves a live view before its thread has begun to read does not wait for a picture."""
    source = written(tmp_path / "cam1.avi")
    with Decoder() as own:
        own.stop()
        with pytest.raises(DecoderDied, match="was stopped"):
            next(own.frames(source, SIZE))
        assert own.pid is None


def test_a_film_cut_off_gives_what_it_has_and_says_how_much(
    tmp_path: Path, decoder: Decoder
) -> None:
    whole = Path(written(tmp_path / "whole.avi", size=(320, 240)))
    cut = tmp_path / "cut.avi"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
    claimed = decoder.probe(str(cut)).frames
    frames = list(decoder.frames(str(cut), SIZE))
    assert [shown(frame.picture) for frame in frames[:10]] == list(range(10))
    assert decoder.ending.frames == len(frames) < claimed == FRAMES


@pytest.mark.parametrize("content", [None, b"", b"no film\n" * 99, b"RIFF\xff\xff\xff\x7fAVI LIST"])
def test_what_is_no_film_is_refused_in_one_line(
    tmp_path: Path, decoder: Decoder, content: bytes | None
) -> None:
    path = tmp_path / "cam1.avi"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(Undecodable, match=r"^[^\n]*cam1\.avi gives no picture: convert it[^\n]*$"):
        decoder.probe(str(path))


def test_a_camera_that_is_not_there_is_refused(decoder: Decoder) -> None:
    with pytest.raises(Undecodable, match="camera 63 gives no picture: see that it is plugged in"):
        decoder.probe(63)


def test_a_recorded_view_is_as_fast_as_it_can_and_keeps_the_cameras_times(
    tmp_path: Path, decoder: Decoder
) -> None:
    view = view_of(written(tmp_path / "cam1.avi"))
    frames = list(recorded(view, 2, decoder))
    assert [frame.captured_s for frame in frames] == [n / 15 for n in range(0, FRAMES, 2)]
    assert [frame.clock_s for frame in frames] == [frame.captured_s for frame in frames]


class Pointing:
    """A source outside that tells of each frame the shade of its larger picture."""

    large = (128, 96)

    def __init__(self, pause_s: float = 0.0) -> None:
        self.odd: tuple[str, ...] = ()
        self.asked: list[tuple[int, float]] = []
        self._pause_s = pause_s

    def people(self, decoded: Decoded, wait_s: float) -> tuple[Landmarks, ...]:
        assert decoded.large is not None
        assert decoded.large.shape == (96, 128, 3)
        self.asked.append((decoded.index, wait_s))
        time.sleep(self._pause_s)
        return (pointing(shown(decoded.large)),)


def pointing(shade: float) -> Landmarks:
    return Landmarks(joints_px=((shade, shade),) * 15, confidence=(1.0,) * 15)


def test_a_recorded_frame_comes_with_what_the_source_outside_sees_in_it(
    tmp_path: Path, decoder: Decoder
) -> None:
    view = view_of(written(tmp_path / "cam1.avi", size=(128, 96)))
    source = Pointing()
    frames = list(recorded(view, 2, decoder, source))
    assert [frame.landmarks for frame in frames] == [(pointing(n),) for n in range(0, FRAMES, 2)]
    assert [index for index, _ in source.asked] == [*range(0, FRAMES, 2)]
    assert {frame.picture.shape for frame in frames} == {(48, 64, 3)}


def test_without_a_source_outside_there_are_no_landmarks(tmp_path: Path, decoder: Decoder) -> None:
    view = view_of(written(tmp_path / "cam1.avi"))
    assert {frame.landmarks for frame in recorded(view, 1, decoder)} == {()}


def test_live_frames_have_the_landmarks_of_the_recording(tmp_path: Path, decoder: Decoder) -> None:
    view = view_of(written(tmp_path / "cam1.avi", size=(128, 96)), fps=100.0)
    source = Pointing()
    offline = {frame.index: frame.landmarks for frame in recorded(view, 1, decoder, Pointing())}
    with Live(view, 1, RoomClock(time.monotonic() + 0.2), source) as live:
        came = all_of(live)
    assert came
    assert all(frame.landmarks == offline[frame.index] for frame in came)
    assert {wait_s for _, wait_s in source.asked} == {1 / 100.0}  # no longer than to the next


def test_a_source_that_takes_its_time_costs_frames_and_not_their_order(tmp_path: Path) -> None:
    view = view_of(written(tmp_path / "cam1.avi", size=(128, 96)), fps=1000.0)
    with Live(view, 1, RoomClock(time.monotonic() + 0.2), Pointing(pause_s=0.01)) as live:
        came = all_of(live)
    assert [frame.landmarks for frame in came] == [(pointing(frame.index),) for frame in came]
    assert [frame.index for frame in came] == sorted(frame.index for frame in came)
    assert len(came) + live.dropped == FRAMES


def test_what_went_wrong_with_a_source_is_told_of_a_live_view(tmp_path: Path) -> None:
    source = Pointing()
    with Live(view_of(written(tmp_path / "a.avi")), 1, RoomClock(0.0), source) as live:
        before = live.odd
        source.odd = ("it is gone",)
        assert (before, live.odd) == ((), ("it is gone",))


def all_of(live: Live) -> list[CapturedFrame]:
    frames = []
    while not live.over:
        frame = live.take(5.0)
        if frame is not None:
            frames.append(frame)
    return frames


def test_live_frames_come_no_sooner_than_they_are_due(tmp_path: Path) -> None:
    view = view_of(written(tmp_path / "cam1.avi"), fps=100.0)
    start_s = time.monotonic() + 0.4
    with Live(view, 1, RoomClock(start_s + 1000.0, offset_s=1000.0)) as live:
        early_s = []
        while (frame := live.take(5.0)) is not None:
            assert frame.clock_s == start_s + 1000.0 + frame.captured_s
            early_s.append(frame.clock_s - 1000.0 - time.monotonic())
    assert max(early_s) <= 0.0
    assert len(early_s) + live.dropped == live.ending.frames == FRAMES


def test_a_late_reader_gets_the_newest_frames_and_the_loss_is_counted(tmp_path: Path) -> None:
    """The whole film is due at once and nobody reads: the oldest give way, no camera waits."""
    view = view_of(written(tmp_path / "cam1.avi"), fps=1e6)
    with Live(view, 1, RoomClock(start_s=time.monotonic() + 0.2)) as live:
        deadline = time.monotonic() + 5.0
        while live.ending.frames < FRAMES and time.monotonic() < deadline:
            time.sleep(0.01)
        assert live.dropped == FRAMES - WAITING
        assert [frame.index for frame in all_of(live)] == [FRAMES - 2, FRAMES - 1]
        assert live.take(60.0) is None


def test_a_live_film_that_breaks_the_decoder_tells_the_reader(tmp_path: Path) -> None:
    view = view_of(uncompressed(tmp_path / "raw.avi"))
    with Live(view, 1, RoomClock(time.monotonic())) as live, pytest.raises(DecoderDied):
        all_of(live)
    with (
        Live(view_of(str(tmp_path / "none.avi")), 1, RoomClock(0.0)) as nothing,
        pytest.raises(Undecodable),
    ):
        nothing.take(5.0)


def test_a_film_that_breaks_while_its_reader_works_is_not_over(tmp_path: Path) -> None:
    """Who looks at a frame when the decoder dies hears of it as who waits for the next does."""
    view = view_of(uncompressed(tmp_path / "raw.avi"))
    before = set(threading.enumerate())
    with Live(view, 1, RoomClock(time.monotonic())) as live:
        for thread in set(threading.enumerate()) - before:
            thread.join()
        with pytest.raises(DecoderDied):
            all_of(live)


def test_a_camera_that_is_unplugged_is_not_over(monkeypatch: pytest.MonkeyPatch) -> None:
    """Linux says that there is no further frame, as behind a film's last one."""
    picture = picture_of(0).tobytes()
    answer = HEADER.pack(MAGIC, INFO, 0, 0.0, 2) + b"{}"
    answer += HEADER.pack(MAGIC, FRAME, 0, time.monotonic() + 0.2, len(picture)) + picture
    answer += HEADER.pack(MAGIC, END, 1, 0.0, DAMAGED.size) + DAMAGED.pack(0)
    babbles(monkeypatch, answer)
    with Live(view_of(0, frames=0), 1, RoomClock(0.0)) as live:
        assert live.take(5.0) is not None
        with pytest.raises(CameraLost, match="camera 0 gives no more pictures after 1: see that"):
            live.take(5.0)
    with Live(view_of("cam1.avi"), 1, RoomClock(time.monotonic() + 0.2)) as live:
        assert len(all_of(live)) == 1


def test_a_live_view_reads_by_the_decoder_that_is_there_already(tmp_path: Path) -> None:
    view = view_of(written(tmp_path / "cam1.avi"))
    with Decoder() as own:
        own.start(view.source)
        begun = own.pid
        with Live(view, 1, RoomClock(time.monotonic() + 0.2), decoder=own) as live:
            assert live.take(5.0) is not None
            assert own.pid == begun is not None


def test_a_live_view_can_be_left_at_any_moment(tmp_path: Path) -> None:
    view = view_of(written(tmp_path / "cam1.avi"))
    with Live(view, 1, RoomClock(time.monotonic() + 1e6)) as live:
        assert live.take(0.05) is None
        assert not live.over
    assert live.over


def test_a_view_whose_decoder_is_stuck_can_be_left(tmp_path: Path) -> None:
    large = (640, 480)
    video = written(tmp_path / "cam1.avi", frames=200, size=large)
    began_s = time.monotonic()
    with Live(ClipView(1, video, large, large, 100.0, 200), 1, RoomClock(began_s)) as live:
        assert live.take(5.0) is not None
        child = max(psutil.Process().children(), key=psutil.Process.create_time)
        child.suspend()
        while live.take(0.2) is not None:
            pass
        assert not live.over
    assert time.monotonic() - began_s < STALL_S / 2


@pytest.mark.parametrize("folder", ["kth_160x120", "le2i", "weizmann"])
def test_filmed_people_are_read_to_their_end(data_dir: Path, decoder: Decoder, folder: str) -> None:
    for video in sorted((data_dir / "real" / folder).glob("*.[am][vk][iv]")):
        claimed = decoder.probe(str(video)).frames
        indices = [frame.index for frame in decoder.frames(str(video), (160, 120), Wanted(20))]
        assert indices == list(range(0, claimed, 20))
        assert decoder.ending.frames == claimed


class KeptHere:
    """Keeps pictures in memory."""

    odd = ("slow disk",)

    def __init__(self) -> None:
        self.taken: list[tuple[Image, float]] = []

    def take(self, picture: Image, taken_s: float) -> None:
        self.taken.append((picture, taken_s))


@pytest.mark.parametrize("size", [SIZE, (128, 96)])
def test_whole_pictures_are_kept_where_that_is_asked_for(
    tmp_path: Path, size: tuple[int, int]
) -> None:
    """Also those that a late viewer never sees; what it looks at stays as small as it was."""
    source = written(tmp_path / "cam1.avi", frames=8, size=size, fps=100)
    view, kept = ClipView(1, source, size, SIZE, 100.0, 8), KeptHere()
    room = RoomClock(time.monotonic() + 0.3)
    with Live(view, 1, room, kept=kept) as live:  # type: ignore[arg-type]
        while len(kept.taken) < 8:
            time.sleep(0.01)
        frame = live.take(1.0)
        assert live.odd == ("slow disk",)
    assert frame is not None
    assert (frame.index, frame.picture.shape) == (8 - WAITING, (48, 64, 3))
    assert [shown(picture) for picture, _ in kept.taken] == list(range(8))
    assert {picture.shape for picture, _ in kept.taken} == {(size[1], size[0], 3)}
    assert [taken_s for _, taken_s in kept.taken] == pytest.approx([n / 100 for n in range(8)])
