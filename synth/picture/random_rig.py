"""Random camera rigs as people set them up: pairs, and any number around a person."""

from typing import Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.rig.camera import Camera, Rig, as_matrix, as_row, centre, paper_rig
from synth.person.skeleton import turned
from synth.picture.exposure import default_rig

WIDTHS_PX: Final = (160, 320)
HEIGHTS_M, FOCALS = (0.8, 1.4), (1.0, 1.4)
"""Ranges of the heights, and of the focal lengths in picture widths at 4.5 m."""
APART_DEG, RISE_M, ROLL_DEG = (50.0, 130.0), (0.5, 2.6), 6.0
"""Angle between cameras that stand anywhere, their height, and the deviation of their roll."""
FRONT_SHARE, ASIDE_SHARE, ABOUT_DEG = 0.3, 0.25, 15.0
"""Shares of first cameras that stand about before the person, and beside them; the deviation of
these."""
HEIGHTS_PX: Final = (240, 240, 180, 427)
"""Heights of the pictures, which are 320 wide."""
LEVEL_SHARE, LEVEL_M, HUNG_M, ROLLED_SHARE, ROLLED_DEG = 0.6, (0.7, 1.5), (0.3, 3.2), 0.3, 4.0
DISTANCES_M, WIDTHS, AT_M = (2.2, 5.8), (0.85, 1.4), 4.5
"""Ranges of distances, and focal lengths in widths, as HOW_FAR times those for a nearer or
farther person."""
HOW_FAR: Final = (0.75, 1.3)
CROSS_DEG, CROSSED_SHARE, RIGHT_SHARE = (45.0, 135.0), 0.5, 0.3
"""Range of the angle to the second camera where it is not 90, the share of such rigs, and the
share of second cameras on the right."""
FURTHER_DEG: Final = (135.0, 60.0, -150.0, -30.0, 100.0, 165.0)
"""Bearings of camera 3 and on; the default rig's are 0, before the person, and -90, at their
right. Any first few of them are evenly spread. No two stand opposite each other, where rays
coincide."""
MOST_CAMERAS: Final = 2 + len(FURTHER_DEG)
"""Largest number of cameras of a rig around a person."""
FURTHER_OFF_DEG, FURTHER_FAR_M, FURTHER_HIGH_M = 5.0, (4.5, 5.0), (0.8, 2.2)
"""Deviations of their bearings; ranges of distance and height."""
FURTHER_AIM_M, FURTHER_FOCALS, FURTHER_ROLL_DEG = (0.9, 1.05), (0.92, 1.0), 1.0
"""Height of the point looked at; focal length over the default rig's; deviation of the roll."""


