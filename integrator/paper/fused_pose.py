"""The pose from the viewers' angles: fused, with ambiguities resolved by both silhouettes."""

from common.body.body import POSE_INDEX, YAW_DEG, Vector, rest_pose
from common.body.observation import Facing
from common.body.proportions import LOWER_LEG_HEIGHT, UPPER_LEG_HEIGHT, body_vector
from common.method import Method
from integrator.fit.silhouette_pair import silhouettes_of
from integrator.measuring.known_body import Known, Measured
from integrator.merge_state import State
from integrator.paper.arbiter import Sight, arbitrate
from integrator.paper.fusion import fused
from integrator.paper.silhouette_vote import settled, votes_of
from integrator.person import Following, Posed
from integrator.rig.best_pair import Two
from integrator.rig.body_position import place_of, roots_of, scales_at


def step(state: State, body: Known, two: Two, settled_at: Vector | None) -> Posed:
    """The facing and the pose of one more instant.

    The arbiter settles the facing (P48), position and angles are fused (P50-P54); beyond the paper,
    both silhouettes vote on the remaining ambiguities.

    Args:
        state: The integrator's state of the instant before.
        body: The person's body.
        two: The person in each view, and the cameras.
        settled_at: Place at which the body was measured, if just now.
    """
    before = rest_pose() if state.person.pose is None else state.person.pose
    facing = _faced(state, body, two)
    pose = _posed(state.method, facing, before, two, settled_at)
    return Posed(_settled(state.method, body, before, two, pose), facing)


def _faced(state: State, body: Known, two: Two) -> tuple[Facing, Facing]:
    """Facade and flank, settled between the views' votes (P48); a single view decides alone.

    Beyond the paper: once the body is measured, a single view keeps the last facing, because raised
    arms narrow the upper body as a turn would, and no other view can correct that.
    """
    first, second = two.seen
    if first is None or second is None:
        if state.method.held_facing and isinstance(body, Measured):
            facing_1, facing_2 = state.facing
            return facing_1, facing_2
        place, own = two.first_seen
        other: Facing = "flank" if own.vote == "facade" else "facade"
        return (other, own.vote) if place else (own.vote, other)
    sights = [
        Sight(before, person.vote, person.upper_body_px, *person.thresholds_px)
        for before, person in zip(state.facing, (first, second), strict=True)
    ]
    ratio = 1.0
    if state.method.scaled_arbiter and isinstance(state.person, Following):
        scales = scales_at(two.rig, state.person.pose[:3])
        ratio = scales[0] / scales[1]
    return arbitrate(sights[0], sights[1], ratio)


def _posed(
    method: Method,
    facing: tuple[Facing, Facing],
    before: Vector,
    two: Two,
    settled_at: Vector | None,
) -> Vector:
    """Position and angles of this instant, not yet smoothed (P50-P54)."""
    front = 0 if facing[0] == "facade" else 1
    pose = fused(before, two.seen[front], two.seen[1 - front], method)
    if settled_at is None:
        pose[:3] = place_of(two.rig, roots_of(two.seen), before[:3], front)
    else:
        pose[:3] = settled_at
    pose[POSE_INDEX["torso_y"]] = YAW_DEG[front]
    return pose


def _settled(method: Method, known: Known, before: Vector, two: Two, pose: Vector) -> Vector:
    """Ambiguities of single views, resolved by both silhouettes: a departure from the paper (L2,
    L3)."""
    first, second = two.seen
    if first is None or second is None:
        return pose
    body = body_vector(known.bdp)
    leg_m = float(body[UPPER_LEG_HEIGHT] + body[LOWER_LEG_HEIGHT])
    upright_m, fitted = leg_m, bool(known.samples)
    if isinstance(known, Measured):
        upright_m, fitted = known.measured_at_m[1], False
    votes = votes_of(method, upright_m, leg_m, fitted)
    if not votes:
        return pose
    upright = pose.copy()
    upright[POSE_INDEX["torso_x"]] = 0.0
    return settled(upright, before, body, silhouettes_of(two.rig, (first, second)), votes)
