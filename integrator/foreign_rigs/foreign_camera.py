"""Cameras as OpenCV has them, and as we do: pixels' centres, and which way is up."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.rig.camera import Camera, Rig, as_matrix, as_row
from common.rig.rig_file import CalibrationError, check_rig

CENTRE: Final = 0.5
"""OpenCV has the centre of the first pixel at 0, we at this."""
FORMS: Final = "TOML of Pose2Sim, Caliscope or anipose, Qualisys' .qca.txt, OpenCV's .yml and .xml"
"""What is read."""


class ForeignCamera(NamedTuple):
    """One camera, x_cam = R x_world + t, metres; the centre of the top-left pixel is (0, 0)."""

    name: str
    size_px: tuple[int, int]
    K: NDArray[np.float64]
    R: NDArray[np.float64]
    t: Vector
    distortion: tuple[float, ...]


def our_rig(cameras: Sequence[ForeignCamera], where: str) -> Rig:
    """The cameras in our conventions: y up, whichever axis theirs has up.

    Raises:
        CalibrationError: When they are none, or of pictures of several sizes, or no rig.
    """
    if not cameras:
        raise CalibrationError(f"{where} holds no camera in a form that is known: {FORMS}")
    sizes = {camera.size_px for camera in cameras}
    if len(sizes) != 1:
        told = ", ".join(f"{one.name} {one.size_px[0]}x{one.size_px[1]}" for one in cameras)
        raise CalibrationError(
            f"{where}: cameras of one size are needed, got {told}: choose with --camera"
        )
    turn = axes_with_y_up(np.mean([-camera.R[1] for camera in cameras], axis=0))
    ours = []
    for camera in cameras:
        K = camera.K.copy()
        K[:2, 2] += CENTRE
        R = as_matrix(camera.R @ turn.T)
        ours.append(Camera(camera.name, as_matrix(K), R, as_row(camera.t), camera.distortion))
    rig = Rig(*sizes.pop(), tuple(ours))
    check_rig(rig, where)
    return rig


def axes_with_y_up(up: Vector) -> NDArray[np.float64]:
    """Our axes in a world's own, rows (3, 3), by the axis of it that is nearest to up."""
    axis = int(np.abs(up).argmax())
    y, z = np.zeros(3), np.zeros(3)
    y[axis], z[(axis + 1) % 3] = np.sign(up[axis]), 1.0
    return np.stack([np.cross(y, z), y, z])


def with_z_up(rig: Rig) -> list[ForeignCamera]:
    """Our cameras for programs whose world has z up."""
    turn = axes_with_y_up(np.array([0.0, 0.0, 1.0]))
    theirs = []
    for camera in rig.cameras:
        K = np.array(camera.K)
        K[:2, 2] -= CENTRE
        size = (rig.width, rig.height)
        R = np.array(camera.R) @ turn
        theirs.append(ForeignCamera(camera.name, size, K, R, np.array(camera.t), camera.distortion))
    return theirs