def random_rig(
    rng: np.random.Generator, slanted_share: float, distances_m: tuple[float, float]
) -> Rig:
    """Two cameras before a person.

    Args:
        rng: Source of all choices.
        slanted_share: Probability that they stand anywhere, look down and are rolled.
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


def rig_around(size: tuple[int, int], count: int, seed: int) -> Rig:
    """The default rig with further cameras all around the middle of the room.

    Args:
        size: Width and height of the pictures.
        count: Number of cameras, 1 to MOST_CAMERAS; a rig of more begins with those of fewer.
        seed: Seed of the exact places of the further ones.
    """
    rig = default_rig(*size)
    rng = np.random.default_rng([seed, 4])
    further = (_further(n, size, rig, rng) for n in range(2, count))
    return msgspec.structs.replace(rig, cameras=(*rig.cameras[:count], *further))


def stood_back(rig: Rig, share: float) -> Rig:
    """The rig with its cameras farther from the middle by a share, at their heights."""
    farther = np.array([1.0 + share, 1.0, 1.0 + share])
    moved = (
        msgspec.structs.replace(camera, t=as_row(-np.array(camera.R) @ (centre(camera) * farther)))
        for camera in rig.cameras
    )
    return msgspec.structs.replace(rig, cameras=tuple(moved))


def _further(n: int, size: tuple[int, int], rig: Rig, rng: np.random.Generator) -> Camera:
    """Camera n, from 0, of a rig around a person: it looks at the middle of a body."""
    at_deg = FURTHER_DEG[n - 2] + rng.uniform(-FURTHER_OFF_DEG, FURTHER_OFF_DEG)
    place = _on_circle(at_deg, rng.uniform(*FURTHER_FAR_M), rng.uniform(*FURTHER_HIGH_M))
    roll_deg = FURTHER_ROLL_DEG * rng.normal()
    R = turned("z", np.array([roll_deg]))[0] @ _looking(place, rng.uniform(*FURTHER_AIM_M))
    return _camera(n, size, rig.cameras[0].K[0][0] * rng.uniform(*FURTHER_FOCALS), R, place)


def rig_about(rng: np.random.Generator, middle_m: Vector) -> Rig:
    """Two cameras anywhere around a person who faces +z at first.

    Args:
        rng: Source of all choices.
        middle_m: (3,) middle of the body.
    """
    size = (320, int(rng.choice(HEIGHTS_PX)))
    chance, about_deg = rng.random(), ABOUT_DEG * rng.normal()
    if chance < FRONT_SHARE:
        at_deg = about_deg
    elif chance < FRONT_SHARE + ASIDE_SHARE:
        at_deg = about_deg + rng.choice([-90.0, 90.0])
    else:
        at_deg = rng.uniform(-180.0, 180.0)
    apart_deg = rng.uniform(*CROSS_DEG) if rng.random() < CROSSED_SHARE else 90.0
    other_deg = at_deg - apart_deg * (-1.0 if rng.random() < RIGHT_SHARE else 1.0)
    level = bool(rng.random() < LEVEL_SHARE)
    stands_m = middle_m * [1.0, 0.0, 1.0]
    cameras = (
        _about(n, size, at, stands_m, level, rng) for n, at in enumerate((at_deg, other_deg))
    )
    return Rig(*size, tuple(cameras))


def _about(
    n: int,
    size: tuple[int, int],
    at_deg: float,
    stands_m: Vector,
    level: bool,
    rng: np.random.Generator,
) -> Camera:
    """A camera that looks at the middle of a person, or level."""
    far_m = rng.uniform(*DISTANCES_M)
    place = _on_circle(at_deg, far_m, rng.uniform(*(LEVEL_M if level else HUNG_M)))
    focal_px = size[0] * rng.uniform(*WIDTHS) * float(np.clip(far_m / AT_M, *HOW_FAR))
    aim = place[1] if level else rng.uniform(0.75, 1.1)
    roll_deg = ROLLED_DEG * rng.normal() if rng.random() < ROLLED_SHARE else 0.0
    R = turned("z", np.array([roll_deg]))[0] @ _looking(place, aim)
    return _camera(n, size, focal_px, R, place + stands_m)


def _looking(place: Vector, aim_m: float) -> NDArray[np.float64]:
    """From the world to the axes of a camera without roll that looks at a point above the
    floor's middle."""
    forward = np.array([0.0, aim_m, 0.0]) - place
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(forward, right), forward])


def _on_circle(at_deg: float, far_m: float, high_m: float) -> Vector:
    way = np.radians(at_deg)
    return np.array([far_m * np.sin(way), high_m, far_m * np.cos(way)])


def _slanted(
    n: int, size: tuple[int, int], place: Vector, focal_px: float, rng: np.random.Generator
) -> Camera:
    """A camera anywhere on the circle that looks at the middle of a body, slightly rolled."""
    level = _looking(place, rng.uniform(0.8, 1.1))
    R = turned("z", np.array([rng.normal(0.0, ROLL_DEG)]))[0] @ level
    return _camera(n, size, focal_px, R, place)


def _camera(
    n: int, size: tuple[int, int], focal_px: float, R: NDArray[np.float64], place_m: Vector
) -> Camera:
    """Camera n, from 0, without distortion."""
    K = ((focal_px, 0.0, size[0] / 2), (0.0, focal_px, size[1] / 2), (0.0, 0.0, 1.0))
    return Camera(f"cam{n + 1}", K, as_matrix(R), as_row(-R @ place_m))
