"""A film of a board looked through: which pictures, in which size, and what is found in them."""

from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
import pytest
from filmed_board import board_picture
from rich.progress import Progress

from calibration.board.board import BOARDS, Board, chessboard
from common.rig.rig_file import CalibrationError
from common.video.pictures import Decoded, Size, VideoInfo, Wanted
from runtime.offline import board_videos
from runtime.offline.board_videos import Looked, looked_through

A4, A3 = BOARDS["a4"], BOARDS["a3"]
Corners = dict[int, tuple[Board, tuple[float, float]]]
"""Which pictures of a film show which board, with its only corner."""


class Films:
    """Films without pictures: the first pixel of each holds its number."""

    def __init__(self, infos: dict[str, VideoInfo], shows: dict[str, Corners]) -> None:
        self.infos, self.shows = infos, shows
        self.asked: list[tuple[str, Size, Wanted]] = []
        self.tried: list[tuple[int, Board]] = []
        self.video, self.closed = "", False

    def __enter__(self) -> "Films":
        return self

    def __exit__(self, *_: object) -> None:
        self.closed = True

    def probe(self, video: str) -> VideoInfo:
        return self.infos[video]

    def frames(self, video: str, size: Size, wanted: Wanted) -> Iterator[Decoded]:
        self.video = video
        self.asked.append((video, size, wanted))
        for index in range(0, self.infos[video].frames or 4, wanted.every):
            yield Decoded(index, 0.0, np.full((2, 3, 3), index, np.uint8))

    def corners_in(self, picture: np.ndarray, board: Board) -> Any:
        index = int(picture[0, 0, 0])
        self.tried.append((index, board))
        shown, corner = self.shows[self.video].get(index, (None, (0.0, 0.0)))
        return np.array([corner]) if shown == board else None


def look(
    monkeypatch: pytest.MonkeyPatch,
    films: Films,
    boards: tuple[Board, ...] = (A4, A3),
    progress: Progress | None = None,
) -> list[Looked]:
    monkeypatch.setattr(board_videos, "Decoder", lambda: films)
    monkeypatch.setattr(board_videos, "corners_in", films.corners_in)
    return looked_through([*films.infos], boards, progress or Progress(disable=True))


