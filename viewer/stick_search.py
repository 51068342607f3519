"""The search of a stick pose for its best match: limbs by beam, then every number by tritree."""

from typing import Any, Final

import numba
import numpy as np

from common.bits import count, count_both
from common.kernel import score
from common.spans import PRIMITIVE
from common.stickman import ANGLE, BREADTH, POSE_SIZE, RATIO, STATURE, place_chain, place_segments
from viewer.strokes import ALL_SEGMENTS, added, draw_segments
from viewer.tritree import MOST_STAGES, narrowed

BEAM: Final = 10
"""Upper limbs that are kept while their lower limbs are tried."""
UPPER_STEP_DEG, LOWER_STEP_DEG = 15.0, 20.0
SHORTENINGS: Final = np.array([1.0, 0.8, 0.5, 0.2])
"""Ratios that the beam tries: 0, 37, 60 and 78 degrees out of the picture's plane."""

TIME, TRUNK_TILT, LEG_TILT, ARM_TILT, BREADTH_CHANGE, STATURE_CHANGE, LEAN, BEND, CROSS = range(
    9
)
"""Places in a vector of costs, in S: for a limb to swing by 60 degrees (its vector's change of 1)
since it was expected; for trunk, legs and arms to leave the plane of the picture; for breadth and
for stature to change by all they are; for the trunk to lean by 90 degrees; for an elbow
to bend in the plane by 90, or a knee where the trunk shows its breadth; for a knee or foot seen from
the front to cross to the other side by a stature."""
TILTED: Final = 0.15
"""1 - ratio^2 at which a limb's leaving the plane has half its full cost (23 degrees): what cannot
be seen stays in the plane, what can be seen is free to turn further."""


@numba.njit(cache=True)
def limb_cost(pose: Any, expected: Any, limb: int, trust: float, costs: Any) -> float:
    """What a limb's place costs: how far it turned in space since it was expected, and depth.

    Both signs of its depth are alike here, so that is how far it is from the nearer one.
    """
    a, b = np.radians(pose[ANGLE + limb]), np.radians(expected[ANGLE + limb])
    r, e = min(pose[RATIO + limb], 1.0), min(expected[RATIO + limb], 1.0)
    dx, dy = r * np.cos(a) - e * np.cos(b), r * np.sin(a) - e * np.sin(b)
    dz = np.sqrt(1.0 - r * r) - np.sqrt(1.0 - e * e)
    moved = trust * costs[TIME] * (dx * dx + dy * dy + 0.25 * dz * dz)
    off = 1.0 - r * r
    if limb < 2:
        return moved + costs[TRUNK_TILT] * off
    return moved + costs[LEG_TILT if limb < 6 else ARM_TILT] * off / (off + TILTED)


@numba.njit(cache=True)
def bend_cost(pose: Any, upper: int, costs: Any) -> float:
    """What the bend of an elbow or a knee costs, as far as it lies in the plane."""
    bend = np.radians(pose[ANGLE + upper + 2] - pose[ANGLE + upper])
    share = costs[BEND] * pose[RATIO + upper] * pose[RATIO + upper + 2] * (1.0 - np.cos(bend))
    return share if upper >= 6 else share * pose[BREADTH]


@numba.njit(cache=True)
def cross_cost(ends: Any, pose: Any, costs: Any) -> float:
    """What knees and feet on the wrong sides cost."""
    wrong = 0.0
    for limb in (2, 4):
        wrong += max(0.0, ends[limb, 2] - ends[limb + 1, 2])
    return costs[CROSS] * pose[BREADTH] * wrong / pose[STATURE]


@numba.njit(cache=True)
def pose_cost(pose: Any, ends: Any, expected: Any, trust: float, costs: Any) -> float:
    """What a whole pose costs."""
    wider, taller = pose[BREADTH] - expected[BREADTH], pose[STATURE] / expected[STATURE] - 1.0
    total = costs[BREADTH_CHANGE] * wider * wider + costs[STATURE_CHANGE] * taller * taller
    lean = np.cos(np.radians(pose[ANGLE]))
    total += costs[LEAN] * lean * lean + cross_cost(ends, pose, costs)
    for limb in range(10):
        total += limb_cost(pose, expected, limb, trust, costs)
    for upper in (2, 3, 6, 7):
        total += bend_cost(pose, upper, costs)
    return total


@numba.njit(cache=True)
def worth(
    lengths: Any,
    parts: Any,
    depth: float,
    pose: Any,
    expected: Any,
    trust: float,
    costs: Any,
    seen: Any,
    seen_px: int,
    width: int,
    ends: Any,
    bits: Any,
    which: int,
) -> float:
    """S of some segments less what the pose costs."""
    place_segments(lengths, pose, ends)
    bits[:] = np.uint64(0)
    draw_segments(ends, pose, parts, depth, which, width, bits)
    s = score(count_both(bits, seen), count(bits), seen_px)
    return s - pose_cost(pose, ends, expected, trust, costs)


