"""What stands and hangs in a random room: walls, furniture along them, pictures that move."""

from typing import Final, NamedTuple

import numpy as np

from common.body.body import Vector
from common.rig.camera import Rig, centre
from synth.things.moving_pictures import MOVING
from synth.things.textures import Finish, finish

BEHIND_M: Final = 0.6
"""Depth of the room behind each camera."""
FURNISHED_M: Final = (-1.9, 1.7)
"""Range along the walls behind the person in which objects stand."""
WIDEST_M: Final = 0.9
"""Largest width of an object along a wall."""


class Cuboid(NamedTuple):
    """An object in the room: an axis-aligned box with one finish."""

    low: Vector
    high: Vector
    finish: Finish


class Wall(NamedTuple):
    """A wall, and the stretch of it for objects."""

    axis: int
    """Axis of its normal: 0 for x, 2 for z."""
    at_m: float
    inwards: float
    """Sign of the normal into the room."""
    from_m: float
    to_m: float
    """Start of the objects along the other axis."""


def walls_of(rng: np.random.Generator, rig: Rig) -> list[Cuboid]:
    """The room itself, the first box: it is seen from inside, and contains all cameras."""
    places = np.stack([centre(camera) for camera in rig.cameras])
    far = max(5.0, float(np.abs(places).max())) + BEHIND_M
    low = np.array([-far, 0.0, -rng.uniform(1.5, 2.5)])
    high = np.array([rng.uniform(1.5, 2.5), rng.uniform(2.5, 2.9), far])
    low = np.minimum(low, places.min(axis=0) - [BEHIND_M, 0.0, BEHIND_M])
    high = np.maximum(high, places.max(axis=0) + BEHIND_M)
    return [Cuboid(low, high, finish("room", rng))]


def walls_seen(room: Cuboid, cameras: int) -> list[Wall]:
    """The walls at the back and at the person's left, which two cameras see; the others with
    more cameras."""
    low, high, last = room.low.tolist(), room.high.tolist(), (room.high - WIDEST_M).tolist()
    walls = [Wall(2, low[2], 1.0, *FURNISHED_M), Wall(0, high[0], -1.0, *FURNISHED_M)]
    if cameras > 2:
        walls += [Wall(2, high[2], -1.0, low[0], last[0]), Wall(0, low[0], 1.0, low[2], last[2])]
    return walls


def furniture(rng: np.random.Generator, walls: list[Wall]) -> list[Cuboid]:
    """Objects along the walls."""
    boxes = []
    for wall in walls:
        along = wall.from_m
        while along < wall.to_m:
            kind = str(rng.choice(["shelf", "chest", "picture", "curtain", "door", "none"]))
            wide = float(rng.uniform(0.45, WIDEST_M))
            if kind != "none":
                boxes.append(_against(rng, kind, along, wide, wall))
            along += wide + float(rng.uniform(0.15, 0.7))
    return boxes


def moving_things(rng: np.random.Generator, walls: list[Wall]) -> list[Cuboid]:
    """A wide screen or window in the middle of each wall."""
    boxes = []
    for wall in walls:
        kind, wide = str(rng.choice(list(MOVING))), float(rng.uniform(1.2, 2.2))
        middle = float(np.clip(rng.uniform(-0.5, 0.5), wall.from_m, wall.to_m))
        boxes.append(_against(rng, kind, middle - wide / 2, wide, wall))
    return boxes


_HEIGHTS: Final = {
    "shelf": (0.0, 0.0, 0.9, 1.5, 0.3),
    "chest": (0.0, 0.0, 0.45, 0.8, 0.4),
    "picture": (1.1, 1.4, 1.55, 1.8, 0.03),
    "curtain": (0.1, 0.4, 1.6, 2.0, 0.05),
    "door": (0.0, 0.0, 1.9, 2.05, 0.04),
    "screen": (0.3, 0.8, 1.7, 2.3, 0.02),
    "trees": (0.3, 0.8, 1.7, 2.3, 0.02),
}
"""Ranges of the lower edge, of the upper edge, and of the depth: metres."""


def _against(rng: np.random.Generator, kind: str, along: float, wide: float, wall: Wall) -> Cuboid:
    bottom_from, bottom_to, top_from, top_to, deep = _HEIGHTS[kind]
    bottom, top = rng.uniform(bottom_from, bottom_to), rng.uniform(top_from, top_to)
    low, high = np.array([along, bottom, along]), np.array([along + wide, top, along + wide])
    low[wall.axis], high[wall.axis] = sorted((wall.at_m, wall.at_m + wall.inwards * deep))
    return Cuboid(low, high, finish(kind, rng))
