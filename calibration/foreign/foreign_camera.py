"""Conversion between other programs' cameras and ours: pixel centres, and the up axis."""

from collections.abc import Sequence
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.rig.camera import Camera, Rig, as_matrix, as_row
from common.rig.rig_file import CalibrationError, check_rig
from common.rig.upright_camera import quarters_of

CENTRE: Final = 0.5
"""Our coordinate of the first pixel's centre; OpenCV's is 0."""
FORMS: Final = "TOML of Pose2Sim, Caliscope or anipose, Qualisys' .qca.txt, OpenCV's .yml and .xml"
"""Suffixes of readable files."""


Up = Literal["x", "y", "z", "-x", "-y", "-z"]
"""An axis of another program's world."""
LOOKS_UP: Final = 0.2
"""Sine of the elevation above which no camera of a room looks: beyond it the camera is rolled."""
STEEP: Final = 0.3
"""Cosine of the depression at which a camera's picture hardly shows the up direction."""
SAME_SHAPE: Final = 0.02
"""Largest difference of two pictures' aspect ratios at which one is the other's size."""
UNDER_M: Final = 0.5
"""Apparent depth below the floor, metres, at which cameras in truth hang upside down above it."""


class ForeignCamera(NamedTuple):
    """One camera, x_cam = R x_world + t, metres; the centre of the top-left pixel is (0, 0)."""

    name: str
    size_px: tuple[int, int]
    K: NDArray[np.float64]
    R: NDArray[np.float64]
    t: Vector
    distortion: tuple[float, ...]
    quarters: int = 0
    """Clockwise quarter turns that make its picture upright, as far as known."""


def our_rig(cameras: Sequence[ForeignCamera], where: str, up: Up | None = None) -> Rig:
    """The cameras in our conventions: y up, whichever axis is up in theirs.

    A rig has one size of picture, the first camera's; cameras of other sizes are scaled to it, as a
    clip's pictures are when it is opened.

    Args:
        cameras: Cameras in another world.
        where: Named in errors.
        up: The up axis of that world; None: the one that upright pictures show as up.

    Raises:
        CalibrationError: When there are none, their pictures have several shapes, they form no rig,
            or they are rolled so that their pictures do not show the up direction.
    """
    if not cameras:
        raise CalibrationError(f"{where} holds no camera in a form that is known: {FORMS}")
    width, height = cameras[0].size_px
    scales = [(width / one.size_px[0], height / one.size_px[1]) for one in cameras]
    if any(abs(x / y - 1.0) > SAME_SHAPE for x, y in scales):
        told = ", ".join(f"{one.name} {one.size_px[0]}x{one.size_px[1]}" for one in cameras)
        raise CalibrationError(
            f"{where}: cameras of one shape of picture are needed, got {told}: choose with --camera"
        )
    turn = axes_with_y_up(up_in_pictures(cameras, where) if up is None else _named(up))
    ours = []
    for camera, scale in zip(cameras, scales, strict=True):
        K = camera.K.copy()
        K[:2, 2] += CENTRE
        K = np.diag([*scale, 1.0]) @ K
        R = as_matrix(camera.R @ turn.T)
        ours.append(Camera(camera.name, as_matrix(K), R, as_row(camera.t), camera.distortion))
    rig = Rig(width, height, tuple(ours))
    check_rig(rig, where)
    return rig


def up_in_pictures(cameras: Sequence[ForeignCamera], where: str) -> Vector:
    """The axis (3,) of the cameras' world that is up in their pictures.

    Raises:
        CalibrationError: When they disagree more than the pictures of unrolled cameras do.
    """
    up = axes_with_y_up(np.mean([_up_of(camera) for camera in cameras], axis=0))[1]
    heights_m = [float(-camera.R.T @ camera.t @ up) for camera in cameras]
    odd = [one.name for one in cameras if _is_rolled(one, up)]
    if np.mean(heights_m) < -UNDER_M:
        odd = [camera.name for camera in cameras]
    if odd:
        raise CalibrationError(
            f"{where}: {', '.join(odd)} seem rolled by 90 degrees or more, so their pictures do "
            "not tell which axis of its world is up: say it, for example --up z"
        )
    return up


def _up_of(camera: ForeignCamera) -> Vector:
    """The up direction of the camera's picture, (3,) in its world."""
    right, down, _ = camera.R
    up: Vector = (-down, -right, down, right)[camera.quarters % 4]
    return up


def _is_rolled(camera: ForeignCamera, up: Vector) -> bool:
    """Whether, with this up direction, a camera would be tilted sideways by more than 45
    degrees, look up, or look straight down."""
    upwards = float(_up_of(camera) @ up)
    aside = abs(float(_up_of(camera._replace(quarters=camera.quarters + 1)) @ up))
    return bool(upwards < max(aside, STEEP) or camera.R[2] @ up > LOOKS_UP)


def _named(up: Up) -> Vector:
    axis = np.zeros(3)
    axis["xyz".index(up[-1])] = -1.0 if up.startswith("-") else 1.0
    return axis


def axes_with_y_up(up: Vector) -> NDArray[np.float64]:
    """Our axes in another world, rows (3, 3), from its axis nearest to up."""
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
        bent, quarters = camera.distortion, quarters_of(camera)
        theirs.append(ForeignCamera(camera.name, size, K, R, np.array(camera.t), bent, quarters))
    return theirs
