"""Textures of walls, floors and furniture: colours by place."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.things.moving_pictures import MOVING, framed
from synth.things.noise import clouds, scattered

Colours = NDArray[np.float64]


class Finish(NamedTuple):
    """A finish; the meaning of its colours depends on the kind."""

    kind: str
    walls: str
    floor: str
    base: Vector
    accent: Vector
    detail: Vector
    pitch_m: float
    salt: float
    """Seed of this object's grain."""


WALLS: Final = ("plaster", "stripes", "bricks", "panels")
FLOORS: Final = ("boards", "tiles", "carpet")


def finish(kind: str, rng: np.random.Generator) -> Finish:
    """A random finish for a kind of object: room, shelf, chest, picture, curtain, door, screen or
    trees."""
    strong = kind in ("curtain", "picture", "shelf", "chest", "screen")
    tints = [_tint(rng, 0.55 if strong else 0.18) for _ in range(3)]
    if kind == "room":
        tints[0] *= 0.75 + 0.25 * rng.random()
        tints[2] = np.array([0.45, 0.65, 0.9]) * rng.uniform(110, 190)
        if rng.random() < 0.5:
            tints[2] = _tint(rng, 0.12) * 0.8
    if kind == "trees":
        tints[0] = np.array([0.45, 0.9, 0.55]) * rng.uniform(90, 170)
    walls, floor = str(rng.choice(WALLS)), str(rng.choice(FLOORS))
    pitch = float(rng.uniform(0.09, 0.2))
    base, accent, detail = tints
    return Finish(kind, walls, floor, base, accent, detail, pitch, float(rng.uniform(0, 50)))


def painted(
    look: Finish, points_m: NDArray[np.float64], low: Vector, high: Vector, time_s: float = 0.0
) -> Colours:
    """Colours (n, 3), 0-255, of points on the faces of a box (n, 3), at a time of the clip."""
    x, y, z = points_m.T
    across = np.where(_on(z, low[2], high[2]), x, z)
    if look.kind == "room":
        return _shell(look, points_m, across, low, high)
    u, v = across - (low[0] if high[0] - low[0] > high[2] - low[2] else low[2]), y - low[1]
    if look.kind in MOVING:
        return framed(look.kind, look.base, look.salt, (u, v), high - low, time_s)
    paint = {"shelf": _shelf, "chest": _chest, "picture": _picture, "curtain": _curtain}
    return paint.get(look.kind, _door)(look, u, v, high - low)


def _shell(
    look: Finish, points_m: NDArray[np.float64], across: Vector, low: Vector, high: Vector
) -> Colours:
    x, y, z = points_m.T
    colours = _wall(look, across, y)
    colours[y < 0.09] = 0.25 * look.base + 150.0
    ground, roof = _on(y, low[1], low[1]), _on(y, high[1], high[1])
    colours[ground] = _ground(look, x[ground], z[ground])
    colours[roof] = 0.2 * look.base + 130.0
    return colours


def _wall(look: Finish, u: Vector, v: Vector) -> Colours:
    stain = 0.92 + 0.12 * clouds(2.1 * u, 2.1 * v, look.salt)
    mix = np.zeros_like(u)
    if look.walls == "stripes":
        mix = 1.0 * (np.floor(u / look.pitch_m) % 2)
    elif look.walls == "bricks":
        row = np.floor(v / 0.075)
        joint = ((v % 0.075) < 0.009) | (((u + 0.11 * (row % 2)) % 0.22) < 0.009)
        mix = (
            0.25
            + 0.35 * scattered(np.floor((u + 0.11 * (row % 2)) / 0.22), row, look.salt)
            + 0.5 * joint
        )
    elif look.walls == "panels":
        mix = np.where(v < 0.9, 1.0, 0.0) + 0.5 * ((u % (4 * look.pitch_m)) < 0.012) * (v < 0.9)
    mixed = 0.62 * look.base + 0.22 * look.accent
    return (look.base + mix[:, None] * (mixed - look.base)) * stain[:, None]


def _ground(look: Finish, x: Vector, z: Vector) -> Colours:
    if look.floor == "boards":
        board = np.floor(x / 0.11)
        plank = np.floor((z + 7.0 * scattered(board, board, look.salt)) / 1.1)
        tone = 0.78 + 0.34 * scattered(board, plank, look.salt) - 0.25 * ((x % 0.11) < 0.006)
        tone = tone + 0.08 * clouds(60.0 * x, 3.0 * z, look.salt)
    elif look.floor == "tiles":
        tone = 0.95 - 0.3 * (((x % 0.4) < 0.012) | ((z % 0.4) < 0.012))
        tone = tone + 0.1 * scattered(np.floor(x / 0.4), np.floor(z / 0.4), look.salt)
    else:
        tone = (
            0.7 + 0.12 * clouds(30 * x, 30 * z, look.salt) + 0.08 * scattered(x * 400, z * 400, 1.0)
        )
    return look.detail * tone[:, None]


def _shelf(look: Finish, u: Vector, v: Vector, size: Vector) -> Colours:
    wide, tall = max(size[0], size[2]), size[1]
    board = np.floor(v / 0.3)
    frame = (u < 0.04) | (u > wide - 0.04) | ((v % 0.3) < 0.03) | (v > tall - 0.04)
    book = np.floor(u / 0.035)
    height = 0.15 + 0.1 * scattered(book, board, look.salt)
    books = 0.55 + 0.45 * scattered(book, board, look.salt + 3.0)
    inside = np.where((v % 0.3) - 0.03 < height, books, 0.15)
    return np.where(frame[:, None], 0.5 * look.base, inside[:, None] * look.accent)


def _chest(look: Finish, u: Vector, v: Vector, _size: Vector) -> Colours:
    tone = 0.75 + 0.15 * clouds(4 * u, 25 * v, look.salt) - 0.35 * ((v % 0.26) < 0.015)
    return 0.75 * look.base * tone[:, None]


def _picture(look: Finish, u: Vector, v: Vector, size: Vector) -> Colours:
    wide, tall = max(size[0], size[2]), size[1]
    frame = (u < 0.03) | (u > wide - 0.03) | (v < 0.03) | (v > tall - 0.03)
    mix = clouds(9 * u, 9 * v, look.salt)[:, None]
    return np.where(frame[:, None], 45.0, look.base * mix + look.accent * (1 - mix))


def _curtain(look: Finish, u: Vector, v: Vector, _size: Vector) -> Colours:
    fold = 0.5 + 0.5 * np.sin(2 * np.pi * (u + 0.01 * np.sin(3 * v)) / (0.6 * look.pitch_m))
    mixed = look.base + fold[:, None] * (look.accent - look.base)
    return mixed * (0.75 + 0.25 * fold[:, None])


def _door(look: Finish, u: Vector, v: Vector, _size: Vector) -> Colours:
    board = np.floor(v / 0.34)
    tone = 0.7 + 0.25 * scattered(board, np.floor(u / 0.5), look.salt) - 0.3 * ((v % 0.34) < 0.012)
    return look.base * (tone + 0.06 * clouds(3 * u, 40 * v, look.salt))[:, None]


def _on(value: Vector, low: float, high: float) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] = (np.abs(value - low) < 1e-6) | (np.abs(value - high) < 1e-6)
    return found


def _tint(rng: np.random.Generator, strength: float) -> Vector:
    grey, hue = rng.uniform(120.0, 225.0), rng.normal(0.0, 1.0, 3)
    tint: Vector = np.clip(grey * (1.0 + strength * hue / 2), 25.0, 240.0)
    return tint
