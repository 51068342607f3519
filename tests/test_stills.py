"""The marking page's pictures: which stills of a film, a camera's newest, and all of one size."""

import threading
import time
from collections.abc import Generator, Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from pole_room import SIZE, write_films
from rich.console import Console

from animator.marking.marking_page import LIVE
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.video.clip_sources import ClipError
from common.video.pictures import Decoded, DecoderDied, Image, Size, Source
from tritrack.marking import stills
from tritrack.marking.stills import MOST_STILLS, Album, Running, common_size, open_album

QUIET = Console(quiet=True)


def grey(jpeg: bytes | None) -> float:
    """Of the wall, at a corner."""
    assert jpeg is not None
    picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    return float(picture[:20, :20].mean())


def test_the_stills_of_a_film_are_its_frames_in_order(tmp_path: Path) -> None:
    with open_album(Settings(clip=str(write_films(tmp_path / "room"))), QUIET) as album:
        assert album.size == SIZE
        first, second = album.pictures
        assert first.stills == ("/still/1/0.jpg", *(f"/still/1/{n}.jpg" for n in (1, 2, 3)))
        assert (first.frames, second.number, second.runs) == ((0, 1, 2, 3), 2, False)
        for place in range(4):
            assert grey(album.jpeg(2, place)) == pytest.approx(100 + 15 * place, abs=3)
        assert [album.jpeg(1, place) for place in (4, LIVE, 999_999)] == [None] * 3
        assert album.jpeg(3, 0) is None
        album.refuse_fault()


def test_a_long_film_is_shown_in_evenly_spread_stills(tmp_path: Path) -> None:
    """Their number is bounded, however long it is, and they reach its end."""
    path, count = tmp_path / "long.avi", 3 * MOST_STILLS + 17
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 15.0, (64, 48))
    for n in range(count):
        writer.write(np.full((48, 64, 3), n % 200, np.uint8))
    writer.release()
    settings = Settings(cameras={"cam1": CameraSettings(source=str(path))})
    with open_album(settings, QUIET) as album:
        (film,) = album.pictures
        assert MOST_STILLS / 2 < len(film.stills) <= MOST_STILLS
        assert np.unique(np.diff(film.frames)).size == 1
        assert film.frames[-1] >= count - 4


def test_a_photograph_is_a_film_of_one_still(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "photo.png"), np.full((48, 64, 3), 90, np.uint8))
    settings = Settings(cameras={"cam2": CameraSettings(source=str(tmp_path / "photo.png"))})
    with open_album(settings, QUIET) as album:
        assert [(each.number, each.frames) for each in album.pictures] == [(2, (0,))]
        assert grey(album.jpeg(2, 0)) == pytest.approx(90, abs=2)


def test_pictures_of_both_cameras_are_shown_at_one_size_that_is_bounded() -> None:
    assert common_size([(640, 480), (320, 240)]) == (320, 240)
    assert common_size([(3840, 2160), (3840, 2160)]) == (1920, 1080)
    with pytest.raises(ClipError, match="640x360 and 640x480"):
        common_size([(640, 480), (640, 360)])


def test_films_that_are_not_there_are_named(tmp_path: Path) -> None:
    for settings, says in (
        (Settings(), "nothing to look at"),
        (Settings(clip=str(tmp_path)), r"neither cam1.\* nor cam2"),
        (
            Settings(cameras={"cam1": CameraSettings(source="gone.avi")}),
            "there is no file gone.avi",
        ),
    ):
        with pytest.raises(ClipError, match=says), open_album(settings, QUIET):
            pass


class Camera:
    """A camera whose pictures grow lighter and begin anew, until it is stopped or pulled."""

    def __init__(self) -> None:
        self.stopped, self.pulled = threading.Event(), threading.Event()

    def frames(self, source: Source, size: Size) -> Generator[Decoded, None, None]:
        for n in range(10_000):
            picture: Image = np.full((size[1], size[0], 3), 20 + n % 200, np.uint8)
            yield Decoded(n, 0.0, picture)
            if self.stopped.wait(0.02) or self.pulled.is_set():
                raise DecoderDied(source, n, "killed")

    def stop(self) -> None:
        self.stopped.set()


@pytest.fixture
def camera() -> Iterator[Camera]:
    one = Camera()
    yield one
    one.stop()


def test_a_camera_that_runs_shows_its_newest_picture(camera: Camera) -> None:
    running = Running(camera, 0, (64, 48))
    album = Album((64, 48), {1: running})
    assert album.pictures[0].stills == ("/still/1/live.jpg",)
    assert album.pictures[0].runs
    first = grey(album.jpeg(1, LIVE))
    until_s = time.monotonic() + 5.0
    while grey(album.jpeg(1, LIVE)) < first + 10 and time.monotonic() < until_s:
        time.sleep(0.01)
    assert grey(album.jpeg(1, LIVE)) >= first + 10
    assert album.jpeg(1, 0) is None
    running.close()
    album.refuse_fault()


def test_a_camera_that_is_pulled_out_is_told(camera: Camera) -> None:
    running = Running(camera, 0, (64, 48))
    camera.pulled.set()
    until_s = time.monotonic() + 5.0
    while running.fault is None and time.monotonic() < until_s:
        time.sleep(0.01)
    with pytest.raises(DecoderDied, match="camera 0 broke the decoder"):
        Album((64, 48), {1: running}).refuse_fault()
    running.close()


class Faulty:
    """A reader that breaks in a way that nobody thought of."""

    def frames(self, source: Source, size: Size) -> Generator[Decoded, None, None]:
        raise ZeroDivisionError(f"{source} {size}")
        yield

    def stop(self) -> None:
        """Nothing goes on."""


def test_any_error_of_a_cameras_thread_is_kept_for_who_waits_for_its_picture() -> None:
    """Who opens the camera does not wait for ever."""
    opened: list[Running] = []
    waiting = threading.Thread(
        target=lambda: opened.append(Running(Faulty(), 0, (64, 48))), daemon=True
    )
    waiting.start()
    waiting.join(10.0)
    assert not waiting.is_alive()
    with pytest.raises(ZeroDivisionError):
        Album((64, 48), {1: opened[0]}).refuse_fault()


def test_a_camera_that_gives_no_picture_is_not_waited_for_for_ever(
    camera: Camera, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stills, "FIRST_S", 0.05)
    monkeypatch.setattr(camera, "frames", lambda *_: camera.stopped.wait(10.0) and ())
    running = Running(camera, 0, (64, 48))
    with pytest.raises(DecoderDied, match="it gave no picture for"):
        Album((64, 48), {1: running}).refuse_fault()
    running.close()
