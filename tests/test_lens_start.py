"""A first guess of lenses and places, held against cameras that are known."""

import cv2
import numpy as np
import pytest

from calibration.board.board import BOARDS, corner_places
from calibration.board.lens_start import Lens, Place, between, chained, lens_of, undone
from common.body.body import Vector

SIZE = (640, 480)
PLACES = corner_places(BOARDS["a3"]._replace(square_m=0.1))
BENT = -0.12
K = np.array([[600.0, 0.0, 319.5], [0.0, 600.0, 239.5], [0.0, 0.0, 1.0]])


def some_places(count: int, seed: int) -> list[Place]:
    """Where a board is held: tilted, a metre and a half away."""
    rng = np.random.default_rng(seed)
    turns = rng.uniform(-0.6, 0.6, (count, 3))
    shifts = rng.uniform((-0.6, -0.5, 1.2), (0.2, 0.1, 2.0), (count, 3))
    return [Place(turn, shift) for turn, shift in zip(turns, shifts, strict=True)]


def shown(board: Place, matrix: Vector = K, bent: float = BENT) -> Vector:
    lens = np.array([bent, 0.0, 0.0, 0.0])
    return np.asarray(
        cv2.projectPoints(PLACES, board.turn, board.shift, matrix, lens)[0][:, 0], float
    )


def turned(place: Place, points: Vector) -> Vector:
    return np.asarray(points @ cv2.Rodrigues(place.turn)[0].T + place.shift)


def test_a_lens_is_found_from_what_it_shows_of_boards_also_where_corners_are_hidden() -> None:
    boards = some_places(12, 1)
    px = np.array([shown(board) for board in boards])
    px[3] = np.nan
    px[5, :4] = np.nan
    lens = lens_of(PLACES, px, SIZE)
    assert pytest.approx(K, rel=1e-3, abs=1e-3) == lens.K
    assert lens.k1 == pytest.approx(BENT, abs=5e-3)
    assert lens.miss_px < 0.01
    assert sorted(lens.boards) == [0, 1, 2, *range(4, 12)]
    for row in (0, 5, 11):
        assert lens.boards[row].shift == pytest.approx(boards[row].shift, abs=2e-3)
        assert lens.boards[row].turn == pytest.approx(boards[row].turn, abs=2e-3)


def test_places_follow_each_other_and_can_be_undone() -> None:
    first, then = some_places(2, 2)
    points = np.random.default_rng(3).normal(size=(5, 3))
    both = turned(chained(first, then), points)
    assert both == pytest.approx(turned(then, turned(first, points)))
    assert turned(undone(first), turned(first, points)) == pytest.approx(points)
    assert turned(chained(undone(then), then), points) == pytest.approx(points)


def test_another_camera_stands_where_most_rests_have_it() -> None:
    """Of seven rests that both show one was moved between the pictures."""
    boards, away = some_places(9, 4), Place(np.array([0.1, -0.8, 0.05]), np.array([0.9, 0.1, 0.4]))
    theirs = {row: chained(boards[row], away) for row in range(2, 9)}
    wrong = theirs[2]._replace(shift=theirs[2].shift + np.array([0.2, 0.0, 0.0]))
    first = Lens(K, BENT, 0.0, {row: boards[row] for row in range(8)})
    other = Lens(K, BENT, 0.0, {**theirs, 2: wrong})
    px = np.full((9, len(PLACES), 2), np.nan)
    for row, board in other.boards.items():
        px[row] = shown(board)
    px[6, 3:] = np.nan
    found, miss_px = between(first, other, PLACES, px)
    assert found.shift == pytest.approx(away.shift, abs=1e-6)
    assert found.turn == pytest.approx(away.turn, abs=1e-6)
    assert miss_px == pytest.approx(0.0, abs=1e-6)
    beside = Lens(K, BENT, 0.0, {row: other.boards[row] for row in (2, 3)})
    _, half = between(first, beside, PLACES, px)
    lens_px = np.linalg.norm(shown(theirs[2]) - shown(wrong), axis=1).mean()
    assert 0.2 * lens_px < half < lens_px, "half of two"
