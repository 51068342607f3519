"""Hair, beard, eyes, brows and lips: the differences between a head's front and back."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.anny_people.figures import Figure
from synth.anny_people.folds import folds
from synth.person.people import Hair
from synth.person.rings import MATERIAL

LOWEST: Final[dict[Hair, float]] = {"short": 0.42, "bob": -0.1, "tail": 0.36}
"""Height of the hair's lower edge behind, by haircut: 0 at the base of the neck, 1 at the crown."""
BROW: Final = (0.8, 0.9)
"""Range of the height of its edge above the forehead."""
EDGE_AHEAD: Final = (0.0, 0.42, 0.56, 0.74, 1.0)
"""Places from the back of the head to the tip of the nose: behind, before the ear, temple, brow."""
PUFF_M: Final = (0.004, 0.03)
"""Distance of hair from the head."""
LOCKS: Final = 0.3
"""Relative change of that over the surface."""
THICK_M: Final = 0.015
"""Additional distance around the neck."""
LONG_M: Final = 0.16
"""Largest length below the base of the neck for half of those with a bob."""
KNOT: Final = (0.55, 0.95)
"""Range of the height of a ponytail's knot."""
KNOT_M, KNOT_HALF_M = 0.05, 0.035
BEARD_SHARE: Final = 0.12
BEARD_M: Final = (0.001, 0.012)
EYE_M, BROW_UP_M, LIPS_DOWN_M = 0.016, 0.022, 0.072
"""Radius of the dark area around an eye; height of a brow above it, depth of the lips below it."""


def grow_hair(
    figure: Figure,
    head: Vector,
    cut: Hair,
    wear: NDArray[np.int64],
    off_m: Vector,
    rng: np.random.Generator,
) -> None:
    """Hair and beard, written into the materials and the distances from the skin.

    Args:
        figure: The naked body.
        head: (v,) skinning weights of neck and head together.
        cut: The haircut.
        wear: (v,) materials, changed.
        off_m: (v,) changed.
        rng: Source of length and thickness.
    """
    places, neck = figure.vertices_m, figure.heads_m["neck01"]
    tall, skull = float(figure.crown_m()[1] - neck[1]), head > 0.5
    up = (places[:, 1] - neck[1]) / tall
    back, tip = (pick(places[skull & (up > 0.4), 2]) for pick in (np.min, np.max))
    ahead = (places[:, 2] - back) / (tip - back)
    puff_m = rng.uniform(*PUFF_M)
    if cut != "bald":
        low, brow = LOWEST[cut], rng.uniform(*BROW)
        hair = skull & (up > np.interp(ahead, EDGE_AHEAD, [low, low, 0.62, brow, brow + 0.06]))
        if cut == "bob" and rng.random() < 0.5:
            behind = (head <= 0.5) & (ahead < EDGE_AHEAD[1]) & (np.abs(places[:, 0]) < 0.11)
            hair |= behind & (places[:, 1] > neck[1] - rng.uniform(0.0, LONG_M))
        wear[hair] = MATERIAL["hair"]
        off_m[hair] = puff_m * (1.0 + LOCKS * folds(places[hair], rng))
        off_m[hair & (up < 0.3)] += THICK_M
        if cut == "tail":
            knot = np.array([0.0, neck[1] + rng.uniform(*KNOT) * tall, back])
            gap_m = np.linalg.norm(places[hair] - knot, axis=1)
            off_m[hair] += KNOT_M * np.exp(-((gap_m / KNOT_HALF_M) ** 2))
    if rng.random() < BEARD_SHARE:
        beard = skull & (ahead > 0.45) & (up > 0.1) & (up < 0.36)
        wear[beard], off_m[beard] = MATERIAL["hair"], rng.uniform(*BEARD_M)


def paint_face(figure: Figure, wear: NDArray[np.int64]) -> None:
    """Eyes, brows and lips, written into the materials (v,) where there is skin."""
    eye = figure.heads_m["eye.L"]
    aside, up = np.abs(figure.vertices_m[:, 0]), figure.vertices_m[:, 1] - eye[1]
    front = (figure.vertices_m[:, 2] > eye[2] - 0.005) & (wear == MATERIAL["skin"])
    beside = np.abs(aside - eye[0])
    wear[front & (np.hypot(aside - eye[0], 1.6 * up) < EYE_M)] = MATERIAL["dark"]
    wear[front & (beside < 0.02) & (np.abs(up - BROW_UP_M) < 0.006)] = MATERIAL["hair"]
    wear[front & (aside < 0.024) & (np.abs(up + LIPS_DOWN_M) < 0.009)] = MATERIAL["lips"]
