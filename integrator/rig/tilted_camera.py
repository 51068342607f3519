"""One uncalibrated camera: its downward tilt and its height, from the person in its pictures.

An upright person who comes nearer along the floor grows in the picture, and the rate shows where
the horizon is. The thesis takes the middle of the picture for it (3.1.5), which holds for a level
camera alone: under a ceiling camera people would lean, and the floor would rise.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.body.observation import Observation
from common.rig.camera import Camera, Rig, as_matrix, as_row
from integrator.rig.assumed_rig import FOCAL_SHARE

TILTS_DEG: Final = np.arange(-20.0, 51.0)
"""Downward tilts that are tried, degrees."""
LEVEL: Final = np.zeros(1)
HEIGHTS_M: Final = np.geomspace(0.25, 5.0, 76)
"""Heights of the camera above the floor that are tried, metres."""
NEAR: Final = 0.06
"""Standard deviation of one observation, as a share of the camera's height. This and the
following were chosen on synthetic people before cameras at any height: seeds 700 to 735, tilts
off by 9 degrees, 16 where they were taken for level."""
SIGHTS: Final = (120.0, 30.0)
"""Weight of a clip's observations relative to the prior: the square of the range of distances
along the floor, over the person's height, and its upper bound. Feet rise with each step, too."""
FARTHEST: Final = 0.05
"""Quantiles of the rows at which the person stood farthest and nearest."""
LEVEL_DEG: Final = 15.0
"""Prior standard deviation of the tilt."""
USUAL_M: Final = (0.8, 2.5)
"""Prior range of the height: most cameras stand or hang so high."""
UNUSUAL: Final = 0.25
"""Relative standard deviation of the height outside that range."""
MOST_SIGHTS: Final = 300
"""Largest number of observations that are used."""
FARTHEST_M: Final = 12.0
"""Largest distance of a person, metres."""
LOWEST_M: Final = 1e-3
"""Height used instead of one below the floor."""


def assumed_rig_of_one(person: Observation, stature_m: float) -> Rig:
    """The rig of a run with one view, from its first observation of an upright person, wholly in
    view.

    Args:
        person: That observation.
        stature_m: Assumed stature of the person.
    """
    size = (person.width, person.height)
    sight = np.array([[person.box.top, person.box.bottom + 1.0]])
    camera = camera_of_sights(size, sight, stature_m)
    return Rig(*size, (camera, camera))


def camera_of_sights(
    size: tuple[int, int],
    sights: NDArray[np.float64],
    stature_m: float,
    tilts_deg: Vector = TILTS_DEG,
) -> Camera:
    """The camera at the origin's side that looks along -z, before which the person mostly stood.

    Args:
        size: Width and height of the picture.
        sights: (n, 2) rows of the crown and below the feet of the person, wholly in view; rows of
            other postures are rejected as outliers as long as they are few.
        stature_m: Assumed stature of the person.
        tilts_deg: Possible tilts; for the thesis's camera `LEVEL` alone.
    """
    focal = FOCAL_SHARE * size[0]
    some = sights[:: max(1, len(sights) // MOST_SIGHTS)]
    down = np.arctan((some - size[1] / 2) / focal)
    tilt, height_m = _likeliest(down, _weight(some), stature_m, tilts_deg)
    steep = float(np.tan(tilt + np.median(down[:, 1])))
    far_m = height_m / max(steep, height_m / FARTHEST_M)
    R = np.array([[1, 0, 0], [0, -np.cos(tilt), np.sin(tilt)], [0, -np.sin(tilt), -np.cos(tilt)]])
    K = ((focal, 0.0, size[0] / 2), (0.0, focal, size[1] / 2), (0.0, 0.0, 1.0))
    return Camera("cam1", K, as_matrix(R), as_row(-R @ np.array([0.0, height_m, far_m])))


def _weight(sights: NDArray[np.float64]) -> float:
    """Weight of the observations: none where the person stood at one place."""
    farthest, nearest = np.quantile(sights[:, 1], (FARTHEST, 1.0 - FARTHEST))
    share = (nearest - farthest) / np.median(sights[:, 1] - sights[:, 0])
    return float(min(SIGHTS[0] * share**2, SIGHTS[1]))


def _likeliest(
    down: Vector, weight: float, stature_m: float, tilts_deg: Vector
) -> tuple[float, float]:
    """Tilt of a camera, radians downwards, and its height, metres.

    Args:
        down: (n, 2) angles of crowns and soles below the middle of the picture.
        weight: Weight of the observations.
        stature_m: As above; likewise `tilts_deg`.
    """
    steep = np.tan(np.radians(tilts_deg)[:, None, None] + down)
    crowns, soles = steep[..., 0], steep[..., 1]
    stands = (soles > 0.0) & (soles > crowns)
    seen_m = np.where(stands, stature_m * soles / np.where(stands, soles - crowns, 1.0), LOWEST_M)
    off = np.log(seen_m[:, None] / HEIGHTS_M[:, None]) / NEAR
    unlike = (off**2 / (1.0 + off**2)).mean(axis=2)
    heights_m = HEIGHTS_M[unlike.argmin(axis=1)]
    unusual = np.maximum(np.log(USUAL_M[0] / heights_m), np.log(heights_m / USUAL_M[1])) / UNUSUAL
    doubt = weight * unlike.min(axis=1) + 0.5 * np.maximum(unusual, 0.0) ** 2
    doubt += 0.5 * (tilts_deg / LEVEL_DEG) ** 2
    doubt[stands.mean(axis=1) < 0.5] = np.inf
    best = int(doubt.argmin())
    return float(np.radians(tilts_deg[best])), float(heights_m[best])
