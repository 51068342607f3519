"""Triangulation from both views' sight lines, with its uncertainty."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.tracks.rig_guess import Pinhole
from common.body.body import Vector

Numbers = NDArray[np.float64]

NEAREST_M: Final = 0.3
"""Smallest distance of a person from a camera, metres."""

NARROW: Final = 0.2
"""Squared sine of the angle between rays below which depth uncertainty is capped: nearly equal
views would seem to agree about anything."""


class Meeting(NamedTuple):
    """Points that both views show, any shape (...)."""

    points_m: Numbers
    """(..., 3) the likeliest places, world."""
    axes: Numbers
    """(3, ..., 3) along the first ray, along the second, across both: unit vectors."""
    variances_m2: Numbers
    """(3, ...) standard deviation of the place along each, independent."""
    gap: Numbers
    """(...) signed gap between the lines, in sigmas."""
    gap_m: Numbers
    """(...) the same in metres."""
    before: NDArray[np.bool_]
    """(...) whether the place is in front of both cameras."""

    def variance_m2(self, toward: Numbers) -> Numbers:
        """(...) variance of the places along unit vectors (..., 3)."""
        cosines = np.einsum("k...i,...i->k...", self.axes, toward)
        variance: Numbers = (self.variances_m2 * cosines**2).sum(axis=0)
        return variance

    def of_joints(self, joints: NDArray[np.intp]) -> "Meeting":
        """The same for some joints, where the last axis counts joints."""
        return Meeting(
            self.points_m[:, joints],
            self.axes[:, :, joints],
            self.variances_m2[..., joints],
            self.gap[:, joints],
            self.gap_m[:, joints],
            self.before[:, joints],
        )


def directions(camera: Pinhole, middle_px: Vector, pixels: Numbers) -> Numbers:
    """(..., 3) unit vectors in the world of the rays of pixels (..., 2)."""
    flat = (pixels - middle_px) / camera.focal_px
    rays = flat @ camera.R[:2] + camera.R[2]
    unit: Numbers = rays / np.sqrt((flat**2).sum(axis=-1) + 1.0)[..., None]
    return unit


def meeting(
    cameras: tuple[Pinhole, Pinhole],
    rays: tuple[Numbers, Numbers],
    sigmas_px: tuple[Numbers, Numbers],
) -> Meeting:
    """Triangulate points from their rays (..., 3) and the errors in each picture (...).

    In the plane of both rays each ray fixes what the other leaves free; across it both contribute.
    A ray's error in metres grows with the distance to its camera. If it were constant, a world of
    too short a focal length would have smaller misses, and the fit would prefer it.
    """
    (one, other), (first, second) = cameras, rays
    base = other.centre_m - one.centre_m
    cosine = np.einsum("...i,...i", first, second)
    sine_2 = np.maximum(1.0 - cosine**2, 1e-6)
    along_1, along_2 = first @ base, second @ base
    far_1 = (along_1 - cosine * along_2) / sine_2
    far_2 = (cosine * along_1 - along_2) / sine_2
    normal = np.cross(first, second) / np.sqrt(sine_2)[..., None]
    gap_m = normal @ base
    spread_1 = _spread_m(one, first, far_1, sigmas_px[0]) ** 2
    spread_2 = _spread_m(other, second, far_2, sigmas_px[1]) ** 2
    both, told = spread_1 + spread_2, np.maximum(sine_2, NARROW)
    points = one.centre_m + far_1[..., None] * first
    points += (spread_1 / both * gap_m)[..., None] * normal
    return Meeting(
        points,
        np.stack([first, second, normal]),
        np.stack([spread_2 / told, spread_1 / told, spread_1 * spread_2 / both]),
        gap_m / np.sqrt(both),
        gap_m,
        (far_1 > NEAREST_M) & (far_2 > NEAREST_M),
    )


def _spread_m(camera: Pinhole, rays: Numbers, far_m: Numbers, sigma_px: Numbers) -> Numbers:
    """(...) error of rays across themselves, at that distance from the camera."""
    depth_m = np.maximum(far_m, NEAREST_M) * (rays @ camera.R[2])
    spread: Numbers = sigma_px / camera.focal_px * depth_m
    return spread