def test_a_large_film_is_looked_at_five_times_a_second_and_its_corners_are_the_files(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """3840 wide is halved: the middle of pixel 100 of the small picture is 200.5 of the file's."""
    info = VideoInfo(3840, 2000, 25.0, 20)
    shows: Corners = {5: (A3, (100.0, 50.0)), 10: (A4, (1.0, 1.0)), 15: (A3, (7.0, 3.0))}
    films = Films({"a.mp4": info}, {"a.mp4": shows})
    (found,) = look(monkeypatch, films)
    assert films.asked == [("a.mp4", (1920, 1000), Wanted(5))]
    assert found.board == A3
    assert found.film.name == "a.mp4"
    assert found.film.size_px == (3840, 2000)
    assert found.film.time_s.tolist() == [5 / 25, 15 / 25]
    assert found.film.px.tolist() == [[[200.5, 100.5]], [[14.5, 6.5]]]
    assert found.picture[0, 0, 0] == 0, "its first, though no board is in it"
    assert films.tried == [(0, A4), (0, A3), (5, A4), (5, A3), (10, A3), (15, A3)]
    assert films.closed


@pytest.mark.parametrize(("fps", "every"), [(0.0, 6), (3.0, 1), (14.0, 3), (60.0, 12)])
def test_how_manieth_picture_is_looked_at_follows_from_the_rate(
    monkeypatch: pytest.MonkeyPatch, fps: float, every: int
) -> None:
    """A film that tells none is taken for one of 30 a second, also where its times are told."""
    films = Films({"a": VideoInfo(640, 480, fps, 0)}, {"a": {0: (A4, (2.0, 1.0))}})
    (found,) = look(monkeypatch, films)
    assert films.asked == [("a", (640, 480), Wanted(every))]
    assert found.film.px.tolist() == [[[2.0, 1.0]]]


def test_a_film_of_no_rate_is_timed_as_one_of_thirty(monkeypatch: pytest.MonkeyPatch) -> None:
    films = Films({"a": VideoInfo(640, 480, 0.0, 19)}, {"a": {18: (A4, (2.0, 1.0))}})
    assert look(monkeypatch, films)[0].film.time_s.tolist() == [18 / 30]


def test_pictures_of_a_rate_that_varies_have_the_times_of_their_packets(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A median gap of 0.25 s; a picture beyond the last packet follows from the rate."""
    told = (0.0, 0.25, 0.7, 0.95)
    info = VideoInfo(640, 480, 4.0, 5, told)
    films = Films({"a": info}, {"a": dict.fromkeys((2, 3, 4), (A4, (2.0, 1.0)))})
    assert look(monkeypatch, films)[0].film.time_s.tolist() == [0.7, 0.95, 1.0]


def test_a_bar_hears_how_far_a_film_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that names no length is over at once, for a bar; none goes beyond its film."""
    shown: Corners = {0: (A4, (2.0, 1.0))}
    films = Films(
        {"a": VideoInfo(640, 480, 5.0, 4), "b": VideoInfo(640, 480, 5.0, 0)},
        {"a": shown, "b": shown},
    )
    progress, told = Progress(disable=True), list[float]()
    monkeypatch.setattr(progress, "update", lambda _, completed: told.append(completed))
    look(monkeypatch, films, progress=progress)
    assert told == [0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0]


def refused(monkeypatch: pytest.MonkeyPatch, films: Films, *boards: Board) -> str:
    with pytest.raises(CalibrationError) as error:
        look(monkeypatch, films, boards or (A4, A3))
    return str(error.value)


def test_pictures_of_another_size_are_refused_with_both_sizes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shown: Corners = {0: (A4, (2.0, 1.0))}
    infos = {"one": VideoInfo(640, 480, 5.0, 2), "two": VideoInfo(480, 640, 5.0, 2)}
    said = refused(monkeypatch, Films(infos, {"one": shown, "two": shown}))
    assert said == "two has pictures of 480x640, one of 640x480: record both alike"


def test_another_board_than_the_first_films_is_refused_with_both_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    info, other = VideoInfo(640, 480, 5.0, 2), A3._replace(columns=7)
    shows: dict[str, Corners] = {"one": {0: (A3, (2.0, 1.0))}, "two": {0: (A4, (2.0, 1.0))}}
    said = refused(monkeypatch, Films({"one": info, "two": info}, shows))
    assert said == "two shows the board of A4, one that of A3: use one for both"
    shows = {"one": {0: (other, (2.0, 1.0))}, "two": {0: (A4, (2.0, 1.0))}}
    said = refused(monkeypatch, Films({"one": info, "two": info}, shows), other, A4)
    assert said == "two shows the board of A4, one that of another kind: use one for both"
    shows = {"one": shows["two"], "two": shows["one"]}
    said = refused(monkeypatch, Films({"one": info, "two": info}, shows), other, A4)
    assert said == "two shows the board of another kind, one that of A4: use one for both"


def test_a_film_without_a_board_is_refused_with_the_cure_of_that_board(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    films = Films({"one": VideoInfo(640, 480, 5.0, 2)}, {"one": {}})
    said = refused(monkeypatch, films)
    assert said == (
        "no board is found in one: print one (--print board.pdf) and hold it nearer, in good "
        "light: a square must be some 15 pixels wide; for a chessboard say --chessboard 9x6"
    )
    said = refused(monkeypatch, films, chessboard("8x5", 0.03))
    assert said == (
        "no board is found in one: a chessboard of 8x5 squares must be seen whole, its white rim "
        "too; all squares are counted, not the corners between them"
    )


@pytest.mark.parametrize("mirrored", [True, False])
def test_a_board_in_a_mirror_is_named_with_its_cure(
    monkeypatch: pytest.MonkeyPatch, mirrored: bool
) -> None:
    """The second of two programs or drivers that mirror what they show."""
    board = cv2.resize(board_picture(A3), (300, 240), interpolation=cv2.INTER_AREA)
    picture = np.full((480, 640, 3), 120, np.uint8)
    if mirrored:
        picture[100:340, 150:450] = board[:, ::-1, None]
    films = Films({"one": VideoInfo(640, 480, 5.0, 2)}, {"one": {}})
    monkeypatch.setattr(films, "frames", lambda *_: iter([Decoded(0, 0.0, picture)]))
    monkeypatch.setattr(board_videos, "Decoder", lambda: films)
    with pytest.raises(CalibrationError) as refused:
        looked_through(["one"], (A4, A3), Progress(disable=True))
    assert ("switch mirroring off" in str(refused.value)) == mirrored
