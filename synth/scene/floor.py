"""The floor of a scene: where people can stand in all pictures, and where they go out."""

from itertools import combinations
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.rig.camera import Camera, Rig, centre
from synth.picture.synth_room import Room
from synth.scene.script import Floor

ASIDE_M: Final = 0.4
"""Half the width of a person who stands or walks."""
SPAN_M: Final = 0.95
"""Half the width of a person in the T-pose."""
NEAREST_M: Final = 3.4
"""Smallest distance of a person from a camera: nearer, the feet leave a picture of 4:3."""
FURNITURE_M: Final = 0.8
"""Distance from a wall: furniture and half a person."""
FARTHEST_M: Final = 1.5
"""Half the side of the square in which places are sought."""
OUT_M: Final = 0.9
"""Distance behind a wall at which a walk out ends."""
CAMERA_M: Final = 1.0
"""Smallest distance from a camera on a way out."""
GRID: Final = 41
"""Number of places tried, each way."""
MIDDLE_M: Final = 1.0
"""Height at which a picture's width counts."""


class Ground(NamedTuple):
    """The places of a scene."""

    places_m: Floor
    """(k, 2) where a person is in all pictures."""
    opening_m: Floor
    """(k, 2) where a person in the T-pose is."""
    room: Room
    eyes_m: Floor
    """(cameras, 2) places of the cameras."""


def ground(rig: Rig, room: Room) -> Ground:
    """The places before some cameras in a room.

    Raises:
        ValueError: When there are none.
    """
    side = np.linspace(-FARTHEST_M, FARTHEST_M, GRID)
    tried = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    low, high = room.low[[0, 2]] + FURNITURE_M, room.high[[0, 2]] - FURNITURE_M
    tried = tried[((tried >= low) & (tried <= high)).all(axis=1)]
    standing, spread = (
        np.stack([_shows(camera, tried, rig, half_m) for camera in rig.cameras]).all(axis=0)
        for half_m in (ASIDE_M, SPAN_M)
    )
    spread &= (tried[:, 0] >= low[0] + 0.2) & (tried[:, 0] <= high[0] - 0.2)
    if not (spread & standing).any():
        raise ValueError("the cameras have no place in common where a person is seen whole")
    eyes_m = np.stack([centre(camera)[[0, 2]] for camera in rig.cameras])
    return Ground(tried[standing], tried[spread & standing], room, eyes_m)


def inside(room: Room, places_m: Floor, behind_m: float = 0.0) -> NDArray[np.bool_]:
    """Whether places (n, 2) are in the room, or up to a distance behind its walls."""
    low, high = room.low[[0, 2]] - behind_m, room.high[[0, 2]] + behind_m
    return np.asarray(((places_m >= low) & (places_m <= high)).all(axis=1))


def way_out(place: Ground, from_m: Floor) -> Floor:
    """(2,) the place behind the nearest wall to which a straight way leads past all cameras."""
    low, high = place.room.low[[0, 2]] - OUT_M, place.room.high[[0, 2]] + OUT_M
    sides = ((0, low[0]), (0, high[0]), (1, low[1]), (1, high[1]))
    nearest = sorted(sides, key=lambda side: abs(side[1] - from_m[side[0]]))
    ways = []
    for axis, wall in nearest:
        out = np.array(from_m, np.float64)
        out[axis] = wall
        ways.append(out)
    free = (out for out in ways if _gap_m(from_m, out, place.eyes_m) >= CAMERA_M)
    return next(free, ways[0])


def least_aside_m(place: Ground, places_m: Floor) -> float:
    """Smallest distance of any of the places (n, 2) from the line between a camera and another of
    them, farther away: less than half the width of a person hides who is behind."""
    pairs = combinations(places_m, 2)
    return min(
        (_aside_m(one - eye, other - eye) for one, other in pairs for eye in place.eyes_m),
        default=np.inf,
    )


def _aside_m(one_m: Floor, other_m: Floor) -> float:
    """Distance of the nearer of two places from the line to the farther one, from the camera."""
    farther_m = max(np.hypot(*one_m), np.hypot(*other_m))
    return abs(float(one_m[0] * other_m[1] - one_m[1] * other_m[0])) / float(farther_m)


def _gap_m(from_m: Floor, to_m: Floor, points_m: Floor) -> float:
    """Smallest distance of a straight way from some points (n, 2)."""
    along = from_m + np.linspace(0.0, 1.0, 50)[:, None] * (to_m - from_m)
    return float(np.linalg.norm(along[:, None] - points_m, axis=2).min())


def _shows(camera: Camera, places_m: Floor, rig: Rig, half_m: float) -> NDArray[np.bool_]:
    """Whether a camera's picture is wide enough for a person at each place, (n,)."""
    R, K = np.array(camera.R), np.array(camera.K)
    points = np.insert(places_m, 1, MIDDLE_M, axis=1)
    seen = points @ R.T + np.array(camera.t)
    depth = np.maximum(seen[:, 2], 0.1)
    at_px, half_px = K[0, 0] * seen[:, 0] / depth + K[0, 2], K[0, 0] * half_m / depth
    fits = (at_px - half_px >= 0.0) & (at_px + half_px <= rig.width)
    eye = centre(camera)[[0, 2]]
    return np.asarray(fits & (np.linalg.norm(places_m - eye, axis=1) >= NEAREST_M))
