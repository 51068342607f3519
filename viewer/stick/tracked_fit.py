"""The stick body fitted by search: from the frame before, with limbs searched anew and all
refined."""

from collections.abc import Iterable
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import LIMBS, Vector
from common.body.stick_body import (
    ADULT,
    ANGLE,
    BREADTH,
    CHAINS,
    GIRTH,
    HEAD,
    POSE_SIZE,
    RATIO,
    STATURE,
    TORSO,
    X,
    Y,
    standing,
)
from common.raster.bits import count, pack_words
from common.raster.similarity import Mask
from common.raster.stick_raster import ALL_SEGMENTS, WITHOUT_ARMS
from viewer.stick.normalization import STATURE_PX
from viewer.stick.stick_costs import COSTS
from viewer.stick.stick_search import Moves, Task, beamed, covered, refined

STARTS: Final = (1.0, 0.3)
"""Breadths of the trunk that are tried for an unknown person."""
FIRST_TRUST: Final = 0.3
"""Weight of a standing body's prediction for an unknown person."""
REFIT_SCORE: Final = 0.6
"""Worth below which the body is also searched anew."""
HIDDEN_SHARE: Final = 0.6
"""Share of a limb, over or behind the rest of the body, above which it is hidden."""
PELVIS_SHARE: Final = float(ADULT.lengths[HEAD] + ADULT.lengths[TORSO])
"""Depth of the pelvis below the crown, which is the top unless hands are above it, and its
height above the soles, unless the legs are bent or lifted; statures."""

UPRIGHT_MOVES: Final = 9
"""Number of the moves of trunk and head, which come first."""
COARSE, MIDDLE, FINE = (16, 4), (8, 2), (4, 2)
"""Half a window and its width at the end, in units of each move."""

LEAN_DEG: Final = (-30.0, 210.0)
"""Range of the directions of trunk and head, degrees. T6 allows 45 to 135, which excludes a
person who fell; the head of a lying person may be lower in the picture than the feet, as cameras
look down."""
ARM_RANGE_DEG, LEG_RANGE_DEG = (0.0, 345.0, 140.0), (180.0, 360.0, 100.0)
"""Ranges of the upper limbs' directions in the picture, and of the lower limbs' bends."""


class TrackedFit(NamedTuple):
    """Result of the search."""

    pose: Vector
    hidden: NDArray[np.bool_]
    """(10,) of LIMBS."""
    evaluations: int


def _moves() -> Moves:
    """Trunk and head first: a body is placed before its limbs are."""
    moves: list[tuple[float, dict[int, float]]] = [(0.25, {X: 1.0}), (0.25, {Y: 1.0})]
    sunk = {RATIO + limb: -1.0 / (ADULT.lengths[limb] * STATURE_PX) for limb in (2, 3)}
    longer = {RATIO + TORSO: 1.0 / (ADULT.lengths[TORSO] * STATURE_PX)}
    moves.append((0.25, {Y: 1.0, **longer, **sunk}))  # neck and knees stay in place
    moves += [(1.0, {ANGLE + TORSO: 1.0}), (0.02, {RATIO + TORSO: 1.0}), (0.02, {BREADTH: 1.0})]
    moves.append((0.02, {RATIO + TORSO: 1.0, RATIO + HEAD: 1.0}))  # a bow
    moves += [(0.2, {STATURE: 1.0}), (1.0, {ANGLE + HEAD: 1.0})]
    for upper, lower in (*CHAINS[2:], *CHAINS[:2]):
        moves.append((1.0, {ANGLE + upper: 1.0, ANGLE + lower: 1.0}))
        moves += [(1.0, {ANGLE + limb: 1.0}) for limb in (upper, lower)]
        moves += [(0.03, {RATIO + limb: 1.0}) for limb in (upper, lower)]
    moves.append((0.02, {GIRTH: 1.0}))
    rows = np.zeros((len(moves), POSE_SIZE))
    for row, (_, factors) in zip(rows, moves, strict=True):
        row[list(factors)] = list(factors.values())
    moving = np.array([_moving(factors) for _, factors in moves])
    return Moves(rows, np.array([unit for unit, _ in moves]), moving, *_bounds())


def _moving(factors: Iterable[int]) -> int:
    """The segments, as bits, that some numbers of a pose move."""
    found = 0
    hanging = {HEAD: 1 << HEAD}
    for upper, lower in CHAINS:
        hanging |= {upper: 1 << upper | 1 << lower, lower: 1 << lower}
    for at in factors:
        limb = at - (ANGLE if at < RATIO else RATIO)
        found |= hanging.get(limb, ALL_SEGMENTS) if ANGLE <= at < GIRTH else ALL_SEGMENTS
    return found


