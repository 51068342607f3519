"""Both views' silhouettes of one instant, and how well poses fit both: S1 S2."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats, Vector
from common.body.kinematics import ALL_LIMBS
from common.body.observation import Observation
from common.bus.instant import Seen
from common.compiled import compiled
from common.raster.bits import Bits, count
from common.raster.kernel import draw_limbs, match, match_over, view_of
from common.raster.silhouette_report import words_of
from common.rig.camera import Rig


class Silhouettes(NamedTuple):
    """A person in both views, in pictures of one size."""

    views: Vector
    """(2, VIEW), true perspective."""
    seen: Bits
    """The silhouettes, packed (2, H, words)."""
    seen_px: NDArray[np.int64]
    """Their numbers of pixels, (2,)."""
    width: int
    """Width of the pictures, pixels."""


def silhouettes_of(rig: Rig, seen: tuple[Observation, Observation]) -> Silhouettes:
    """The silhouettes of two reports, and the views of a rig.

    Pictures of two sizes both get the larger width and height.
    """
    each = [words_of(person) for person in seen]
    rows, words = np.max([mask.shape for mask in each], axis=0)
    masks = np.zeros((2, rows, words), np.uint64)
    for whole, mask in zip(masks, each, strict=True):
        whole[: mask.shape[0], : mask.shape[1]] = mask
    return Silhouettes(
        np.array([view_of(camera) for camera in rig.cameras]),
        masks,
        np.array([count(mask) for mask in masks]),
        max(person.width for person in seen),
    )


def poorest(pose: Vector, body: Vector, rig: Rig, seen: Seen) -> float:
    """The smaller S of a pose in both views; 1 where a view shows no person."""
    first, second = seen
    if first is None or second is None:
        return 1.0
    views, masks, areas, width = silhouettes_of(rig, (first, second))
    return min(
        float(match(body, pose, view, ALL_LIMBS, width, mask, int(area)))
        for view, mask, area in zip(views, masks, areas, strict=True)
    )


@compiled
def products(
    body: Vector,
    poses: Floats,
    limbs: int,
    views: Floats,
    seen: Bits,
    seen_px: NDArray[np.int64],
    width: int,
) -> Floats:
    """The product of S over the views, of each pose, (n,).

    Args:
        body: Body vector.
        poses: (n, 25).
        limbs: The limbs in which the poses differ, as bits; the rest is drawn once.
        views: (cameras, VIEW), true perspective.
        seen: The silhouettes, packed (cameras, H, words).
        seen_px: Their numbers of pixels, (cameras,).
        width: Width of the pictures, pixels.
    """
    found = np.ones(poses.shape[0])
    for n in range(views.shape[0]):
        rest = np.zeros_like(seen[n])
        draw_limbs(body, poses[0], views[n], ALL_LIMBS & ~limbs, width, rest)
        for i in range(poses.shape[0]):
            found[i] *= match_over(
                rest, body, poses[i], views[n], limbs, width, seen[n], seen_px[n]
            )
    return found
