"""The search of a stick pose, held against the same search over whole drawn pictures."""

from collections.abc import Callable

import numpy as np
import pytest
from stick_posing import stick_pose

from common.body.body import LIMBS, Vector
from common.body.stick_body import (
    ADULT,
    ANGLE,
    BREADTH,
    GIRTH,
    RATIO,
    STATURE,
    segments_px,
    standing,
)
from common.raster.bits import count, pack_words
from common.raster.similarity import Mask, similarity
from common.raster.stick_raster import ALL_SEGMENTS, WITHOUT_ARMS, draw_stick
from viewer.paper.tritree import tritree
from viewer.stick.stick_costs import COSTS, bend_cost, cross_cost, limb_cost, pose_cost
from viewer.stick.stick_search import Moves, Task, beamed, covered, refined, worth
from viewer.stick.tracked_fit import ARM_RANGE_DEG, LEG_RANGE_DEG, UPRIGHT_MOVES, _moves

SIZE = (150, 120)
TRUST = 0.4
R_THIGH, L_THIGH, R_ARM, L_ARM = 2, 3, 6, 7


def body(**changed: float) -> Vector:
    """A stick body of 90 px left of the middle of a picture, some limbs turned."""
    pose = stick_pose(changed)
    pose[:3] = 66.0, 58.0, 90.0
    return pose


def seen_body() -> Vector:
    pose = body(r_upper_arm=215.0, r_lower_arm=165.0, l_upper_arm=318.0, l_upper_leg=295.0)
    pose[[BREADTH, RATIO + R_ARM, GIRTH]] = 0.8, 0.8, 1.1
    return pose


def task_of(mask: Mask, expected: Vector) -> Task:
    seen = pack_words(mask)
    return Task(
        ADULT.lengths, ADULT.parts, ADULT.depth, seen, count(seen), mask.shape[1], expected, TRUST,
        COSTS,
    )  # fmt: skip


def seen_mask() -> Mask:
    return draw_stick(ADULT, seen_body(), SIZE)


def s_of(mask: Mask, pose: Vector, which: int) -> float:
    return similarity(mask, draw_stick(ADULT, pose, SIZE, which))


def plain_worth(mask: Mask, pose: Vector, task: Task, which: int) -> float:
    """S of a whole drawn picture less what the pose costs."""
    ends = segments_px(ADULT, pose).reshape(12, 4)
    return s_of(mask, pose, which) - float(
        pose_cost(pose, ends, task.expected, task.trust, task.costs)
    )


@pytest.mark.parametrize("which", [ALL_SEGMENTS, WITHOUT_ARMS])
def test_a_pose_is_worth_its_similarity_less_its_cost(which: int) -> None:
    mask, pose = seen_mask(), body(r_upper_arm=240.0, head=80.0)
    task = task_of(mask, body())
    blank = np.zeros_like(task.seen)
    found = worth(task, pose, which, np.empty((12, 4)), blank)
    assert found == pytest.approx(plain_worth(mask, pose, task, which))
    assert found < s_of(mask, pose, which) - 0.001


def moved(start: Vector, moves: Moves, k: int, steps: float) -> Vector:
    there = start + steps * moves.units[k] * moves.rows[k]
    return np.asarray(np.clip(there, moves.lows, moves.highs))


def plain_refined(
    score_of: Callable[[Vector], float], pose: Vector, moves: Moves, half: int, stop: int
) -> tuple[Vector, float, int]:
    """Every move searched by the tritree itself; the middle of each is known already."""
    best, matches = score_of(pose), 1
    for k in range(len(moves.rows)):
        start = pose

        def score_at(steps: float, start: Vector = start, k: int = k) -> float:
            return score_of(moved(start, moves, k, steps))

        found = tritree(score_at, (-half, half), stop)
        matches += found.matches - 1
        if found.score > best:
            best, pose = found.score, moved(start, moves, k, found.angle_deg)
    return pose, best, matches


@pytest.mark.parametrize(
    ("how_many", "half", "stop", "which"),
    [(UPRIGHT_MOVES, 16, 4, WITHOUT_ARMS), (30, 8, 2, ALL_SEGMENTS)],
    ids=["trunk and head", "everything"],
)
def test_refining_is_the_tritree_along_each_move_over_whole_pictures(
    how_many: int, half: int, stop: int, which: int
) -> None:
    """What stands still is drawn once: the pose, its worth and the matches stay the same."""
    mask, moves = seen_mask(), _moves()
    moves = Moves(moves.rows[:how_many], moves.units, *moves[2:])
    pose = body(r_upper_arm=225.0, r_lower_arm=180.0, l_upper_arm=310.0, l_upper_leg=285.0)
    task = task_of(mask, pose.copy())
    plain = plain_refined(lambda p: plain_worth(mask, p, task, which), pose, moves, half, stop)
    begun = plain_worth(mask, pose, task, which)
    best, matches = refined(task, pose, _moves(), len(moves.rows), half, stop, which)
    assert pose == pytest.approx(plain[0])
    assert best == pytest.approx(plain[1])
    assert matches == plain[2]
    assert best > begun + 0.02