@numba.njit(cache=True)
def refined(
    lengths: Any,
    parts: Any,
    depth: float,
    pose: Any,
    expected: Any,
    trust: float,
    costs: Any,
    seen: Any,
    width: int,
    moves: Any,
    units: Any,
    half: int,
    stop: int,
    lows: Any,
    highs: Any,
    which: int,
) -> tuple[float, int]:
    """Each move in turn to its best by the overlapped tritree, around where it is.

    Args:
        pose: (POSE_SIZE,), improved in place.
        moves: (k, POSE_SIZE): what a move adds to the pose, times a whole number of its unit.
        units: (k,).
        half: Half the window, units; `stop` its width at the end.
        lows: (POSE_SIZE,) and `highs`: bounds.

    Returns:
        (worth, matches).
    """
    ends, bits = np.empty((12, 4)), np.zeros_like(seen)
    seen_px = count(seen)
    best = worth(
        lengths, parts, depth, pose, expected, trust, costs, seen, seen_px, width, ends, bits, which
    )
    matches = 1
    trial, start = pose.copy(), pose.copy()
    probes = np.empty(3)
    for k in range(moves.shape[0]):
        start[:] = pose
        low, high = -half, half
        probes[0], probes[1], probes[2] = np.nan, best, np.nan
        for _ in range(MOST_STAGES):
            if high - low <= stop:
                break
            for i in range(3):
                if np.isnan(probes[i]):
                    offset = (low + i * ((high - low) // 2)) * units[k]
                    for n in range(POSE_SIZE):
                        trial[n] = min(max(start[n] + offset * moves[k, n], lows[n]), highs[n])
                    probes[i] = worth(
                        lengths,
                        parts,
                        depth,
                        trial,
                        expected,
                        trust,
                        costs,
                        seen,
                        seen_px,
                        width,
                        ends,
                        bits,
                        which,
                    )
                    matches += 1
                    if probes[i] > best:
                        best = probes[i]
                        pose[:] = trial
            low, high, probes[0], probes[1], probes[2] = narrowed(
                low, high, probes[0], probes[1], probes[2]
            )
    return best, matches


@numba.njit(cache=True)
def beamed(
    lengths: Any,
    parts: Any,
    depth: float,
    pose: Any,
    expected: Any,
    trust: float,
    costs: Any,
    seen: Any,
    width: int,
    upper: int,
    low_deg: float,
    high_deg: float,
    bend_deg: float,
    which: int,
) -> int:
    """An upper and its lower limb found together: pose is changed in place; returns the matches."""
    lower = upper + 2
    height = seen.shape[0]
    ends, p = np.empty((12, 4)), np.empty(PRIMITIVE)
    first, last = np.empty(height, np.int32), np.empty(height, np.int32)
    place_segments(lengths, pose, ends)
    rest = np.zeros_like(seen)
    both = 1 << upper | 1 << lower
    draw_segments(ends, pose, parts, depth, which & ~both, width, rest)
    scratch, seen_px = rest.copy(), count(seen)
    rest_px, rest_hit = count(rest), count_both(rest, seen)
    matches = 0
    kept = np.full((BEAM, 3), -9.0)
    was = np.array(
        (pose[ANGLE + upper], pose[RATIO + upper], pose[ANGLE + lower], pose[RATIO + lower])
    )
    angles = int((high_deg - low_deg) / UPPER_STEP_DEG) + 1
    for n in range(angles * SHORTENINGS.size + 1):
        if n == angles * SHORTENINGS.size:
            pose[ANGLE + upper], pose[RATIO + upper] = was[0], was[1]
        else:
            pose[ANGLE + upper] = low_deg + UPPER_STEP_DEG * (n // SHORTENINGS.size)
            pose[RATIO + upper] = SHORTENINGS[n % SHORTENINGS.size]
        place_chain(upper, lengths, pose, ends)
        drawn, hit = added(
            ends, pose, parts, depth, 1 << upper, width, rest, seen, scratch, first, last, p
        )
        matches += 1
        s = score(rest_hit + hit, rest_px + drawn, seen_px)
        s -= limb_cost(pose, expected, upper, trust, costs)
        worst = np.argmin(kept[:, 0])
        if s > kept[worst, 0]:
            kept[worst, 0], kept[worst, 1], kept[worst, 2] = (
                s,
                pose[ANGLE + upper],
                pose[RATIO + upper],
            )
    best = -9.0
    found = was.copy()
    bends = int(2.0 * bend_deg / LOWER_STEP_DEG) + 1
    for k in range(BEAM + 1):
        if k == BEAM:
            pose[ANGLE + upper], pose[RATIO + upper] = was[0], was[1]
        elif kept[k, 0] < -8.0:
            continue
        else:
            pose[ANGLE + upper], pose[RATIO + upper] = kept[k, 1], kept[k, 2]
        upper_cost = limb_cost(pose, expected, upper, trust, costs)
        for n in range(bends * SHORTENINGS.size + 1):
            if n == bends * SHORTENINGS.size:
                pose[ANGLE + lower], pose[RATIO + lower] = was[2], was[3]
            else:
                bend = -bend_deg + LOWER_STEP_DEG * (n // SHORTENINGS.size)
                pose[ANGLE + lower] = pose[ANGLE + upper] + bend
                pose[RATIO + lower] = SHORTENINGS[n % SHORTENINGS.size]
            place_chain(upper, lengths, pose, ends)
            drawn, hit = added(
                ends, pose, parts, depth, both, width, rest, seen, scratch, first, last, p
            )
            matches += 1
            s = score(rest_hit + hit, rest_px + drawn, seen_px)
            s -= upper_cost + limb_cost(pose, expected, lower, trust, costs)
            s -= bend_cost(pose, upper, costs)
            if upper < 6:
                s -= cross_cost(ends, pose, costs)
            if s > best:
                best = s
                found[0], found[1] = pose[ANGLE + upper], pose[RATIO + upper]
                found[2], found[3] = pose[ANGLE + lower], pose[RATIO + lower]
    pose[ANGLE + upper], pose[RATIO + upper] = found[0], found[1]
    pose[ANGLE + lower], pose[RATIO + lower] = found[2], found[3]
    return matches
