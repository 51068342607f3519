"""Cameras: intrinsics, extrinsics, distortion; the paper's orthogonal rig as a special case."""

import math
from functools import lru_cache
from typing import Final, NamedTuple

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats, Vector
from common.compiled import compiled

PAPER_ROTATIONS: Final = (
    ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)),
    ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)),
)
"""World to camera for camera 1 (looks along -z) and camera 2 (looks along +x) (C1)."""
ROUNDING: Final = 1e-6
"""Rounding errors in a written calibration: of lengths in metres, and of angles as sines."""
TOWARDS: Final = (1.0, -1.0, -1.0)
"""From a camera's axes to axes with y up and z towards the camera."""


Row = tuple[float, float, float]
Matrix = tuple[Row, Row, Row]


class Camera(msgspec.Struct, frozen=True, cache_hash=True):
    """One camera: x_cam = R x_world + t, x right, y down, z forward, metres and pixels.

    The centre of the top-left pixel is (0.5, 0.5). Distortion is in OpenCV's order.
    """

    name: str
    K: Matrix
    R: Matrix
    t: Row
    distortion: tuple[float, ...] = ()


class Rig(msgspec.Struct, frozen=True, cache_hash=True):
    """Cameras that look at one room, and the size of their pictures."""

    width: int
    height: int
    cameras: tuple[Camera, ...]
    fps: float | None = None
    distortion: tuple[float, ...] = ()
    """Distortion of every camera that has none of its own."""


class PaperRig(NamedTuple):
    """The numbers of the paper's equations for a rig whose cameras look along -z and +x (C1)."""

    focal_1_px: float
    focal_2_px: float
    distance_1_m: float
    """Zc1 > 0."""
    distance_2_m: float
    """-Xc2 > 0."""


def paper_rig(
    size: tuple[int, int],
    focals_px: tuple[float, float],
    distances_m: tuple[float, float],
    heights_m: tuple[float, float] = (1.0, 1.0),
) -> Rig:
    """The paper's rig: camera 1 on +z, camera 2 on -x, both level (C1)."""
    width, height = size
    places = ((0.0, heights_m[0], distances_m[0]), (-distances_m[1], heights_m[1], 0.0))
    cameras = []
    for n in (0, 1):
        K = ((focals_px[n], 0.0, width / 2), (0.0, focals_px[n], height / 2), (0.0, 0.0, 1.0))
        t = -np.array(PAPER_ROTATIONS[n]) @ np.array(places[n])
        cameras.append(Camera(f"cam{n + 1}", K, PAPER_ROTATIONS[n], as_row(t)))
    return Rig(width, height, tuple(cameras))


@lru_cache(maxsize=4)
def as_paper_rig(rig: Rig) -> PaperRig | None:
    """The paper's four numbers for a rig in its exact arrangement, else None.

    A rig that is nearly so gives None: its calibration knows more than the four numbers.
    """
    if len(rig.cameras) != 2:
        return None
    first, second = (centre(camera) for camera in rig.cameras)
    turned = np.array([camera.R for camera in rig.cameras]) - PAPER_ROTATIONS
    if max(np.abs(turned).max(), abs(first[0]), abs(second[2])) > ROUNDING:
        return None
    return PaperRig(
        rig.cameras[0].K[0][0], rig.cameras[1].K[0][0], float(first[2]), float(-second[0])
    )


class Arrays(NamedTuple):
    """A camera's numbers as read-only arrays."""

    K: Vector
    R: Vector
    t: Vector
    centre: Vector
    """(3,) world, metres."""
    focal_px: Vector
    """(2,) across and down."""
    middle_px: Vector
    """(2,) the principal point."""


@lru_cache(maxsize=16)
def arrays_of(camera: Camera) -> Arrays:
    """A camera's numbers as arrays, converted once."""
    K, R, t = np.array(camera.K), np.array(camera.R), np.array(camera.t)
    arrays = Arrays(K, R, t, -R.T @ t, np.array([K[0, 0], K[1, 1]]), K[:2, 2].copy())
    for array in arrays:
        array.setflags(write=False)
    return arrays