def plain_beamed(
    mask: Mask, pose: Vector, task: Task, upper: int, ranges: tuple[float, float, float], which: int
) -> Vector:
    """The best six upper limbs, each with every lower limb, over whole pictures."""
    low, high, bend = ranges
    lower = upper + 2
    ratios = (1.0, 0.8, 0.5, 0.2)

    def with_limb(at: Vector, limb: int, angles: np.ndarray) -> list[Vector]:
        poses = [at]
        for angle in angles:
            for ratio in ratios:
                tried = at.copy()
                tried[[ANGLE + limb, RATIO + limb]] = angle, ratio
                poses.append(tried)
        return poses

    def costs(tried: Vector, limb: int) -> float:
        return float(limb_cost(tried, task.expected, limb, task.trust, task.costs))

    alone = which & ~(1 << lower)
    uppers = with_limb(pose, upper, np.arange(low, high + 0.1, 15.0))
    uppers.sort(key=lambda p: costs(p, upper) - s_of(mask, p, alone))
    best, found = -9.0, pose
    for one in uppers[:6]:
        first = one[ANGLE + upper] - bend
        for tried in with_limb(one, lower, np.arange(first, first + 2 * bend + 0.1, 20.0)):
            value = s_of(mask, tried, which) - costs(tried, upper) - costs(tried, lower)
            value -= bend_cost(tried, upper, task.costs)
            if upper < 6:
                value -= cross_cost(segments_px(ADULT, tried).reshape(12, 4), tried, task.costs)
            if value > best:
                best, found = value, tried
    return found


@pytest.mark.parametrize(
    ("upper", "ranges", "which", "matches"),
    [
        (R_ARM, ARM_RANGE_DEG, ALL_SEGMENTS, 97 + 6 * 61),
        (L_ARM, ARM_RANGE_DEG, ALL_SEGMENTS, 97 + 6 * 61),
        (R_THIGH, LEG_RANGE_DEG, WITHOUT_ARMS, 53 + 6 * 45),
        (L_THIGH, LEG_RANGE_DEG, WITHOUT_ARMS, 53 + 6 * 45),
    ],
    ids=["right arm", "left arm", "right leg", "left leg"],
)
def test_a_beam_finds_the_best_of_six_upper_limbs_with_every_lower_one(
    upper: int, ranges: tuple[float, float, float], which: int, matches: int
) -> None:
    mask, pose = seen_mask(), body(head=84.0)
    task = task_of(mask, body(r_lower_arm=200.0, l_lower_leg=260.0))
    wanted = plain_beamed(mask, pose, task, upper, ranges, which)
    assert beamed(task, pose, upper, *ranges, which) == matches
    assert pose == pytest.approx(wanted)


@pytest.mark.parametrize("upper", [R_ARM, L_THIGH])
def test_a_limb_between_the_steps_of_a_beam_stays_where_it_fits(upper: int) -> None:
    pose = seen_body()
    pose[[ANGLE + upper, ANGLE + upper + 2]] = 222.0, 231.0
    task = task_of(draw_stick(ADULT, pose, SIZE), pose.copy())
    ranges = ARM_RANGE_DEG if upper >= 6 else LEG_RANGE_DEG
    wanted = pose.copy()
    beamed(task, pose, upper, *ranges, ALL_SEGMENTS)
    assert pose.tolist() == wanted.tolist()


def test_legs_that_cross_cost_a_beam_more_than_their_picture_gains() -> None:
    """A right leg seen on the left leg's side is found there only where crossing costs nothing."""
    pose = body(r_upper_leg=300.0, r_lower_leg=300.0, l_upper_leg=240.0, l_lower_leg=240.0)
    mask = draw_stick(ADULT, pose, SIZE)
    found = []
    for price in (1.0, 0.0):
        start = body(l_upper_leg=240.0, l_lower_leg=240.0)
        task = task_of(mask, start.copy())
        costs = task.costs.copy()
        costs[8] = price
        beamed(task._replace(costs=costs), start, R_THIGH, *LEG_RANGE_DEG, WITHOUT_ARMS)
        found.append(start[ANGLE + R_THIGH])
    assert found[0] <= 270.0 < found[1]


def test_a_limb_is_covered_where_the_rest_of_the_body_is_drawn_too() -> None:
    pose = standing(66.0, 58.0, 90.0)
    pose[[ANGLE + 7, ANGLE + 9]] = 20.0, 200.0
    pose[[ANGLE + 6, ANGLE + 8]] = 170.0, 190.0
    shares = np.empty(10)
    covered(task_of(seen_mask(), pose), pose, shares)
    for limb in range(len(LIMBS)):
        own = draw_stick(ADULT, pose, SIZE, 1 << limb)
        rest = draw_stick(ADULT, pose, SIZE, ALL_SEGMENTS & ~(1 << limb))
        assert shares[limb] == pytest.approx((own & rest).sum() / own.sum()), LIMBS[limb]
    assert shares[8] < 0.3
    assert shares[9] > 0.6


def test_what_lies_outside_the_picture_is_not_covered() -> None:
    pose = standing(66.0, 58.0, 90.0)
    pose[1], pose[STATURE] = 400.0, 90.0
    shares = np.full(10, np.nan)
    covered(task_of(seen_mask(), pose), pose, shares)
    assert shares.tolist() == [0.0] * 10
