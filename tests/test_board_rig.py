"""A rig by a board, held against the cameras that filmed it."""

from collections.abc import Iterator

import cv2
import numpy as np
import pytest
from filmed_board import FilmedRig, middle_of, pictures_of, random_rig

from calibration.board.board import BOARDS, corner_places
from calibration.board.board_corners import corners_in
from calibration.board.board_fit import Fit
from calibration.board.board_floor import Floor
from calibration.board.board_rig import (
    BoardCalibration,
    _late,
    _refuse_few,
    _refuse_poor,
    _resting,
    _rig,
    calibrated_by_board,
)
from calibration.board.lens_start import Place
from calibration.board.still_board import BoardVideo, Moments
from common.body.body import Vector
from common.rig.camera import centre, project
from common.rig.rig_file import CalibrationError

POSTER = BOARDS["a3"]._replace(square_m=0.1)
LOOKS = 3
"""While the board is held; one more while it is away."""


def exact_films(rig: FilmedRig, noise_px: float, seed: int = 1) -> list[BoardVideo]:
    """What both cameras show, without pictures: of each pose some looks."""
    random = np.random.default_rng(seed)
    films = []
    for camera in rig.cameras:
        times, px = [], []
        for n, pose in enumerate(rig.poses):
            places = (corner_places(rig.board) - middle_of(rig.board)) @ pose.turn.T + pose.middle_m
            seen = project(camera, places) - 0.5
            to_lens = centre(camera) - pose.middle_m
            slanted = -pose.turn[:, 2] @ to_lens / np.linalg.norm(to_lens) < 0.3
            outside = ((seen < 0) | (seen > np.array(rig.size) - 1)).any(axis=1)
            seen[outside | slanted] = np.nan
            for look in range(LOOKS if np.isfinite(seen[:, 0]).sum() >= 6 else 0):
                times.append((n * (LOOKS + 1) + look) / 5)
                px.append(seen + random.normal(0, noise_px, seen.shape))
        films.append(BoardVideo(f"{camera.name}.avi", rig.size, np.array(times), np.array(px)))
    return films


def filmed(rig: FilmedRig, seed: int) -> list[BoardVideo]:
    """What is found in made-up pictures."""
    films = []
    for n, camera in enumerate(rig.cameras):
        found = [corners_in(one, rig.board) for one in pictures_of(rig, n, seed + n, LOOKS)]
        times = np.array([k / 5 for k, px in enumerate(found) if px is not None])
        px = np.array([one for one in found if one is not None])
        films.append(BoardVideo(f"{camera.name}.avi", rig.size, times, px))
    return films


def errors(found: BoardCalibration, rig: FilmedRig) -> Iterator[tuple[float, float]]:
    """Of each camera: millimetres and degrees; the world begins at the last board on the floor."""
    last = round(found.quality.floor_s * 5) // (LOOKS + 1)
    for ours, theirs in zip(found.rig.cameras, rig.cameras, strict=True):
        off_m = centre(ours) + rig.poses[last].middle_m - centre(theirs)
        turn: Vector = np.array(ours.R) @ np.array(theirs.R).T
        turned = np.linalg.norm(cv2.Rodrigues(turn)[0])
        yield float(np.linalg.norm(off_m)) * 1e3, float(np.degrees(turned))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_a_rig_is_found_within_ten_millimetres_and_a_fifth_of_a_degree(seed: int) -> None:
    rig = random_rig(seed, (640, 480), POSTER)
    found = calibrated_by_board(exact_films(rig, 0.02), POSTER)
    assert found.quality.reprojection_px < 0.1
    for off_mm, turned_deg in errors(found, rig):
        assert off_mm < 10.0
        assert turned_deg < 0.2


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "size", "square_m"), [(1, (640, 480), 0.1), (2, (320, 240), 0.2)])
def test_a_rig_is_found_from_pictures_as_well(
    seed: int, size: tuple[int, int], square_m: float
) -> None:
    """Blurred, noisy, bent by the lenses."""
    rig = random_rig(seed, size, BOARDS["a3"]._replace(square_m=square_m), 24)
    found = calibrated_by_board(filmed(rig, 2 * seed), rig.board)
    assert found.quality.reprojection_px < 0.3
    for off_mm, turned_deg in errors(found, rig):
        assert off_mm < 10.0
        assert turned_deg < 0.2


@pytest.mark.slow
def test_the_error_bar_of_the_focal_length_is_what_it_is_off() -> None:
    """Of four films: most lenses within two bars, none beyond five."""
    off = []
    for seed in range(4):
        rig = random_rig(seed, (640, 480), POSTER)
        found = calibrated_by_board(exact_films(rig, 0.05, seed), POSTER)
        for quality, camera in zip(found.quality.cameras, rig.cameras, strict=True):
            off.append((quality.focal_px - camera.K[0][0]) / quality.focal_error_px)
    assert np.mean(np.abs(off) < 2) >= 0.7
    assert np.abs(off).max() < 5


