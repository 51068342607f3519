"""The search of a stick pose for its best match: limbs by beam search, then every number by
tritree."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats, Vector
from common.body.stick_body import ANGLE, POSE_SIZE, RATIO, place_chain, place_segments
from common.compiled import compiled
from common.raster.bits import Bits, count, count_both
from common.raster.kernel import score
from common.raster.row_spans import PRIMITIVE, Columns
from common.raster.stick_raster import added, draw_segments
from viewer.paper.tritree import MOST_STAGES, narrowed
from viewer.stick.stick_costs import bend_cost, cross_cost, limb_cost, pose_cost

BEAM: Final = 6
"""Number of upper-limb candidates that are kept while their lower limbs are tried."""
UPPER_STEP_DEG, LOWER_STEP_DEG = 15.0, 20.0
SHORTENINGS: Final = np.array([1.0, 0.8, 0.5, 0.2])
"""Ratios that the beam search tries: 0, 37, 60 and 78 degrees out of the picture's plane."""
NOTHING: Final = -9.0
"""A worth below any possible one."""


class Task(NamedTuple):
    """The fit's inputs; compiled functions read its members."""

    lengths: Vector
    parts: Vector
    depth: float
    """The Stickman's arrays."""
    seen: Bits
    seen_px: int
    width: int
    """The silhouette, its number of pixels, and the width of the picture."""
    expected: Vector
    """(POSE_SIZE,): the predicted pose."""
    trust: float
    """Factor on the cost of turning: less where nothing is known."""
    costs: Vector


Canvas = tuple[Bits, Bits, Floats, Columns, Columns, Vector]
"""Working memory of a search: the drawn rest and a scratch (H, words), the segments' ends (12,
4), the first and the last pixel of each row (H,), a part's primitive (PRIMITIVE,)."""


class Moves(NamedTuple):
    """Directions in which a pose is searched, one after the other."""

    rows: Floats
    """(k, POSE_SIZE): what one unit of a move adds to the pose."""
    units: Vector
    moving: NDArray[np.int64]
    """(k,) segments that move, as bits: the others are drawn once."""
    lows: Vector
    highs: Vector
    """(POSE_SIZE,): bounds."""


@compiled
def worth(task: Task, pose: Vector, which: int, ends: Floats, bits: Bits) -> float:
    """S of some segments minus the pose's cost; `ends` and `bits` are overwritten."""
    place_segments(task.lengths, pose, ends)
    bits[:] = np.uint64(0)
    draw_segments(ends, pose, task.parts, task.depth, which, task.width, bits)
    s = score(count_both(bits, task.seen), count(bits), task.seen_px)
    return s - pose_cost(pose, ends, task.expected, task.trust, task.costs)


