"""The pose from the viewers' angles: fused, with ambiguities resolved by both silhouettes."""

from common.body.body import POSE_INDEX, YAW_DEG, Vector, rest_pose
from common.body.observation import Facing
from common.body.proportions import LOWER_LEG_HEIGHT, UPPER_LEG_HEIGHT, body_vector
from common.bus.instant import TwoSeen
from common.rig.camera import Rig
from integrator.fit.silhouette_pair import silhouettes_of
from integrator.merge_state import Posed, State
from integrator.paper.arbiter import Sight, arbitrate
from integrator.paper.fusion import fused
from integrator.paper.silhouette_vote import settled, votes_of
from integrator.rig.body_position import place_of, roots_of, scales_at


def step(state: State, rig: Rig, seen: TwoSeen, settled_at: Vector | None) -> Posed:
    """The facing and the pose of one more instant.

    The arbiter settles the facing (P48), position and angles are fused (P50-P54); beyond the paper,
    both silhouettes vote on the remaining ambiguities.

    Args:
        state: The integrator's state.
        rig: Two cameras.
        seen: The person in each view; None where it shows none.
        settled_at: Place at which the body was measured, if just now.
    """
    facing = _faced(state, seen)
    pose = _posed(state, facing, rig, seen, settled_at)
    return Posed(_settled(state, rig, seen, pose), facing)


def _faced(state: State, seen: TwoSeen) -> tuple[Facing, Facing]:
    """Facade and flank, settled between the views' votes (P48); a single view decides alone.

    Beyond the paper: once the body is measured, a single view keeps the last facing, because raised
    arms narrow the upper body as a turn would, and no other view can correct that.
    """
    first, second = seen
    if first is None or second is None:
        own = first or second
        assert own is not None
        if state.method.held_facing and state.opening.measured:
            facing_1, facing_2 = state.facing
            return facing_1, facing_2
        other: Facing = "flank" if own.vote == "facade" else "facade"
        return (own.vote, other) if second is None else (other, own.vote)
    sights = [
        Sight(before, person.vote, person.upper_body_px, *person.thresholds_px)
        for before, person in zip(state.facing, (first, second), strict=True)
    ]
    ratio = 1.0
    if state.method.scaled_arbiter and state.pose is not None and state.rig is not None:
        scales = scales_at(state.rig, state.pose[:3])
        ratio = scales[0] / scales[1]
    return arbitrate(sights[0], sights[1], ratio)


def _posed(
    state: State,
    facing: tuple[Facing, Facing],
    rig: Rig,
    seen: TwoSeen,
    settled_at: Vector | None,
) -> Vector:
    """Position and angles of this instant, not yet smoothed (P50-P54)."""
    front = 0 if facing[0] == "facade" else 1
    before = rest_pose() if state.pose is None else state.pose
    pose = fused(before, seen[front], seen[1 - front], state.method)
    if settled_at is None:
        pose[:3] = place_of(rig, roots_of(seen), before[:3], front)
    else:
        pose[:3] = settled_at
    pose[POSE_INDEX["torso_y"]] = YAW_DEG[front]
    return pose


def _settled(state: State, rig: Rig, seen: TwoSeen, pose: Vector) -> Vector:
    """Ambiguities of single views, resolved by both silhouettes: a departure from the paper (L2,
    L3)."""
    first, second = seen
    if first is None or second is None:
        return pose
    assert state.opening.bdp is not None
    before = rest_pose() if state.pose is None else state.pose
    known, body = state.opening, body_vector(state.opening.bdp)
    leg_m = float(body[UPPER_LEG_HEIGHT] + body[LOWER_LEG_HEIGHT])
    upright_m = known.measured_at_m[1] if known.measured else leg_m
    fitted = bool(known.samples) and not known.measured
    votes = votes_of(state.method, upright_m, leg_m, fitted)
    if not votes:
        return pose
    upright = pose.copy()
    upright[POSE_INDEX["torso_x"]] = 0.0
    return settled(upright, before, body, silhouettes_of(rig, (first, second)), votes)
