"""All cameras and boards at once, held against cameras and boards that are known."""

import cv2
import numpy as np
import pytest

from calibration.board.board import BOARDS, corner_places
from calibration.board.board_fit import (
    Sight,
    Start,
    _Layout,
    _prior,
    _shown,
    _slope,
    fitted_to,
    start_of,
    weighed,
)
from calibration.board.lens_start import Lens, Place, chained
from common.body.body import Vector

SIZE = (640, 480)
PLACES = corner_places(BOARDS["a3"]._replace(square_m=0.1))
LENSES = np.array(
    [[600.0, 600.5, 322.0, 238.0, -0.1, 0.02], [520.0, 519.5, 316.0, 243.0, 0.05, -0.01]]
)
STILL = Place(np.zeros(3), np.zeros(3))
AWAY = Place(np.array([0.1, -0.6, 0.05]), np.array([0.7, 0.1, 0.4]))
"""The first camera's axes in the second's."""


def held(count: int, seed: int) -> tuple[Place, ...]:
    rng = np.random.default_rng(seed)
    turns = rng.uniform(-0.5, 0.5, (count, 3))
    shifts = rng.uniform((-0.6, -0.5, 1.6), (0.2, 0.1, 2.4), (count, 3))
    return tuple(Place(turn, shift) for turn, shift in zip(turns, shifts, strict=True))


def seen(camera: int, board: Place, lens: Vector) -> Vector:
    """By OpenCV's own projection of points that are moved here."""
    points = PLACES @ cv2.Rodrigues(board.turn)[0].T + board.shift
    if camera:
        points = points @ cv2.Rodrigues(AWAY.turn)[0].T + AWAY.shift
    fx, fy, cx, cy, k1, k2 = lens
    K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    bent = np.array([k1, k2, 0.0, 0.0])
    return np.asarray(cv2.projectPoints(points, np.zeros(3), np.zeros(3), K, bent)[0][:, 0])


def sights_of(boards: tuple[Place, ...]) -> list[Sight]:
    """Camera 2 does not see the first."""
    return [
        Sight(camera, rest, PLACES, seen(camera, board, LENSES[camera]))
        for rest, board in enumerate(boards)
        for camera in (0, 1)
        if camera == 0 or rest
    ]


def whole(boards: tuple[Place, ...]) -> Vector:
    places = [np.concatenate(one) for one in (AWAY, *boards)]
    return np.concatenate([LENSES.ravel(), *places])


def test_unknowns_follow_each_other_lenses_first_then_cameras_then_boards() -> None:
    layout = _Layout(3, 4)
    parts = [layout.lens(n) for n in range(3)]
    parts += [layout.camera(n) for n in (1, 2)] + [layout.board(n) for n in range(4)]
    assert [(part.start, part.stop) for part in parts] == [(6 * n, 6 * n + 6) for n in range(9)]
    assert layout.length == 54


def test_corners_are_shown_where_opencv_has_them_and_slopes_are_what_a_step_changes() -> None:
    boards = held(3, 1)
    layout, unknown = _Layout(2, 3), whole(boards)
    for sight in sights_of(boards)[1:]:
        px = _shown(layout, unknown, sight)[0]
        assert px == pytest.approx(sight.px, abs=1e-6)
        found = _slope(layout, unknown, sight._replace(sigma_px=0.2))
        for n in range(layout.length):
            step = 1e-6 * np.eye(layout.length)[n]
            up, down = (_shown(layout, unknown + way * step, sight)[0] for way in (1.0, -1.0))
            due = (up - down).ravel() / 2e-6 / 0.2
            assert found[:, n] == pytest.approx(due, rel=1e-4, abs=1e-3)


def test_the_likeliest_cameras_and_boards_are_those_that_were_seen() -> None:
    boards = held(10, 2)
    rng = np.random.default_rng(3)
    near = tuple(
        Place(one.turn + rng.normal(0, 0.01, 3), one.shift + rng.normal(0, 0.01, 3))
        for one in (AWAY, *boards)
    )
    lenses = LENSES * 1.01
    lenses[:, 4:] = 0.0
    fit = fitted_to(sights_of(boards), Start(lenses, (STILL, near[0]), near[1:]), SIZE)
    assert fit.lenses[:, :2] == pytest.approx(LENSES[:, :2], rel=2e-3)
    assert fit.lenses[:, 2:4] == pytest.approx(LENSES[:, 2:4], abs=1.0)
    assert fit.lenses[:, 4] == pytest.approx(LENSES[:, 4], abs=0.01)
    assert fit.cameras[0] is STILL
    for found, due in zip((fit.cameras[1], *fit.boards), (AWAY, *boards), strict=True):
        assert found.turn == pytest.approx(due.turn, abs=3e-3)
        assert found.shift == pytest.approx(due.shift, abs=1e-2)
    assert len(fit.misses_px) == 19
    assert max(np.abs(miss).max() for miss in fit.misses_px) < 0.05
    assert fit.focal_error_px.shape == (2,)
    assert (fit.focal_error_px > 0.0).all()


def test_what_is_believed_of_a_lens_is_told_in_sigmas() -> None:
    """By hand: square pixels to 0.2 %, the middle to 3 % of the width, k1 and k2 to 0.5."""
    layout = _Layout(2, 1)
    rows, wanted = _prior(layout, LENSES, SIZE)
    assert rows.shape == (10, layout.length)
    unknown = np.zeros(layout.length)
    unknown[layout.lens(1)] = [500.0, 500.0 + 1.04 * 2.0, 319.5 + 19.2, 239.5 - 9.6, 0.5, -1.0]
    off = rows @ unknown - wanted
    assert off[5:] == pytest.approx([2.0, 1.0, -0.5, 1.0, -2.0])
    assert off[0] == 0.0, "camera 1's own focal length"
    assert off[1:3] == pytest.approx([-319.5 / 19.2, -239.5 / 19.2])


def test_a_sight_is_worth_what_its_corners_miss_and_never_too_much() -> None:
    """By hand: three corners of 0.05 px are believed beside its own."""
    one = Sight(0, 0, PLACES, np.zeros((len(PLACES), 2)))
    miss_px = np.tile([0.3, -0.4], (12, 1))
    told = weighed(one, miss_px).sigma_px
    assert told == pytest.approx(np.sqrt((12 * 0.25 / 2 + 3 * 0.05**2) / 15))
    exact = weighed(one, np.zeros((12, 2))).sigma_px
    assert exact == pytest.approx(0.05 * np.sqrt(3 / 15))
    assert weighed(one, np.zeros((200, 2))).sigma_px == 0.01


def test_a_start_has_each_board_by_the_first_camera_that_shows_it() -> None:
    boards = held(3, 4)
    K = np.array([[600.0, 0.0, 322.0], [0.0, 601.0, 238.0], [0.0, 0.0, 1.0]])
    first = Lens(K, -0.1, 0.2, {0: boards[0], 2: boards[2]})
    theirs = {n: chained(boards[n], AWAY) for n in (1, 2)}
    other = Lens(2.0 * K, 0.3, 0.2, {1: theirs[1], 2: Place(np.ones(3), np.ones(3))})
    start = start_of((first, other), (STILL, AWAY), 3)
    assert start.lenses.tolist() == [
        [600.0, 601.0, 322.0, 238.0, -0.1, 0.0],
        [1200.0, 1202.0, 644.0, 476.0, 0.3, 0.0],
    ]
    assert start.cameras == (STILL, AWAY)
    for found, due in zip(start.boards, boards, strict=True):
        assert found.turn == pytest.approx(due.turn)
        assert found.shift == pytest.approx(due.shift)