def _bounds() -> tuple[Vector, Vector]:
    lows, highs = np.full(POSE_SIZE, -1e9), np.full(POSE_SIZE, 1e9)
    lows[RATIO:GIRTH], highs[RATIO:GIRTH] = 0.05, 1.0
    lows[RATIO + TORSO], lows[RATIO + HEAD] = 0.5, 0.5
    lows[GIRTH], highs[GIRTH] = 0.7, 1.5
    lows[BREADTH], highs[BREADTH] = 0.0, 1.0
    for segment in (TORSO, HEAD):
        lows[ANGLE + segment], highs[ANGLE + segment] = LEAN_DEG
    return lows, highs


_MOVES: Final = _moves()


def fit_tracked(mask: Mask, before: Vector | None) -> TrackedFit:
    """The pose of greatest worth: S minus its cost.

    Args:
        mask: (H, W), normalised.
        before: The pose of the frame before, in this picture; None at the start.
    """
    seen = pack_words(mask)
    tasks = [] if before is None else [_task(seen, mask, before, 1.0)]
    found = [_searched(task) for task in tasks]
    if not found or found[0][1] < REFIT_SCORE:
        afresh = [_task(seen, mask, start, FIRST_TRUST) for start in _starts(mask)]
        tasks += afresh
        found += [_searched(task) for task in afresh]
    best = max(range(len(found)), key=lambda i: found[i][1])
    pose, shares = found[best][0], np.empty(len(LIMBS))
    covered(tasks[best], pose, shares)
    return TrackedFit(pose, shares > HIDDEN_SHARE, sum(matches for _, _, matches in found))


def _starts(mask: Mask) -> list[Vector]:
    """Standing bodies whose crown, or whose soles, are at the silhouette's ends; lying ones too
    where it is broader than tall."""
    rows = np.flatnonzero(mask.any(axis=1))
    middle = float(np.median(np.nonzero(mask)[1])) + 0.5
    from_crown = rows[0] + PELVIS_SHARE * STATURE_PX
    from_soles = rows[-1] + 1 - (1.0 - PELVIS_SHARE) * STATURE_PX
    starts = []
    for row in (from_crown, from_soles):
        for breadth in STARTS:
            pose = standing(middle, row, STATURE_PX)
            pose[BREADTH] = breadth
            starts.append(pose)
    return starts + _lying(mask)


def _lying(mask: Mask) -> list[Vector]:
    """Bodies along a silhouette that is broader than tall, with the crown at either end."""
    rows, columns = np.nonzero(mask)
    if np.ptp(columns) <= np.ptp(rows):
        return []
    middle = np.array([columns.mean(), rows.mean()]) + 0.5
    spread = np.cov(columns, rows)
    along = np.linalg.eigh(spread)[1][:, -1]
    reach = (np.stack([columns, rows], axis=1) + 0.5 - middle) @ along
    starts = []
    for up, crown in ((along, reach.max()), (-along, -reach.min())):
        x, y = middle + up * (crown - PELVIS_SHARE * STATURE_PX)
        pose = standing(float(x), float(y), STATURE_PX)
        pose[ANGLE:RATIO] += _lean_deg(np.degrees(np.arctan2(-up[1], up[0]))) - pose[ANGLE + TORSO]
        pose[BREADTH] = STARTS[-1]
        starts.append(pose)
    return starts


def _lean_deg(angle_deg: float) -> float:
    """The same direction in [-90, 270), which contains LEAN_DEG."""
    return float((angle_deg + 90.0) % 360.0 - 90.0)


def _task(seen: NDArray[np.uint64], mask: Mask, expected: Vector, trust: float) -> Task:
    expected = expected.copy()
    for segment in (TORSO, HEAD):
        expected[ANGLE + segment] = _lean_deg(expected[ANGLE + segment])
    expected[STATURE] = STATURE_PX
    man = ADULT
    return Task(
        man.lengths, man.parts, man.depth, seen, count(seen), mask.shape[1], expected, trust, COSTS
    )


def _searched(task: Task) -> tuple[Vector, float, int]:
    """(pose, its worth, matches): trunk and head, both legs, both arms, then all numbers."""
    pose = task.expected.copy()
    matches = 0
    for half, stop in (COARSE, FINE):
        matches += refined(task, pose, _MOVES, UPRIGHT_MOVES, half, stop, WITHOUT_ARMS)[1]
    for upper, _ in CHAINS[2:]:
        matches += beamed(task, pose, upper, *LEG_RANGE_DEG, WITHOUT_ARMS)
    for upper, _ in CHAINS[:2]:
        matches += beamed(task, pose, upper, *ARM_RANGE_DEG, ALL_SEGMENTS)
    worth = 0.0
    for half, stop in (COARSE, MIDDLE, FINE):
        worth, more = refined(task, pose, _MOVES, len(_MOVES.rows), half, stop, ALL_SEGMENTS)
        matches += more
    return pose, float(worth), matches