def test_a_pose_that_one_film_shows_wrongly_is_let_go() -> None:
    """As if the board had moved between both pictures."""
    rig = random_rig(0, (640, 480), POSTER, 32)
    films = exact_films(rig, 0.02)
    wrong = (films[1].time_s >= 20 * 0.8) & (films[1].time_s < 21 * 0.8)
    assert wrong.any()
    films[1].px[wrong] += [9.0, 4.0]
    for off_mm, turned_deg in errors(calibrated_by_board(films, POSTER), rig):
        assert off_mm < 10.0
        assert turned_deg < 0.2


@pytest.mark.slow
def test_the_floor_is_where_the_user_says() -> None:
    rig = random_rig(0, (640, 480), POSTER, 32)
    first_laid = len(rig.poses) - 3
    found = calibrated_by_board(exact_films(rig, 0.02), POSTER, (first_laid * 4 + 1) / 5)
    where = np.abs(centre(found.rig.cameras[0]) - centre(rig.cameras[0]))
    assert where[1] * 1e3 < 10.0
    with pytest.raises(CalibrationError, match="not at rest at --floor 500"):
        calibrated_by_board(exact_films(rig, 0.02), POSTER, 500.0)


def only_poses(rig: FilmedRig, chosen: slice) -> FilmedRig:
    return rig._replace(poses=rig.poses[chosen])


def test_what_films_lack_is_told_with_the_cure() -> None:
    rig = random_rig(0, (640, 480), POSTER, 32)
    with pytest.raises(CalibrationError, match=r"cam1.avi shows .* at rest \d times, 8 or more"):
        calibrated_by_board(exact_films(only_poses(rig, slice(0, 8)), 0.02), POSTER)
    with pytest.raises(CalibrationError, match=r"together \d times, 4 or more"):
        calibrated_by_board(exact_films(only_poses(rig, slice(0, 16)), 0.02), POSTER)
    with pytest.raises(CalibrationError, match="never lies on the floor"):
        calibrated_by_board(exact_films(only_poses(rig, slice(0, 32)), 0.02), POSTER)


def test_films_of_other_moments_are_told() -> None:
    rig = random_rig(0, (640, 480), POSTER, 32)
    first, second = exact_films(rig, 0.02)
    other = second._replace(time_s=second.time_s + 0.8 * 5)
    with pytest.raises(CalibrationError, match="does not show the moments"):
        calibrated_by_board([first, other], POSTER)


def test_the_last_dozen_moments_and_those_of_the_floor_are_kept() -> None:
    moments = Moments(np.arange(15.0), np.arange(15.0) + 0.5, np.zeros((15, 1, 6, 2)))
    assert np.flatnonzero(_late(moments, None)).tolist() == list(range(3, 15))
    assert np.flatnonzero(_late(moments, 1.5)).tolist() == [1, *range(3, 15)]
    assert np.flatnonzero(_late(moments, 1.0)).tolist() == [1, *range(3, 15)]
    assert np.flatnonzero(_late(moments, 1.6)).tolist() == list(range(3, 15))


def test_the_floor_is_told_by_a_time_at_which_the_board_rests() -> None:
    moments = Moments(np.arange(7.0), np.arange(7.0) + 0.5, np.zeros((7, 1, 6, 2)))
    assert _resting(moments, None) is None
    assert [_resting(moments, at_s) for at_s in (2.0, 2.5, 6.25)] == [2, 2, 6]
    told = r"at --floor 2\.75: it is from 2\.0, 3\.0, 4\.0, 5\.0, 6\.0 s on, and before"
    with pytest.raises(CalibrationError, match=told):
        _resting(moments, 2.75)


def test_films_that_show_too_little_or_another_board_are_named() -> None:
    one = BoardVideo("left.avi", (640, 480), np.arange(31.0), np.zeros((31, 6, 2)))
    _refuse_few(one, 8)
    with pytest.raises(CalibrationError, match=r"left\.avi .* in 31 of .* at rest 7 times, 8 or"):
        _refuse_few(one, 7)
    _refuse_poor(one, 1.5)
    with pytest.raises(
        CalibrationError, match=r"in left\.avi miss the board by 1\.6 px: .*--chess"
    ):
        _refuse_poor(one, 1.56)


def test_a_fitted_lens_stands_in_the_rig_as_it_was_fitted() -> None:
    """Corners have whole pixels at their middles, a rig has half ones."""
    still = Place(np.zeros(3), np.zeros(3))
    lenses = np.array([[600.0, 590.0, 322.0, 238.0, -0.1, 0.02]])
    fit = Fit(lenses, (still,), (still,), np.ones(1), ())
    floor = Floor(np.array([0.0, -1.0, 0.0]), np.array([0.2, 1.2, 4.0]), (0,))
    rig = _rig(fit, floor, (640, 480))
    (camera,) = rig.cameras
    assert (rig.width, rig.height, camera.name) == (640, 480, "cam1")
    K = np.array([[600.0, 0.0, 322.5], [0.0, 590.0, 238.5], [0.0, 0.0, 1.0]])
    assert np.array(camera.K) == pytest.approx(K)
    assert camera.distortion[:4] == pytest.approx((-0.1, 0.02, 0.0, 0.0))
    assert centre(camera) == pytest.approx([-0.2, 1.2, 4.0])
