"""Refusal of rigs that no room has, unless the user insists, and warnings of rigs of little use."""

import math
from itertools import combinations
from typing import Final

import numpy as np

from common.body.body import Vector
from common.rig.camera import Camera, Rig, centre
from common.rig.rig_file import CalibrationError
from common.rig.upright_camera import quarters_of

FOCALS: Final = (0.2, 20.0)
"""Bounds of the focal length, picture widths: a fisheye, a telescope."""
APART_DEG: Final = (30.0, 150.0)
"""Bounds of the angle between two cameras' axes, degrees: outside them both show nearly one
silhouette, as it is or mirrored."""
TOGETHER_M, APART_M = 0.05, 60.0
DEEP_M: Final = 1.0
"""Depth of a camera below the floor, metres, from which on the floor must be wrong."""
NO_UP: Final = 0.2
"""Smallest part of a camera's own up axis along the world's y; below it y is not up."""
ALIKE: Final = 0.8
"""Smallest agreement of two cameras' up axes that counts as level, whatever the world's y;
unless they are rolled, and agree better once their pictures are turned upright."""
HUNG_M: Final = 0.2
"""Smallest height above the floor, metres, of cameras that hang upside down; lower ones mean
that the world's y points down."""
INSIST: Final = (
    "calibrate again, or trust it (--trust-calibration, trust_calibration = true in settings)"
)


def refuse_absurd(rig: Rig, where: str) -> None:
    """Refuse a rig in which one camera, or two together, could stand in no room.

    Raises:
        CalibrationError: With the camera's name, the fault and the cure.
    """
    for first, second in combinations(rig.cameras, 2):
        _refuse_absurd_pair((first, second), where)
    for camera in rig.cameras:
        share, across, down = camera.K[0][0] / rig.width, camera.K[0][2], camera.K[1][2]
        if not FOCALS[0] <= share <= FOCALS[1]:
            raise CalibrationError(
                f"{where}: the focal length of {camera.name} is {share:.2g} widths of the picture, "
                f"as if it were for another size; {INSIST}"
            )
        if not (0 < across < rig.width and 0 < down < rig.height):
            raise CalibrationError(
                f"{where}: {camera.name} has its middle at ({across:.0f}, {down:.0f}), outside its "
                f"{rig.width}x{rig.height} picture; {INSIST}"
            )
        deep_m = -float(centre(camera)[1])
        if deep_m > DEEP_M:
            raise CalibrationError(
                f"{where}: {camera.name} stands {deep_m:.1f} m below the floor, y = 0; {INSIST}"
            )


def _refuse_absurd_pair(pair: tuple[Camera, Camera], where: str) -> None:
    first, second = pair
    apart_m = float(np.linalg.norm(centre(first) - centre(second)))
    if apart_m < TOGETHER_M:
        raise CalibrationError(
            f"{where}: {first.name} and {second.name} stand at one place; {INSIST}"
        )
    if apart_m > APART_M:
        raise CalibrationError(
            f"{where}: the cameras are {apart_m:.0f} m apart: is t in millimetres? it must be in "
            f"metres; {INSIST}"
        )
    ups = [-np.array(camera.R)[1] for camera in pair]
    if max(up[1] for up in ups) < NO_UP and ups[0] @ ups[1] > ALIKE and not _is_rolled(pair, ups):
        raise CalibrationError(
            f"{where}: y does not point up in its world, {'xyz'[int(np.abs(ups[0]).argmax())]} "
            f"seems to: turn it; {INSIST}"
        )


def _is_rolled(pair: tuple[Camera, Camera], ups: list[Vector]) -> bool:
    """Whether cameras whose up axes, (3,) each, agree with each other but not with y are rolled,
    in a world with y up."""
    turned = [_up_when_turned(camera) for camera in pair]
    hangs = max(float(centre(camera)[1]) for camera in pair) > HUNG_M
    return bool(turned[0] @ turned[1] >= ups[0] @ ups[1] and hangs)


def _up_when_turned(camera: Camera) -> Vector:
    """The camera's own up axis, (3,), once its picture is turned upright by quarter turns."""
    right, down = np.array(camera.R)[:2]
    up: Vector = (-down, -right, down, right)[quarters_of(camera)]
    return up


def nearly_one_view(rig: Rig) -> str:
    """A warning about two cameras that look nearly the same way, or at each other; "" for
    others."""
    if len(rig.cameras) != 2:
        return ""
    one, other = (np.array(camera.R)[2] for camera in rig.cameras)
    apart_deg = math.degrees(math.acos(float(np.clip(one @ other, -1.0, 1.0))))
    if APART_DEG[0] <= apart_deg <= APART_DEG[1]:
        return ""
    return (
        f"the cameras look {apart_deg:.0f} degrees apart: how far from them arms and legs "
        "are is hard to tell; 60 to 120 are good"
    )
