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


def placed(*centres_m: tuple[float, float, float]) -> Rig:
    """The paper's rig with its cameras elsewhere."""
    cameras = tuple(
        msgspec.structs.replace(camera, t=as_row(-np.array(camera.R) @ place))
        for camera, place in zip(GOOD.cameras, centres_m, strict=True)
    )
    return msgspec.structs.replace(GOOD, cameras=cameras)


@pytest.mark.parametrize(
    ("second_m", "said"),
    [
        ((2.0, 1.04, 3.0), "cam1 and cam2 stand at one place; calibrate again"),
        ((2.0, 1.06, 3.0), ""),
        ((2.0, 1.0, 62.9), ""),
        ((2.0, 1.0, -57.9), "the cameras are 61 m apart: is t in millimetres"),
        ((2.0, -0.99, 8.0), ""),
        ((2.0, -1.01, 8.0), r"cam2 stands 1\.0 m below the floor, y = 0; calibrate"),
    ],
)
def test_cameras_stand_apart_and_over_the_floor(
    second_m: tuple[float, float, float], said: str
) -> None:
    """Five centimetres, sixty metres, one metre down."""
    rig = placed((2.0, 1.0, 3.0), second_m)
    if said:
        with pytest.raises(CalibrationError, match=rf"^here: {said}"):
            refuse_absurd(rig, "here")
    else:
        refuse_absurd(rig, "here")


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize(
    ("share", "well"), [(0.0, False), (0.01, True), (0.99, True), (1.0, False)]
)
def test_the_middle_of_a_lens_lies_within_its_picture(row: int, share: float, well: bool) -> None:
    K = np.array(GOOD.cameras[1].K)
    K[row, 2] = share * (160, 120)[row]
    second = msgspec.structs.replace(GOOD.cameras[1], K=as_matrix(K))
    rig = msgspec.structs.replace(GOOD, cameras=(GOOD.cameras[0], second))
    if well:
        refuse_absurd(rig, "here")
    else:
        place = rf"\({K[0, 2]:.0f}, {K[1, 2]:.0f}\), outside its 160x120"
        with pytest.raises(CalibrationError, match=rf"^here: cam2 has its middle at {place}"):
            refuse_absurd(rig, "here")


@pytest.mark.parametrize(
    ("apart_deg", "odd"), [(29.0, True), (31.0, False), (149.0, False), (151.0, True)]
)
def test_thirty_degrees_apart_are_two_views(apart_deg: float, odd: bool) -> None:
    first = GOOD.cameras[0]
    a = math.radians(apart_deg)
    turn = np.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]])
    other = msgspec.structs.replace(first, R=as_matrix(np.array(first.R) @ turn))
    said = nearly_one_view(msgspec.structs.replace(GOOD, cameras=(first, other)))
    assert said.startswith(f"the cameras look {apart_deg:.0f} degrees apart: " if odd else "")
    assert bool(said) == odd
    assert nearly_one_view(msgspec.structs.replace(GOOD, cameras=(first,))) == ""


def test_of_three_cameras_each_two_are_looked_at() -> None:
    rig = placed((0.0, 1.0, 4.0), (4.0, 1.0, 0.0))
    first, second = rig.cameras
    third = msgspec.structs.replace(second, name="door")
    with pytest.raises(CalibrationError, match=f"^here: {second.name} and door stand at one place"):
        refuse_absurd(msgspec.structs.replace(rig, cameras=(first, second, third)), "here")
