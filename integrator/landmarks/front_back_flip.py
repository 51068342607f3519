"""Whether a proposal has front for back: silhouettes hardly show it, faces and feet do."""

import math
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from common.body.body import lean_deg
from integrator.landmarks.landmark_rays import Rays
from integrator.proposal import pose_network

WIDE_DEG: Final = 30.0
"""Standard deviation of the facing that a view reports, degrees."""
SHARPER: Final = 3.0
"""Platt scaling of a view's confidence in its facing: the factor on the logit of the probability
that front and back are right. In a profile, front and back look alike. Of poses whose views are
.5 to .6, .6 to .7, .7 to .8 and .8 to 1 sure, 37, 15, 8 and .1 % are reversed: two performers
and synthetic people (docs/measurements.md)."""
UNTOLD: Final = 0.15
"""Probability that a view without a facing took front for back."""
ANY: Final = math.sqrt(2.0 * math.pi) * WIDE_DEG / 360.0
"""Density of any facing of a person of whom nothing is known, as a share of the peak."""
UNIFORM_FLOOR: Final = 0.005
"""Density of any other facing, as a share of the peak."""
RARELY: Final = 0.01
"""Prior probability that a proposal has front for back."""
ANEW: Final = 0.1
"""Probability that this is drawn anew from the prior at the next instant."""
TRUST: Final = 0.6
"""Exponent of an instant's likelihood: consecutive instants are correlated."""
FLIP_THRESHOLD: Final = 0.7
"""Probability above which a proposal gets flipped. It stays flipped until the probability falls
below one minus this."""


Degrees = TypeVar("Degrees", float, NDArray[np.float64])


def step(
    before: tuple[float, bool] | None, joints_m: NDArray[np.float64], rays: Rays
) -> tuple[float, bool]:
    """The probability that an instant's proposal has front for back, and whether it is flipped.

    Args:
        before: The result of the instant before; None at the first.
        joints_m: (12, 3) world, as proposed.
        rays: The views' rays; their facings count.
    """
    was, turned = (RARELY, False) if before is None else before
    now = (1.0 - ANEW) * was + ANEW * RARELY
    odds = math.log(now / (1.0 - now))
    for view in range(len(rays.centres_m)):
        if rays.facing_confidence[view] > 0.0:
            facing = yaw_deg(rays.rotations[view], joints_m)
            said = rays.facing_deg[view]
            wrong = confused(rays.facing_confidence[view])
            told = _told(said, facing + 180.0, wrong) / _told(said, facing, wrong)
            odds += TRUST * math.log(told)
    now = 1.0 / (1.0 + math.exp(-odds))
    return now, now > (1.0 - FLIP_THRESHOLD if turned else FLIP_THRESHOLD)


def contradicted(joints_m: NDArray[np.float64], rays: Rays) -> float:
    """Divisor of the odds that joints are right: above 1 where the views' facings tell another yaw.

    Silhouettes of two views at right angles are about the same for a person and for their mirror
    image across the plane between both views: that is a quarter turn at most, and no flip mends it.

    Args:
        joints_m: (12, 3) world, of JOINTS.
        rays: The views' rays; their facings count.
    """
    against = 0.0
    for view, sure in enumerate(rays.facing_confidence):
        if sure > 0.0:
            facing_deg = yaw_deg(rays.rotations[view], joints_m)
            likely = _told(rays.facing_deg[view], facing_deg, confused(sure))
            against += math.log(ANY / likely)
    return math.exp(max(0.0, against))


def faced(places_m: NDArray[np.float64], ways: NDArray[np.int_], rays: Rays) -> NDArray[np.float64]:
    """(S, S) log likelihood of the views' facings, by the way of the arms and of the legs.

    A view that exchanged both took front for back: it reports the mirror image.

    Args:
        places_m: (12, S, 3) world, the places of the joints, of JOINTS, for each way.
        ways: (S, V) 1: that view exchanged left and right.
        rays: The views' rays; their facings count.
    """
    shoulders, hips = places_m[pose_network.SHOULDERS], places_m[pose_network.HIPS]
    across = (shoulders[0] - shoulders[1])[:, None] + (hips[0] - hips[1])
    trunk = shoulders.sum(axis=0)[0] - hips.sum(axis=0)[0]
    found = np.zeros((len(ways), len(ways)))
    for view, sure in enumerate(rays.facing_confidence):
        if sure > 0.0:
            facing_deg = _facing_deg(rays.rotations[view], across, trunk)
            both = np.outer(ways[:, view], ways[:, view]) > 0
            seen_deg = np.where(both, 180.0 - facing_deg, facing_deg)
            found += np.log(_told(rays.facing_deg[view], seen_deg, confused(sure)))
    return found


def yaw_deg(rotation: NDArray[np.float64], joints_m: NDArray[np.float64]) -> float:
    """Direction of shoulders and hips, as `Landmarks.facing_deg`, (-180, 180].

    Args:
        rotation: (3, 3) from the world to the camera.
        joints_m: (12, 3)
    """
    shoulders, hips = joints_m[pose_network.SHOULDERS], joints_m[pose_network.HIPS]
    across = shoulders[0] - shoulders[1] + hips[0] - hips[1]
    return float(_facing_deg(rotation, across, shoulders.sum(axis=0) - hips.sum(axis=0)))


def _facing_deg(
    rotation: NDArray[np.float64], across: NDArray[np.float64], trunk: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Facings (...) of girdles whose left ends lie at across (..., 3) from the right ones, of a
    trunk (3,) that may lean."""
    to_right, down, away = np.moveaxis(across @ rotation.T, -1, 0)
    leans_right, leans_down, _ = (rotation @ trunk).tolist()
    lean = math.radians(lean_deg(leans_right, leans_down))
    found = np.arctan2(away, to_right * math.cos(lean) + down * math.sin(lean))
    return np.asarray(np.degrees(found))


def confused(confidence: float) -> float:
    """Probability that a view with this confidence in the facing took front for back; 0: it
    reports no facing."""
    if confidence <= 0.0:
        return UNTOLD
    return min(0.5, 1.0 / (1.0 + (confidence / (1.0 - confidence + 1e-9)) ** SHARPER))


def _told(said_deg: float, facing_deg: Degrees, wrong: float) -> Degrees:
    """Likelihood of a view's facing, given the person's true facing and the view's probability
    of confusing front and back."""
    plain = (1.0 - wrong) * _near(said_deg - facing_deg)
    return plain + wrong * _near(said_deg - (180.0 - facing_deg)) + UNIFORM_FLOOR


def _near(off_deg: Degrees) -> Degrees:
    off_deg = (off_deg + 180.0) % 360.0 - 180.0
    found: Degrees = np.exp(-0.5 * (off_deg / WIDE_DEG) ** 2)
    return found
