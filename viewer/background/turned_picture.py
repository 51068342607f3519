"""The picture of a camera after a rotation, from its picture before."""

from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.rig.camera import Camera, arrays_of
from viewer.background.background import Background, slopes
from viewer.background.image_stack import LUMA

USUAL_FOCAL: Final = 1.25
"""Focal length of an uncalibrated camera, over the width of its picture: a lens of 44 degrees."""
HALF: Final = 0.5
"""Coordinate of the first pixel's middle in a Camera; here, as in OpenCV, it is 0."""
ROUNDS: Final = 8
EDGE_PX: Final = 0.35
"""Tolerance of an edge's place after the rotation, pixels."""
SOBEL: Final = 8.0
"""Value of Sobel's operator for a slope of 1 per pixel."""

Places = NDArray[np.float64]


class Lens(NamedTuple):
    """A camera's projection of rays to pixels."""

    K: Vector
    """(3, 3) for pixels whose first has its middle at 0."""
    distortion: Vector
    """(n,) OpenCV's order; (0,) zeros where there is none."""

    @property
    def focal_px(self) -> Vector:
        """(2,) focal lengths across and down."""
        return np.array([self.K[0, 0], self.K[1, 1]])


def lens_of(camera: Camera | None, size_px: tuple[int, int]) -> Lens:
    """The lens of a camera; a default one where it is not calibrated.

    Args:
        camera: For pictures of this size.
        size_px: Width and height of the pictures.
    """
    if camera is not None:
        K = arrays_of(camera).K.copy()
        K[:2, 2] -= HALF
        return Lens(K, np.array(camera.distortion or (0.0,) * 4))
    K = np.diag([USUAL_FOCAL * size_px[0]] * 2 + [1.0])
    K[:2, 2] = np.array(size_px) / 2 - HALF
    return Lens(K, np.zeros(4))


def rays_of(lens: Lens, places_px: NDArray[np.float32] | Places) -> Places:
    """(n, 3) unit vectors in the camera's axes of the rays of pixels (n, 2)."""
    places = np.asarray(places_px, float).reshape(-1, 1, 2)
    flat = cv2.undistortPoints(places, lens.K, lens.distortion)[:, 0]
    rays = np.concatenate([flat, np.ones((len(flat), 1))], axis=1)
    unit: Places = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    return unit


def seen_at(lens: Lens, turn: Vector, places_px: NDArray[np.float32] | Places) -> Places:
    """(n, 2) places of pixels (n, 2) after a rotation (3, 3) of the scene."""
    rays = rays_of(lens, places_px) @ turn.T
    zero = np.zeros(3)
    found, _ = cv2.projectPoints(rays.reshape(-1, 1, 3), zero, zero, lens.K, lens.distortion)
    return np.asarray(found[:, 0], float)


def turn_between(before: Places, after: Places, close: float) -> Vector:
    """The rotation (3, 3) that maps most rays (n, 3) to others, whatever the rest do.

    Weighted least squares (Kabsch), with weights from the residuals of the round before.

    Args:
        before: Unit vectors.
        after: The same rays found again.
        close: Residual of matching rays, radians.
    """
    weights, turn = np.ones(len(before)), np.eye(3)
    for _ in range(ROUNDS):
        left, _, right = np.linalg.svd((weights[:, None] * after).T @ before)
        turn = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
        missed = np.linalg.norm(after - before @ turn.T, axis=1)
        scale = max(close, float(np.median(missed)))
        weights = 1.0 / (1.0 + (missed / scale) ** 2) ** 2
    return np.asarray(turn, float)


def turned_background(
    first: Background, lens: Lens, turn: Vector, frame: NDArray[np.uint8]
) -> Background:
    """A background after a rotation of the camera; what was out of the picture comes from a frame.

    Args:
        first: The background before the rotation.
        lens: The camera's lens.
        turn: (3, 3) rotation of the scene.
        frame: (H, W, 3) the present frame.
    """
    high, wide = first.uncertain.shape
    grid = np.stack(np.meshgrid(np.arange(wide), np.arange(high)), axis=-1).reshape(-1, 2)
    at = seen_at(lens, turn.T, grid.astype(float)).reshape(high, wide, 2).astype(np.float32)
    new = (at < 0).any(axis=-1) | (at[..., 0] > wide - 1) | (at[..., 1] > high - 1)

    def moved(plane: NDArray[np.float32]) -> NDArray[np.float32]:
        found = cv2.remap(plane, at, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(found, np.float32)

    uncertain = cv2.remap(first.uncertain.view(np.uint8), at, None, cv2.INTER_NEAREST) > 0
    now = frame.astype(np.float32)
    levels = [
        np.where(new[..., None], now, moved(each)) for each in (first.centre, first.low, first.high)
    ]
    # edges between pixels are interpolated: tolerate a share of their height
    steep = EDGE_PX / SOBEL * slopes(np.asarray(levels[0] @ LUMA, np.float32))
    return Background(
        levels[0],
        np.hypot(moved(first.spread), steep[..., None]),
        np.asarray(uncertain | new),
        levels[1],
        levels[2],
        moved(first.step),
    )
