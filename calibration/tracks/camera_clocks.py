"""The delay of each camera of a rig against the first one."""

import numpy as np

from calibration.tracks.joint_tracks import Sightings
from calibration.tracks.lateness import LEAST_LATE, UNSEEN, Clock, clock_of

Clocks = tuple[Clock, ...]
"""One for each view after the first: what view 1 shows at t, that view shows at t + late_s of its
own times."""


def clocks_of(seen: Sightings) -> Clocks:
    """The delay of each view after the first, as far as the views determine it.

    A delay that a view and the first one leave open is that of a third view whose own is found,
    plus the delay between these two, where that is found. Of all such ways to a delay the smallest
    counts that is within a frame of their median: two views from nearly opposite sides may be a
    frame off by themselves.
    """
    count = len(seen.tracks)
    found = {n: clock_of(seen.pair(0, n)) for n in range(1, count)}
    for _ in range(count - 2):
        for n in [n for n, clock in found.items() if not clock.is_found]:
            found[n] = _by_a_third(seen, found, n)
    return tuple(_by_all(seen, found, n) for n in found)


def _by_all(seen: Sightings, found: dict[int, Clock], number: int) -> Clock:
    """The delay of a view where it would be corrected, by the first view and all others."""
    own, times_s = found[number], seen.tracks[number].times_s
    if not own.is_found or len(times_s) < 2 or len(found) < 2:
        return own
    period_s = float(np.median(np.diff(times_s)))
    if abs(own.late_s) < LEAST_LATE * period_s:
        return own
    ways_s = [own.late_s]
    for other, clock in found.items():
        between = clock_of(seen.pair(other, number)) if other != number else UNSEEN
        if clock.is_found and between.is_found:
            ways_s.append(clock.late_s + between.late_s)
    near = [way for way in ways_s if abs(way - float(np.median(ways_s))) <= period_s]
    return own._replace(late_s=min(near or ways_s, key=abs))


def _by_a_third(seen: Sightings, found: dict[int, Clock], number: int) -> Clock:
    """The delay of a view, by the first of the others that determines it."""
    for other, clock in found.items():
        if other != number and clock.is_found:
            between = clock_of(seen.pair(other, number))
            if between.is_found:
                late_s = clock.late_s + between.late_s
                return Clock(late_s, (), between.may_be_on_time and clock.may_be_on_time)
    return found[number]


def clock_between(clocks: Clocks, one: int, other: int) -> Clock | None:
    """The delay of one view of a rig, from 0, against another; None: to be estimated."""
    if one == 0 and other > 0:
        return clocks[other - 1]
    first, second = (Clock(0.0) if n == 0 else clocks[n - 1] for n in (one, other))
    if not (first.is_found and second.is_found):
        return None
    return Clock(second.late_s - first.late_s)
