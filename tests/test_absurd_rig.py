"""Rigs that no room has."""

import math
from collections.abc import Callable

import msgspec
import numpy as np
import pytest

from common.rig.absurd_rig import FOCALS, nearly_one_view, refuse_absurd
from common.rig.camera import Rig, as_matrix, as_row, paper_rig
from common.rig.rig_file import CalibrationError

GOOD = paper_rig((160, 120), (200.0, 200.0), (4.5, 4.5))


def in_millimetres(rig: Rig) -> Rig:
    return _each(rig, lambda R, t: (R, 1000.0 * t))


def with_z_up(rig: Rig) -> Rig:
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    return _each(rig, lambda R, t: (R @ turn, t))


def far_below(rig: Rig) -> Rig:
    return _each(rig, lambda R, t: (R, t + R @ [0.0, 3.0, 0.0]))


def _each(
    rig: Rig, change: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
) -> Rig:
    cameras = []
    for camera in rig.cameras:
        R, t = change(np.array(camera.R), np.array(camera.t))
        cameras.append(msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(t)))
    return msgspec.structs.replace(rig, cameras=tuple(cameras))


@pytest.mark.parametrize(
    ("rig", "named"),
    [
        (in_millimetres(GOOD), "is t in millimetres"),
        (with_z_up(GOOD), "y does not point up in its world, z seems to"),
        (far_below(GOOD), "cam1 stands 2.0 m below the floor"),
        (paper_rig((160, 120), (5000.0, 200.0), (4.5, 4.5)), "31 widths of the picture"),
        (msgspec.structs.replace(GOOD, width=70), r"outside its 70x120 picture"),
    ],
    ids=["millimetres", "z up", "below the floor", "focal length", "another size"],
)
def test_an_absurd_rig_is_named_with_what_to_do(rig: Rig, named: str) -> None:
    with pytest.raises(CalibrationError, match=f"{named}.*--trust-calibration"):
        refuse_absurd(rig, "calibration.json")


def rolled(rig: Rig, deg: float) -> Rig:
    cos, sin = np.cos(np.radians(deg)), np.sin(np.radians(deg))
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return _each(rig, lambda R, t: (turn @ R, turn @ t))


def near_each_other(rig: Rig) -> Rig:
    """Camera 2 looks by 35 degrees beside camera 1, from the other end of the same room."""
    first, second = rig.cameras
    cos, sin = np.cos(np.radians(35.0)), np.sin(np.radians(35.0))
    turn = np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])
    R = np.array(first.R) @ turn
    other = msgspec.structs.replace(second, R=as_matrix(R), t=first.t)
    return msgspec.structs.replace(rig, cameras=(first, other))


@pytest.mark.parametrize("deg", range(0, 360, 15))
@pytest.mark.parametrize("rig", [GOOD, near_each_other(GOOD)], ids=["across", "near"])
def test_rolled_cameras_are_not_absurd(rig: Rig, deg: int) -> None:
    """Upside down they are as alike as where y points down, yet they stand over the floor."""
    refuse_absurd(rolled(rig, deg), "calibration.json")


def test_a_world_whose_y_points_down_is_named() -> None:
    """As that of OpenCV's first camera: the cameras are at its height 0."""
    down = np.diag([1.0, -1.0, -1.0])
    rig = _each(GOOD, lambda R, t: (R @ down, t))
    on_floor = _each(rig, lambda R, t: (R, t + R @ [0.0, -1.0, 0.0]))
    for each in (rig, on_floor):
        with pytest.raises(CalibrationError, match="y does not point up in its world, y seems to"):
            refuse_absurd(each, "calibration.json")


def test_the_papers_rig_is_not_absurd() -> None:
    """Nor one with the same lenses up to the bounds, and not beyond them."""
    refuse_absurd(GOOD, "calibration.json")
    for share, step in zip(FOCALS, (1.001, 0.999), strict=True):
        refuse_absurd(paper_rig((160, 120), (160 * share * step, 200.0), (4.5, 4.5)), "it")
        with pytest.raises(CalibrationError, match="focal length of cam1"):
            refuse_absurd(paper_rig((160, 120), (160 * share / step, 200.0), (4.5, 4.5)), "it")


@pytest.mark.parametrize(
    ("apart_deg", "said"), [(90.0, ""), (7.0, "look 7 degrees"), (-170.0, "look 170 degrees")]
)
def test_cameras_that_look_one_way_or_at_each_other_are_told(apart_deg: float, said: str) -> None:
    """Also where the person calibrated them: of two copies of one video they stand side by side."""
    first, second = GOOD.cameras
    a = math.radians(apart_deg)
    turn = np.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]])
    other = msgspec.structs.replace(second, R=as_matrix(np.array(first.R) @ turn))
    told = nearly_one_view(msgspec.structs.replace(GOOD, cameras=(first, other)))
    assert said in told
    assert bool(told) == bool(said)