@compiled
def refined(
    task: Task, pose: Vector, moves: Moves, how_many: int, half: int, stop: int, which: int
) -> tuple[float, int]:
    """The first moves, each in turn set to its best by the overlapped tritree around the present
    value.

    Args:
        task: A Task.
        pose: (POSE_SIZE,), improved in place.
        moves: Moves.
        how_many: Number of moves to use.
        half: Half the window, units.
        stop: Width of the window at the end.
        which: The segments drawn, as bits.

    Returns:
        (worth, matches).
    """
    ends, bits, trial = np.empty((12, 4)), np.zeros_like(task.seen), pose.copy()
    best, matches = worth(task, pose, which, ends, bits), 1
    probes, rest = np.empty(3), np.zeros_like(task.seen)
    over = (rest, bits, ends, *_rows(task.seen.shape[0]))
    for k in range(how_many):
        start = pose.copy()
        low, high = -half, half
        probes[0], probes[1], probes[2] = np.nan, best, np.nan
        _moved(trial, start, moves, k, 0.0)
        place_segments(task.lengths, trial, ends)
        rest[:] = np.uint64(0)
        still = which & ~moves.moving[k]
        draw_segments(ends, trial, task.parts, task.depth, still, task.width, rest)
        bits[:] = rest
        drawn, hit = count(rest), count_both(rest, task.seen)
        for _ in range(MOST_STAGES):
            if high - low <= stop:
                break
            for i in range(3):
                if np.isnan(probes[i]):
                    _moved(trial, start, moves, k, (low + i * ((high - low) // 2)) * moves.units[k])
                    place_segments(task.lengths, trial, ends)
                    probes[i] = _similar(task, trial, which & ~still, over, drawn, hit)
                    probes[i] -= pose_cost(trial, ends, task.expected, task.trust, task.costs)
                    matches += 1
                    if probes[i] > best:
                        best = probes[i]
                        pose[:] = trial
            low, high, probes[0], probes[1], probes[2] = narrowed(
                low, high, probes[0], probes[1], probes[2]
            )
    return best, matches


@compiled
def _moved(trial: Vector, start: Vector, moves: Moves, k: int, by: float) -> None:
    """Write the pose after a move, within the bounds."""
    for n in range(POSE_SIZE):
        at = start[n] + by * moves.rows[k, n]
        trial[n] = min(max(at, moves.lows[n]), moves.highs[n])


@compiled
def _rows(height: int) -> tuple[NDArray[np.int32], NDArray[np.int32], Floats]:
    """Working memory for the row intervals of a part, and for the part."""
    return np.empty(height, np.int32), np.empty(height, np.int32), np.empty(PRIMITIVE)


@compiled
def _similar(
    task: Task, pose: Vector, which: int, over: Canvas, rest_px: int, rest_hit: int
) -> float:
    """S of some placed segments over a drawn rest whose pixels and hits are known."""
    rest, scratch, ends, first, last, p = over
    drawn, hit = added(
        ends, pose, task.parts, task.depth, which, task.width, rest, task.seen, scratch,
        first, last, p,
    )  # fmt: skip
    return score(rest_hit + hit, rest_px + drawn, task.seen_px)


@compiled
def _limb_of(
    pose: Vector, limb: int, was: Vector, n: int, first_deg: float, step_deg: float
) -> None:
    """Set a limb to the n-th of the beam's angles and ratios; n = -1: to its previous ones."""
    if n < 0:
        pose[ANGLE + limb], pose[RATIO + limb] = was[ANGLE + limb], was[RATIO + limb]
    else:
        pose[ANGLE + limb] = first_deg + step_deg * (n // SHORTENINGS.size)
        pose[RATIO + limb] = SHORTENINGS[n % SHORTENINGS.size]


@compiled
def _uppers(
    task: Task, pose: Vector, was: Vector, upper: int, over: Canvas, low_deg: float, high_deg: float
) -> tuple[Floats, int]:
    """The best places of an upper limb alone: ((BEAM, 2): worth, number), matches."""
    rest, ends = over[0], over[2]
    rest_px, rest_hit = count(rest), count_both(rest, task.seen)
    kept = np.full((BEAM, 2), NOTHING)
    tries = (int((high_deg - low_deg) / UPPER_STEP_DEG) + 1) * SHORTENINGS.size
    for n in range(-1, tries):
        _limb_of(pose, upper, was, n, low_deg, UPPER_STEP_DEG)
        place_chain(upper, task.lengths, pose, ends)
        s = _similar(task, pose, 1 << upper, over, rest_px, rest_hit)
        s -= limb_cost(pose, task.expected, upper, task.trust, task.costs)
        worst = np.argmin(kept[:, 0])
        if s > kept[worst, 0]:
            kept[worst, 0], kept[worst, 1] = s, n
    return kept, tries + 1


@compiled
def beamed(
    task: Task,
    pose: Vector,
    upper: int,
    low_deg: float,
    high_deg: float,
    bend_deg: float,
    which: int,
) -> int:
    """An upper limb and its lower limb, searched together over their whole ranges.

    Args:
        task: A Task.
        pose: (POSE_SIZE,), changed in place.
        upper: The upper limb.
        low_deg: Lower end of its directions in the picture; `high_deg` is the upper one.
        high_deg: Upper end of the directions.
        bend_deg: Largest bend of the lower limb, either way.
        which: The segments drawn, as bits.

    Returns:
        Number of matches.
    """
    lower, was = upper + 2, pose.copy()
    ends, both = np.empty((12, 4)), 1 << upper | 1 << lower
    place_segments(task.lengths, pose, ends)
    rest = np.zeros_like(task.seen)
    draw_segments(ends, pose, task.parts, task.depth, which & ~both, task.width, rest)
    base, scratch = rest.copy(), rest.copy()
    over = (base, scratch, ends, *_rows(len(rest)))
    kept, matches = _uppers(task, pose, was, upper, over, low_deg, high_deg)
    best, found = NOTHING, was.copy()
    tries = (int(2.0 * bend_deg / LOWER_STEP_DEG) + 1) * SHORTENINGS.size
    for k in range(BEAM):
        _limb_of(pose, upper, was, int(kept[k, 1]), low_deg, UPPER_STEP_DEG)
        upper_cost = limb_cost(pose, task.expected, upper, task.trust, task.costs)
        place_chain(upper, task.lengths, pose, ends)
        base[:] = rest
        draw_segments(ends, pose, task.parts, task.depth, 1 << upper, task.width, base)
        scratch[:] = base
        drawn, hit = count(base), count_both(base, task.seen)
        for n in range(-1, tries):
            _limb_of(pose, lower, was, n, pose[ANGLE + upper] - bend_deg, LOWER_STEP_DEG)
            place_chain(upper, task.lengths, pose, ends)
            s = _similar(task, pose, 1 << lower, over, drawn, hit) - upper_cost
            s -= limb_cost(pose, task.expected, lower, task.trust, task.costs)
            s -= bend_cost(pose, upper, task.costs)
            if upper < 6:
                s -= cross_cost(ends, pose, task.costs)
            if s > best:
                best = s
                found[:] = pose
    pose[:] = found
    return matches + BEAM * (tries + 1)


@compiled
def covered(task: Task, pose: Vector, shares: Vector) -> None:
    """Share of each limb that overlaps the rest of the body: (10,), written."""
    ends, own, rest = np.empty((12, 4)), np.zeros_like(task.seen), np.zeros_like(task.seen)
    place_segments(task.lengths, pose, ends)
    for limb in range(10):
        own[:], rest[:] = np.uint64(0), np.uint64(0)
        draw_segments(ends, pose, task.parts, task.depth, 1 << limb, task.width, own)
        draw_segments(ends, pose, task.parts, task.depth, 0xFFF & ~(1 << limb), task.width, rest)
        shares[limb] = count_both(own, rest) / max(1, count(own))
