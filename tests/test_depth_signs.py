"""Signs of depth and the way that a body faces, held against how bodies bend (T21, T22)."""

import numpy as np
import pytest
from stick_posing import STATURE_PX, stick_pose

from common.body.body import LIMB_ENDS, LIMBS
from common.body.stick_body import ADULT, BREADTH, joints_px
from common.notes.notes import Orientation
from integrator.single import depth_signs
from integrator.single.depth_signs import (
    CHAINS,
    FORWARDS,
    LEANING,
    MOMENTUM,
    MOTION,
    SOFTNESS,
    WAYS,
)
from integrator.single.lifting import StickPicture, lift, yaw_of
from integrator.single.orientation import faced

LENGTHS_M = ADULT.lengths * 1.75
PX_PER_M = STATURE_PX / 1.75
AT = {name: i for i, name in enumerate(LIMBS)}
SQUAT = stick_pose({}, {n: 0.5 for n in LIMBS if n.endswith("leg")})


def chosen(
    pose: np.ndarray,
    memory: depth_signs.Memory | None = None,
    depth: dict[str, str] | None = None,
    orientation: Orientation | None = None,
) -> depth_signs.Choice:
    seen, breadth = joints_px(ADULT, pose), float(pose[BREADTH])
    memory = depth_signs.init() if memory is None else memory
    picture = StickPicture(seen, breadth, LENGTHS_M, PX_PER_M)
    return depth_signs.choose(memory, picture, depth, orientation)


def after(memory: depth_signs.Memory, pose: np.ndarray, way: float) -> depth_signs.Memory:
    """What is remembered of a body all of whose segments lean one way, as the user said."""
    seen = joints_px(ADULT, pose)
    body = lift(StickPicture(seen, 1.0, LENGTHS_M, PX_PER_M), np.full(10, way), "forward_right")
    bearing = faced(memory.bearing, seen, 1.0)
    choice = depth_signs.Choice(np.full(10, way), np.ones(10), "forward_right", 1.0, bearing)
    return depth_signs.remembered(memory, body.joints_m, choice)


def test_thighs_bend_forwards_and_knees_backwards() -> None:
    """T22: a squat seen from the front."""
    found = chosen(SQUAT)
    for side in "lr":
        assert found.signs[AT[f"{side}_upper_leg"]] == 1.0
        assert found.signs[AT[f"{side}_lower_leg"]] == -1.0
        assert found.confidence[AT[f"{side}_upper_leg"]] > 0.9


def test_seen_from_behind_they_bend_the_other_way() -> None:
    found = chosen(SQUAT, orientation="backward_left")
    assert found.signs[AT["l_upper_leg"]] == -1.0
    assert found.signs[AT["l_lower_leg"]] == 1.0
    assert found.orientation_confidence == 1.0


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_limb_goes_on_where_it_was(way: float) -> None:
    """T21: signs rarely change: an arm that points out of the plane keeps its side."""
    arm = {"l_upper_arm": 0.7, "l_lower_arm": 0.7}
    pose = stick_pose({"l_upper_arm": 300.0, "l_lower_arm": 300.0}, arm)
    memory = after(depth_signs.init(), pose, way)
    assert chosen(pose, memory).signs[AT["l_upper_arm"]] == way


def test_a_limb_that_swung_through_the_plane_goes_on_through() -> None:
    """T21: motion goes on; the arm's tilt was 40, then 10 degrees towards the camera."""
    memory = depth_signs.init()
    for tilt_deg in (40.0, 10.0):
        ratio = float(np.cos(np.radians(tilt_deg)))
        arm = {"l_upper_arm": ratio, "l_lower_arm": ratio}
        memory = after(memory, stick_pose({}, arm), 1.0)
    ratio = float(np.cos(np.radians(20.0)))
    beyond = stick_pose({}, {"l_upper_arm": ratio, "l_lower_arm": ratio})
    assert chosen(beyond, memory).signs[AT["l_upper_arm"]] == -1.0


