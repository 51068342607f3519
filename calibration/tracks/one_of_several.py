"""One person in all views of an uncalibrated rig, where views show several people."""

from collections.abc import Mapping, Sequence
from itertools import combinations, product
from typing import Final

import msgspec

from calibration.tracks.joint_tracks import (
    LEAST_SURE,
    JointTrack,
    Sighting,
    row_of,
    track_of,
    track_of_rows,
)
from calibration.tracks.lateness import clock_of, miss_at
from common.bus.messages import View

OFTEN: Final = 0.1
"""Share of a view's frames that show several people, from which on they are told apart."""
LEAST_SHARE: Final = 0.25
"""Share of the longest track's sure frames that another must have to be compared."""
MOST_TRACKS: Final = 3
"""Number of a view's longest tracks that are compared."""
UNLIKE: Final = 2.0
"""Miss of tracks that show too little together."""
ALIKE: Final = 0.35
"""Miss up to which two tracks are taken for one person's, as in `sight_clash.py`."""
NO_SIZE: Final = (0, 0)
"""Stands for the size of the pictures, of which the relation knows nothing."""

Tracks = Mapping[int, JointTrack]
"""By the viewer's own number of a person."""


Track = tuple[int, int]
"""A view's place, and the viewer's number in it."""


def person_tracks(views: Sequence[Sequence[View]]) -> list[JointTrack]:
    """The landmarks of one person in each view.

    Where views show one person at a time, that is who each follows. Else the viewers' own tracks
    are compared: those of one person have a relation that any two cameras have
    (`view_relation.py`), those of two people hardly have one. Where none are surely one person's,
    it is who each view follows.

    Args:
        views: Of each camera, all frames.
    """
    followed = [track_of(own) for own in views]
    if not any(map(_shows_several, views)):
        return followed
    each = [_own_tracks(own) for own in views]
    miss = {
        ((v, one), (w, other)): _miss(each[v][one], each[w][other])
        for v, w in combinations(range(len(each)), 2)
        for one, other in product(each[v], each[w])
    }
    found = [_alike(each, miss, first) for first in each[0]]
    worst, chosen = min(found, default=(UNLIKE, []))
    if worst > ALIKE:
        return followed
    return [each[v][number] for v, number in chosen]


def _alike(
    each: Sequence[Tracks], miss: Mapping[tuple[Track, Track], float], first: int
) -> tuple[float, list[Track]]:
    """The tracks of the other views that miss a track of the first view, and each other, least;
    before them the largest miss among them."""
    chosen: list[Track] = [(0, first)]
    for view, tracks in enumerate(each[1:], start=1):
        if not tracks:
            return UNLIKE, chosen
        best = min(tracks, key=lambda n: sum(miss[one, (view, n)] for one in chosen))
        chosen.append((view, best))
    return max(miss[pair] for pair in combinations(chosen, 2)), chosen


def _shows_several(views: Sequence[View]) -> bool:
    several = sum(len(view.people) > 1 for view in views)
    return several > OFTEN * len(views)


def _own_tracks(views: Sequence[View]) -> dict[int, JointTrack]:
    """The longest tracks of a view, each over all of its frames."""
    numbers = {one.track for view in views for one in view.people if one.landmarks is not None}
    tracks = {
        number: track_of_rows([row_of(_of_track(view, number)) for view in views])
        for number in numbers
    }
    sure = {number: _sure_frames(track) for number, track in tracks.items()}
    longest = sorted(sure, key=lambda number: -sure[number])[:MOST_TRACKS]
    return {n: tracks[n] for n in longest if sure[n] > LEAST_SHARE * sure[longest[0]]}


def _of_track(view: View, number: int) -> View:
    people = tuple(one for one in view.people if one.track == number)
    return msgspec.structs.replace(view, people=people)


def _sure_frames(track: JointTrack) -> int:
    return int((track.confidence.mean(axis=1) >= LEAST_SURE).sum())


def _miss(one: JointTrack, other: JointTrack) -> float:
    """How badly two tracks fit any two cameras, at the delay at which they fit best."""
    sighting = Sighting(one, other, NO_SIZE)
    found = miss_at(sighting, clock_of(sighting).late_s)
    return UNLIKE if found is None else found
