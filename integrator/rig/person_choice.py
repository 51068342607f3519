"""The people in each view who are most likely one person."""

from collections.abc import Sequence
from itertools import combinations
from typing import Final

import numpy as np

from calibration.gate.sight_clash import CLASHES_M, gap_m
from common.body.body import Vector
from common.body.observation import Observation
from common.rig.camera import Camera, Rig, project

People = tuple[Observation, ...]
Chosen = tuple[int, ...]
"""For each view, the index of the person among its people; -1: none of them."""
One = tuple[int, int]
"""A view, and the index of one of its people."""

GAP_COST: Final = 4.0
"""Cost of two people whose sight lines clash; it falls with the square of their gap."""
UNKNOWN_COST: Final = 1.0
"""Cost of two people of whom too few joints are sure."""
AWAY_COST: Final = 5.0
"""Cost of a person at their height or more from where the person is expected. Another person whom
two views show costs more than views that clash about the expected one."""
LATER_COST: Final = 0.25
"""Cost of a person whom the viewer does not follow."""
SMALL_COST: Final = 2.0
"""Cost of a person of no size, beside the largest of the view, where none is expected; it falls
with the size."""
ASIDE: Final = 0.5
"""Share of the height by which a person at a picture's side counts as smaller: they may pass."""


def costs_of(camera: Camera, people: People, expected_m: Vector | None) -> list[float]:
    """The cost of each of a view's people by itself.

    Args:
        camera: Without distortion.
        people: In its picture, without distortion.
        expected_m: Expected place of the person, (3,) world; None: none is followed.
    """
    costs = [LATER_COST * (index > 0) for index in range(len(people))]
    if not people:
        return costs
    if expected_m is None:
        sizes = [_size(person) for person in people]
        small = [1.0 - size / max(sizes) for size in sizes]
        return [cost + SMALL_COST * each for cost, each in zip(costs, small, strict=True)]
    at_px = project(camera, expected_m[None])[0]
    away = [_away_heights(person, at_px) for person in people]
    return [cost + AWAY_COST * far for cost, far in zip(costs, away, strict=True)]


def chosen(rig: Rig, people: Sequence[People], costs: Sequence[Sequence[float]]) -> Chosen:
    """The likeliest two people of two views, then one of each other view.

    Args:
        rig: V cameras without distortion.
        people: Of each view.
        costs: Of each of them.
    """
    indices = {n: 0 for n, each in enumerate(people) if each}
    if any(len(each) > 1 for each in people):
        indices = _likeliest(rig, people, costs)
    return tuple(indices.get(n, -1) for n in range(len(people)))


def _likeliest(
    rig: Rig, people: Sequence[People], costs: Sequence[Sequence[float]]
) -> dict[int, int]:
    """Index of the person by view; each two people are tried, with the nearest of other views."""
    everyone = [(n, index) for n, each in enumerate(people) for index in range(len(each))]
    gaps = {
        (one, other): _gap_cost(rig, people, one, other)
        for one, other in combinations(everyone, 2)
        if one[0] != other[0]
    }
    own = {one: costs[one[0]][one[1]] for one in everyone}
    tried = [_with_others(pair, gaps, own) for pair in gaps] or [(own[one], (one,)) for one in own]
    return dict(min(tried)[1])


def _with_others(
    pair: tuple[One, One], gaps: dict[tuple[One, One], float], own: dict[One, float]
) -> tuple[float, tuple[One, ...]]:
    """Two people and the nearest of each other view, after what they cost."""
    total = gaps[pair] + sum(own[one] for one in pair)
    found: tuple[One, ...] = pair
    for n in sorted({one[0] for one in own} - {one[0] for one in pair}):
        candidates = [
            (own[one] + sum(gaps[min(one, each), max(one, each)] for each in pair), one)
            for one in own
            if one[0] == n
        ]
        cost, nearest = min(candidates)
        total, found = total + cost, (*found, nearest)
    return total, found


def _gap_cost(rig: Rig, people: Sequence[People], one: One, other: One) -> float:
    cameras = rig.cameras[one[0]], rig.cameras[other[0]]
    apart_m = gap_m(cameras, people[one[0]][one[1]], people[other[0]][other[1]])
    return UNKNOWN_COST if np.isnan(apart_m) else GAP_COST * min(apart_m / CLASHES_M, 1.0) ** 2


def _size(person: Observation) -> float:
    """A person's height in the picture, pixels; less at its sides than in its middle."""
    box, half_px = person.box, 0.5 * person.width
    aside = abs(0.5 * (box.left + box.right + 1) - half_px) / half_px
    return (box.bottom + 1 - box.top) * (1.0 - ASIDE * aside)


def _away_heights(person: Observation, at_px: Vector) -> float:
    """Distance of the middle of a person from a place, in their heights, 1 at most."""
    box = person.box
    middle_px = np.array([box.left + box.right + 1, box.top + box.bottom + 1]) / 2.0
    away = float(np.linalg.norm(middle_px - at_px)) / max(box.bottom - box.top, 1)
    return min(away, 1.0) if np.isfinite(away) else 1.0  # NaN: it is behind the camera