def test_the_user_is_right() -> None:
    """T21, T26: what is said holds, and is sure; the rest follows it."""
    found = chosen(SQUAT, depth={"l_upper_leg": "away", "head": "away"})
    assert found.signs[AT["l_upper_leg"]] == found.signs[AT["head"]] == -1.0
    assert found.confidence[AT["l_upper_leg"]] == 1.0
    assert found.signs[AT["r_upper_leg"]] == 1.0


def test_confidences_are_shares() -> None:
    rng = np.random.default_rng(5)
    for _ in range(30):
        pose = stick_pose({})
        pose[4:14] += rng.uniform(-90, 90, 10)
        pose[14:24] = rng.uniform(0.1, 1.0, 10)
        found = chosen(pose)
        assert np.all((found.confidence >= 0.25) & (found.confidence <= 1.0))
        assert 0.0 <= found.orientation_confidence <= 1.0
        assert set(found.signs) <= {-1.0, 1.0}


def test_what_does_not_lean_is_not_sure() -> None:
    """A limb in the plane has no sign: its confidence says so."""
    assert chosen(stick_pose({})).confidence.max() < 0.75


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("known", [False, True])
def test_a_chain_costs_what_its_segments_lean_move_and_bend(seed: int, known: bool) -> None:
    """Each way of each chain by itself, segment by segment."""
    rng = np.random.default_rng(seed)
    flat_m, deep_m = rng.normal(0.0, 0.3, (10, 2)), rng.uniform(0.0, 0.5, 10)
    yaw = rng.uniform(-3.0, 3.0)
    forward = np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    before, turning = rng.normal(size=(2, 10, 3))
    memory = depth_signs.init()
    if known:
        memory = memory._replace(directions=before, turning=turning)

    def cost(chain: int, signs: np.ndarray) -> float:
        total, ways = 0.0, []
        for limb, sign in zip(CHAINS[chain], signs, strict=True):
            way = np.array([*flat_m[limb], sign * deep_m[limb]])
            ways.append(way / np.linalg.norm(way))
            total -= LEANING * sign * FORWARDS[limb] * forward[2]
            if known:
                expected = before[limb] + MOMENTUM * turning[limb]
                total += MOTION * float(np.square(ways[-1] - expected).sum())
        upper, lower = ways
        back = max(0.0, -float(upper @ forward))
        bend = float(lower @ forward - (lower @ upper) * (upper @ forward))
        total += 0.2 * back
        if chain == 0:
            return total + 0.8 * back
        if chain < 3:
            return total + max(0.0, back - 0.6) + max(0.0, -bend - 0.1)
        return total + 2.0 * max(0.0, back - 0.3) + 2.0 * max(0.0, bend - 0.1)

    found = depth_signs._costs(memory, flat_m, deep_m, forward)
    expected = [[cost(chain, signs) for chain in range(5)] for signs in WAYS]
    assert found == pytest.approx(np.array(expected), abs=1e-12)


def test_the_confidence_in_a_sign_is_its_share_of_the_odds() -> None:
    """Softmax of the costs over the ways of a chain that give the segment this sign."""
    pose = stick_pose({}, dict.fromkeys(LIMBS, 0.7))
    found = chosen(pose, orientation="forward_right")
    seen = StickPicture(joints_px(ADULT, pose), float(pose[BREADTH]), LENGTHS_M, PX_PER_M)
    pixels = seen.of_own_sides("forward_right")
    flat_m = (pixels[LIMB_ENDS[:, 1]] - pixels[LIMB_ENDS[:, 0]]) / PX_PER_M * [1.0, -1.0]
    deep_m = np.sqrt(np.maximum(0.0, LENGTHS_M[:10] ** 2 - np.square(flat_m).sum(axis=1)))
    yaw = np.radians(yaw_of("forward_right", float(pose[BREADTH])))
    forward = np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    costs = depth_signs._costs(depth_signs.init(), flat_m, deep_m, forward)
    for chain in range(5):
        odds = np.exp(-costs[:, chain] / SOFTNESS)
        for i, limb in enumerate(CHAINS[chain]):
            sign = WAYS[costs[:, chain].argmin(), i]
            assert found.signs[limb] == sign
            share = odds[WAYS[:, i] == sign].sum() / odds.sum()
            assert found.confidence[limb] == pytest.approx(share)
