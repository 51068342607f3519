"""How near the sight lines of two views' observations have passed in the last instants."""

from collections.abc import Sequence
from itertools import combinations
from typing import Final, NamedTuple

import numpy as np

from calibration.gate.sight_clash import gap_m
from common.body.clothes import colour_distance
from common.body.observation import Observation
from common.rig.camera import Rig

GAP_COLOUR_M: Final = 0.05
"""What a difference of colours of 1 adds to the gap between two views' sight lines, metres."""
INSTANTS: Final = 15
"""Number of instants of which gaps are the running mean."""

People = Sequence[Sequence[Observation]]
"""The observations of each view."""
Place = tuple[int, int]
"""A view, and the index of one of its observations."""


class Gap(NamedTuple):
    """What two tracks of two views have shown of one person or of two."""

    tracks: tuple[tuple[int, int], tuple[int, int]]
    """A view and its viewer's number of the person, twice."""
    mean_m: float
    """Running mean of the gap between their sight lines, and of what their colours differ."""
    instants: int
    last_m: float = 0.0
    """Of the last instant that told."""


class Apart:
    """Gap between two observations of an instant, metres; infinite where it is not known."""

    def __init__(self, people: People, gaps: Sequence[Gap]) -> None:
        self._people, self._gaps = people, {gap.tracks: gap for gap in gaps}

    def __call__(self, one: Place, other: Place) -> float:
        """The running mean."""
        gap = self.gap(one, other)
        return np.inf if gap is None else gap.mean_m

    def gap(self, one: Place, other: Place) -> Gap | None:
        """With the number of its instants; None where it is not known."""
        first, second = sorted((one, other))
        return self._gaps.get((track_of(self._people, first), track_of(self._people, second)))


def with_instant(gaps: Sequence[Gap], rig: Rig, people: People) -> tuple[Gap, ...]:
    """The gaps between observations' sight lines, with those of an instant; those of two of whom
    one is not seen now are forgotten.

    Args:
        gaps: Of the instant before.
        rig: V cameras without distortion.
        people: Of each view, without distortion.
    """
    before, after = {gap.tracks: gap for gap in gaps}, []
    everyone = [(view, index) for view, each in enumerate(people) for index in range(len(each))]
    for one, other in combinations(everyone, 2):
        if one[0] == other[0]:
            continue
        tracks = track_of(people, one), track_of(people, other)
        known = before.get(tracks, Gap(tracks, 0.0, 0))
        apart_m = sight_gap_m(rig, people, one, other)
        if not np.isnan(apart_m):
            colours = (people[view][index].colours for view, index in (one, other))
            now_m = apart_m + GAP_COLOUR_M * colour_distance(*colours)
            count = min(known.instants + 1, INSTANTS)
            known = Gap(tracks, known.mean_m + (now_m - known.mean_m) / count, count, now_m)
        if known.instants:
            after.append(known)
    return tuple(after)


def sight_gap_m(rig: Rig, people: People, one: Place, other: Place) -> float:
    """Median gap between the sight lines of two observations, metres; NaN where it is not known."""
    cameras = rig.cameras[one[0]], rig.cameras[other[0]]
    return gap_m(cameras, people[one[0]][one[1]], people[other[0]][other[1]])


def track_of(people: People, place: Place) -> tuple[int, int]:
    """The view of an observation, and its viewer's number of the person."""
    return place[0], people[place[0]][place[1]].track
