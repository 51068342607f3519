"""Textures that move: a screen that plays, trees in the wind behind a window."""

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.things.noise import clouds, scattered

Colours = NDArray[np.float64]

CUT_S: Final = 1.4
"""Time after which the screen shows another scene."""
FIGURE_M: Final = 0.7
"""Distance between the figures that cross the screen; each is a third as wide."""
CROSSING_M_S: Final = 0.5
FRAME_M: Final = 0.03
"""Width of the still, dark frame."""
GUST_HZ: Final = 0.3
"""Frequency of the gusts in which branches sway; leaves flutter at five times of it."""
SWAY_M: Final = 0.08
SKY: Final = np.array([235.0, 220.0, 205.0])
GAPS: Final = 0.4
"""Thickness of the leaves below which the sky shows through."""


def screen(base: Vector, salt: float, u: Vector, v: Vector, time_s: float) -> Colours:
    """Scenes that change with a cut; in each a cloudy ground, and figures that cross it.

    Args:
        base: (3,) colour.
        salt: Seed of what it shows.
        u: (n,) metres across.
        v: (n,) metres up.
        time_s: Since the clip began.

    Returns:
        (n, 3) colours, 0-255.
    """
    scene = np.floor(time_s / CUT_S)
    tint, bright, way = (float(scattered(scene, scene + i, salt)) for i in range(3))
    at = u + CROSSING_M_S * time_s * (1.0 if way > 0.5 else -1.0)
    figure = ((at % FIGURE_M) < FIGURE_M / 3) & (v % 1.0 < 0.8)
    ground = 0.5 + 0.5 * clouds(3 * u + time_s, 3 * v, salt + scene)
    lit = np.where(figure, 0.35 + 0.6 * tint, (0.4 + 0.8 * bright) * ground)
    turned = np.roll(base, int(3 * tint))
    return np.where(figure[:, None], base, turned) * lit[:, None]


def trees(base: Vector, salt: float, u: Vector, v: Vector, time_s: float) -> Colours:
    """Leaves that sway and flutter, the sky between them; arguments as for `screen`."""
    gust = 0.6 + 0.4 * np.sin(2 * np.pi * 0.37 * GUST_HZ * time_s + salt)
    branch = np.sin(2 * np.pi * (GUST_HZ * time_s + 0.2 * u))
    flutter = np.sin(2 * np.pi * (5 * GUST_HZ * time_s + u + 0.7 * v) + salt)
    at = u + gust * SWAY_M * (branch + 0.4 * flutter)
    leaves = 0.55 * clouds(4 * at, 4 * v, salt) + 0.45 * clouds(15 * at, 15 * v, salt + 1.0)
    green = base * (0.35 + 0.9 * leaves)[:, None]
    return np.where((leaves < GAPS)[:, None], SKY, green)


MOVING: Final[dict[str, Callable[[Vector, float, Vector, Vector, float], Colours]]] = {
    "screen": screen,
    "trees": trees,
}
"""By the kind of the thing on the wall."""


def framed(
    kind: str, base: Vector, salt: float, places: tuple[Vector, Vector], size: Vector, time_s: float
) -> Colours:
    """What a thing on the wall shows at a time, in its frame: (n, 3).

    Args:
        kind: One of MOVING.
        base: (3,) colour.
        salt: Seed of what it shows.
        places: (n,) metres across, and up, from its lower corner.
        size: (3,) of its box.
        time_s: Since the clip began.
    """
    u, v = places
    wide, tall = max(size[0], size[2]), size[1]
    edge = (u < FRAME_M) | (u > wide - FRAME_M) | (v < FRAME_M) | (v > tall - FRAME_M)
    return np.where(edge[:, None], 45.0, MOVING[kind](base, salt, u, v, time_s))
