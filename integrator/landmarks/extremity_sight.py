"""Nose, heels, toes and knuckles from landmarks where they are seen; else by the body's rule."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.extremities import EXTREMITY_NAMES
from common.body.observation import Landmarks
from common.bus.instant import Seen
from common.rig.camera import Rig, arrays_of, project, rays

Floats = NDArray[np.float64]

LEAST: Final = 0.3
"""Confidence below which a point is ignored."""
FARTHEST_SHARE: Final = 0.15
"""Distance from the body's own place, statures, beyond which a point is a mistake or another
person's."""
APART_SHARE: Final = 0.06
"""Largest gap between two lines of sight to one place, statures."""
DEPTH_BY_RULE: Final = 0.5
"""Factor on the confidence where one view alone sees a point: its depth follows from the body."""
_OTHER: Final = [
    EXTREMITY_NAMES.index({"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:])
    for name in EXTREMITY_NAMES
]
_PARTS: Final = (("l_heel", "l_toe", "r_heel", "r_toe"), ("l_knuckle", "r_knuckle"))
"""Indices of feet and hands: a view may confuse left and right."""


def seen_extremities(
    rule_m: Floats, rig: Rig, seen: Seen, stature_m: float
) -> tuple[Floats, Floats]:
    """Places, (7, 3), and confidence, (7,): 0 where no view measured it.

    Args:
        rule_m: (7, 3) places by the body's rule.
        rig: V cameras without distortion.
        seen: The person in each view, without distortion.
        stature_m: Height from sole to crown.
    """
    sure, nearest = np.zeros((len(seen), len(rule_m))), np.zeros((len(seen), len(rule_m), 3))
    for view, (camera, person) in enumerate(zip(rig.cameras, seen, strict=True)):
        shown = None if person is None else person.landmarks
        if shown is not None and shown.extremities_px:
            pixels, sure[view] = _own_sides(shown, project(camera, rule_m))
            nearest[view] = rays(camera, pixels)
    if not (sure >= LEAST).any():
        return rule_m, np.zeros(len(rule_m))
    sure = np.where(sure >= LEAST, sure, 0.0)
    places_m, confidence = _met(rule_m, rig, nearest, sure, stature_m)
    taken = np.linalg.norm(places_m - rule_m, axis=1) <= FARTHEST_SHARE * stature_m
    return np.where(taken[:, None], places_m, rule_m), np.where(taken, confidence, 0.0)


def _own_sides(shown: Landmarks, rule_px: Floats) -> tuple[Floats, Floats]:
    """A view's pixels (7, 2) and confidence (7,), left and right as the body has them."""
    pixels, sure = np.array(shown.extremities_px), np.array(shown.extremities_confidence)
    for part in _PARTS:
        at = [EXTREMITY_NAMES.index(name) for name in part]
        other = [_OTHER[i] for i in at]
        own_px = (sure[at] * np.linalg.norm(pixels[at] - rule_px[at], axis=1)).sum()
        other_px = (sure[other] * np.linalg.norm(pixels[other] - rule_px[at], axis=1)).sum()
        if other_px < own_px:
            pixels[at], sure[at] = pixels[other], sure[other]
    return pixels, sure


def _met(
    rule_m: Floats, rig: Rig, lines: Floats, sure: Floats, stature_m: float
) -> tuple[Floats, Floats]:
    """The middle between two lines of sight, or the point of a single one nearest to the rule's.

    With more than two views each point comes from the two that are surest of it.
    """
    centres = np.stack([arrays_of(camera).centre for camera in rig.cameras])
    surest = np.sort(np.argsort(-sure, axis=0, kind="stable")[:2], axis=0)
    places_m, confidence = rule_m.copy(), np.zeros(len(rule_m))
    for pair in np.unique(surest, axis=1).T:
        own = np.flatnonzero((surest == pair[:, None]).all(axis=0))
        views = np.ix_(pair, own)
        places_m[own], confidence[own] = _met_by_two(
            rule_m[own], centres[pair], lines[views], sure[views], stature_m
        )
    return places_m, confidence


def _met_by_two(
    rule_m: Floats, centres_m: Floats, lines: Floats, sure: Floats, stature_m: float
) -> tuple[Floats, Floats]:
    """`_met` for views at (2, 3), with lines (2, n, 3) and confidence (2, n)."""
    alone = [
        centre + ((rule_m - centre) * line).sum(axis=1, keepdims=True) * line
        for centre, line in zip(centres_m, lines, strict=True)
    ]
    first, second, apart = lines[0], lines[1], centres_m[0] - centres_m[1]
    cosine = (first * second).sum(axis=1)
    d, e = first @ apart, second @ apart
    slope = np.maximum(1.0 - cosine**2, 1e-6)
    on_first = centres_m[0] + ((cosine * e - d) / slope)[:, None] * first
    on_second = centres_m[1] + ((e - cosine * d) / slope)[:, None] * second
    meet = np.linalg.norm(on_first - on_second, axis=1) <= APART_SHARE * stature_m
    both = np.asarray((sure > 0).all(axis=0) & meet)
    surer = sure.argmax(axis=0)
    one = np.where(surer[:, None] == 0, alone[0], alone[1])
    places_m = np.where(both[:, None], (on_first + on_second) / 2, one)
    confidence = np.where(both, sure.min(axis=0), DEPTH_BY_RULE * sure.max(axis=0))
    return np.where(confidence[:, None] > 0, places_m, rule_m), confidence