def centre(camera: Camera) -> Vector:
    """Where the camera stands in the world, shape (3,), metres."""
    return arrays_of(camera).centre


def project(camera: Camera, points_m: Vector) -> Vector:
    """World points (n, 3) to pixels (n, 2), perspective and distortion included.

    A point on or behind the camera's plane gives NaN.
    """
    K, R, t, _, focal_px, middle_px = arrays_of(camera)
    plane: Vector = _on_plane(np.array(points_m, np.float64, order="C"), R, t)
    if any(camera.distortion):
        rays = np.concatenate([np.nan_to_num(plane), np.ones((len(plane), 1))], axis=1)
        bent, _ = cv2.projectPoints(
            rays[:, None], np.zeros(3), np.zeros(3), K, np.array(camera.distortion)
        )
        pixels: Vector = np.where(np.isnan(plane), np.nan, bent[:, 0].astype(np.float64))
        return pixels
    plane *= focal_px
    plane += middle_px
    return plane


@compiled
def _on_plane(points_m: Floats, R: Floats, t: Vector) -> Floats:
    """Intersections of the rays from the camera through points (n, 3) with the plane at depth 1,
    (n, 2); NaN for a point behind."""
    plane = np.full((len(points_m), 2), np.nan)
    for n in range(len(points_m)):
        x, y, z = points_m[n, 0], points_m[n, 1], points_m[n, 2]
        depth = R[2, 0] * x + R[2, 1] * y + R[2, 2] * z + t[2]
        if depth > 1e-9:
            for i in range(2):
                plane[n, i] = (R[i, 0] * x + R[i, 1] * y + R[i, 2] * z + t[i]) / depth
    return plane


def px_per_m(camera: Camera, point_m: Vector) -> float:
    """Pixels per metre across the line of sight at a point: focal length / depth.

    NaN where the point is not in front of the camera.
    """
    depth_m = float(arrays_of(camera).R[2] @ np.asarray(point_m) + camera.t[2])
    return camera.K[0][0] / depth_m if depth_m > 0 else float("nan")


def ray(camera: Camera, pixel: tuple[float, float]) -> Vector:
    """Direction in the world, shape (3,), unit length, of a pixel's ray."""
    K, R, _, _, focal_px, middle_px = arrays_of(camera)
    if any(camera.distortion):
        x, y = cv2.undistortPoints(np.array([[pixel]], float), K, np.array(camera.distortion))[0, 0]
    else:
        x = (pixel[0] - middle_px[0]) * (1 / focal_px[0])
        y = (pixel[1] - middle_px[1]) * (1 / focal_px[1])
    direction: Vector = _turned_back(R, float(x), float(y))
    return direction


def rays(camera: Camera, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
    """Directions in the world, (n, 3) of unit length, of the rays of pixels (n, 2), undistorted."""
    known = arrays_of(camera)
    pixels = np.ascontiguousarray(pixels, np.float64)
    found: NDArray[np.float64] = _rays(known.R, pixels, known.focal_px, known.middle_px)
    return found


@compiled
def _rays(R: Floats, pixels: Floats, focal_px: Vector, middle_px: Vector) -> Floats:
    """(n, 3) of unit length."""
    found = np.empty((len(pixels), 3))
    for n in range(len(pixels)):
        x = (pixels[n, 0] - middle_px[0]) / focal_px[0]
        y = (pixels[n, 1] - middle_px[1]) / focal_px[1]
        found[n] = _turned_back(R, x, y)
    return found


@compiled
def _turned_back(R: Floats, x: float, y: float) -> Floats:
    """The direction (3,), unit length, of a point on the plane at depth 1."""
    direction = np.empty(3)
    for i in range(3):
        direction[i] = R[0, i] * x + R[1, i] * y + R[2, i]
    return direction / math.sqrt(
        direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]
    )


def as_row(values: Vector) -> Row:
    """Three numbers as a plain tuple."""
    x, y, z = (float(value) for value in values)
    return (x, y, z)


def as_matrix(values: Vector) -> Matrix:
    """Nine numbers as plain tuples."""
    a, b, c = (as_row(row) for row in values)
    return (a, b, c)
