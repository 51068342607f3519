"""Contacts of a foot: it is low and slow, and remains in contact until it is neither for a
while."""

import math
from heapq import heappop, heappush, heappushpop
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from animator.skeleton.bones import Joints
from common.body.body import JOINT_NAMES, Vector

Side = Literal["l", "r"]
SIDES: Final[tuple[Side, Side]] = ("l", "r")

COMES_M_S, GOES_M_S = 0.30, 0.60
"""Speeds of the ankle below which a contact begins, and above which it ends."""
LOW_M, HIGH_M = 0.04, 0.07
"""Heights of the ankle above its standing height, likewise."""
WANDERS_M: Final = 0.05
"""Distance from the contact's place beyond which a new contact begins."""
STANDS_S: Final = 0.15
"""Shortest contact; a shorter one is only a touch."""
STEPS_S: Final = 0.3
"""Longest break of a contact: a foot that is back so soon, within WANDERS_M and without having
been lifted, has not stepped; a starting track is off for a few frames."""
LOWEST: Final = 20
"""Percentile of the lower ankle's height in a run that gives the standing height."""


class Stance(NamedTuple):
    """One contact of a foot with the floor."""

    side: Side
    first: int
    """Its first row; `end` is the first one after it."""
    end: int


def stances(joints_m: Joints, time_s: Vector) -> list[Stance]:
    """All contacts of a run.

    Args:
        joints_m: (n, joints, 3), +y up; rows without a pose are NaN and end a contact.
        time_s: (n,) increasing, at least two.
    """
    ankles = joints_m[:, [JOINT_NAMES.index(f"{side}_ankle") for side in SIDES]]
    posed = np.isfinite(ankles).all(axis=(1, 2))
    if not posed.any():
        return []
    floor_m = np.percentile(ankles[posed, :, 1].min(axis=1), LOWEST)
    found = []
    for side, ankle in zip(SIDES, ankles.swapaxes(0, 1), strict=True):
        low = ankle[:, 1] - floor_m
        slow = _speeds(ankle, time_s)
        with np.errstate(invalid="ignore"):
            comes = (low < LOW_M) & (slow < COMES_M_S)
            stays = (low < HIGH_M) & (slow < GOES_M_S)
        held = [
            (first, end)
            for first, end in _held(comes, stays, ankle)
            if time_s[end - 1] - time_s[first] >= STANDS_S - 1e-9
        ]
        found += [Stance(side, *contact) for contact in _bridged(held, ankle, low < HIGH_M, time_s)]
    return found


def _bridged(
    held: list[tuple[int, int]], ankle_m: Vector, is_low: NDArray[np.bool_], time_s: Vector
) -> list[tuple[int, int]]:
    """Contacts between which a foot slips for a moment are joined, at the first one's place."""
    whole: list[tuple[int, int]] = []
    stood_m = np.full(2, np.inf)
    for first, end in held:
        here_m = np.median(ankle_m[first:end, [0, 2]], axis=0)
        if (
            whole
            and time_s[first] - time_s[whole[-1][1] - 1] <= STEPS_S + 1e-9
            and math.dist(here_m, stood_m) <= WANDERS_M
            and is_low[whole[-1][1] : first].all()
        ):
            whole[-1] = (whole[-1][0], end)
            continue
        whole.append((first, end))
        stood_m = here_m
    return whole


def _speeds(places_m: Vector, time_s: Vector) -> Vector:
    """Velocity of a point (n, 3), from the row before to the row after; one-sided at ends and
    gaps."""
    steps = np.linalg.norm(np.diff(places_m, axis=0), axis=1) / np.diff(time_s)
    both = np.full((2, len(places_m)), np.nan)
    both[0, 1:], both[1, :-1] = steps, steps
    both = np.where(np.isnan(both), both[::-1], both)
    speeds: Vector = both.mean(axis=0)
    return speeds


def _held(
    comes: NDArray[np.bool_], stays: NDArray[np.bool_], ankle_m: Vector
) -> list[tuple[int, int]]:
    found, first = [], -1
    over_floor = ankle_m[:, [0, 2]].tolist()
    mostly = (_Median(), _Median())
    for i, (x, z) in enumerate(over_floor):
        if first >= 0:
            far_m = math.hypot(x - mostly[0].value(), z - mostly[1].value())
            if not stays[i] or far_m > WANDERS_M:
                found.append((first, i))
                first = -1
        if first < 0 and comes[i]:
            first, mostly = i, (_Median(), _Median())
        if first >= 0:
            mostly[0].add(x)
            mostly[1].add(z)
    return [*found, (first, len(comes))] if first >= 0 else found


class _Median:
    """Running median of numbers: an hour of standing costs no more per row."""

    def __init__(self) -> None:
        self._below: list[float] = []
        """Heap of the smaller half, negated: as many as above, or one more."""
        self._above: list[float] = []

    def add(self, value: float) -> None:
        largest = -heappushpop(self._below, -value)
        heappush(self._above, largest)
        if len(self._above) > len(self._below):
            heappush(self._below, -heappop(self._above))

    def value(self) -> float:
        if len(self._below) > len(self._above):
            return -self._below[0]
        return (self._above[0] - self._below[0]) / 2
