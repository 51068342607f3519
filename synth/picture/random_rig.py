"""Pairs of cameras as people put them up."""

from typing import Final

import numpy as np

from common.body.body import Vector
from common.rig.camera import Camera, Rig, as_matrix, as_row, paper_rig
from synth.person.skeleton import turned

WIDTHS_PX: Final = (160, 320)
HEIGHTS_M, FOCALS = (0.8, 1.4), (1.0, 1.4)
"""Ranges; focal lengths in widths of the picture at 4.5 m."""
APART_DEG, RISE_M, ROLL_DEG = (50.0, 130.0), (0.5, 2.6), 6.0
"""Of cameras that stand anywhere."""


def random_rig(
    rng: np.random.Generator, slanted_share: float, distances_m: tuple[float, float]
) -> Rig:
    """Two cameras before somebody.

    Args:
        rng: Source of all choices.
        slanted_share: How probably they stand anywhere, look down and are rolled.
        distances_m: From the nearest to the farthest.
    """
    width = int(rng.choice(WIDTHS_PX))
    size = (width, width * 3 // 4)
    far, high = rng.uniform(*distances_m, 2), rng.uniform(*HEIGHTS_M, 2)
    focal = width * rng.uniform(*FOCALS) * far / 4.5
    if rng.random() >= slanted_share:
        return paper_rig(size, (focal[0], focal[1]), (far[0], far[1]), (high[0], high[1]))
    apart = rng.uniform(*APART_DEG) * rng.choice([1.0, 1.0, -1.0])
    rises = rng.uniform(*RISE_M, 2)
    return Rig(
        *size,
        tuple(
            _slanted(n, size, _on_circle(-apart * n, far[n], rises[n]), focal[n], rng)
            for n in (0, 1)
        ),
    )


def _on_circle(at_deg: float, far_m: float, high_m: float) -> Vector:
    way = np.radians(at_deg)
    return np.array([far_m * np.sin(way), high_m, far_m * np.cos(way)])


def _slanted(
    n: int, size: tuple[int, int], place: Vector, focal_px: float, rng: np.random.Generator
) -> Camera:
    """A camera somewhere on the circle that looks at the middle of a body, rolled a little."""
    forward = np.array([0.0, rng.uniform(0.8, 1.1), 0.0]) - place
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    level = np.stack([right, np.cross(forward, right), forward])
    R = turned("z", np.array([rng.normal(0.0, ROLL_DEG)]))[0] @ level
    K = ((focal_px, 0.0, size[0] / 2), (0.0, focal_px, size[1] / 2), (0.0, 0.0, 1.0))
    return Camera(f"cam{n + 1}", K, as_matrix(R), as_row(-R @ place))
