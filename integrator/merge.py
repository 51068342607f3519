"""Two reports in, one body out: position, body, facing, pose, in the order of section 4."""

from typing import Literal

from common.bits import count
from common.body import ANGLE_NAMES, ANGLES_IN_POSE, POSE_INDEX, YAW_DEG, Vector, rest_pose
from common.camera import Rig
from common.config import Settings
from common.kernel import match, view_of
from common.kinematics import ALL_LIMBS
from common.messages import Body, Facing, Guide, Report
from common.proportions import body_vector
from integrator import adapting, insight, opening, smoothing, telling
from integrator.arbiter import Sight, arbitrate
from integrator.assumed import assumed_rig
from integrator.belief import LOST_SCORE
from integrator.fusion import fused
from integrator.hypotheses import settled
from integrator.memory import State
from integrator.pairing import Pair, Seen
from integrator.place import place_of, roots_of, scales_at
from integrator.two_outlines import packed


def init(rig: Rig | None, period_s: float, settings: Settings) -> State:
    """An integrator that has heard nothing.

    Args:
        rig: The calibrated cameras of viewer 1 and viewer 2, for the working size; None: a rig
            of the paper's kind is assumed when somebody is seen.
        period_s: Time between frames.
        settings: Of the run.
    """
    source: Literal["calibrated", "assumed"] = "assumed" if rig is None else "calibrated"
    return State(settings, rig, source, smoothing.init(len(ANGLE_NAMES), period_s))


def step(state: State, pair: Pair) -> tuple[State, Body, Guide]:
    """One instant: what each viewer reports of it becomes one body, and a guide for the next.

    Universal BDPs come from the opening posture (P46), the arbiter settles the facing (P48),
    position and angles are fused (P50-P54) and smoothed; the viewers are told BDPs, positions
    and facing for their next frame (P2).
    """
    now_s, before_s = pair.newest.captured_s, state.last_s
    dt_s = 0.0 if before_s is None else max(0.0, now_s - before_s)
    state = state._replace(frames=_heard(state.frames, pair), last_s=now_s)
    seen = pair.with_somebody
    state = _with_rig(state, seen)
    rig = state.rig
    if seen == (None, None) or rig is None:
        state = _without_pose(state)
        return (state, *telling.nobody(state, pair))
    opened, settled_at = opening.step(state.opening, rig, seen, state.settings.body.opening_frames)
    state = _faced(state._replace(opening=opened), seen)
    pose = _posed(state, rig, seen, settled_at)
    state, pose = _believed(state, rig, seen, pose, dt_s)
    if state.settings.mode == "default":
        state = state._replace(opening=adapting.step(state.opening, rig, seen, pose))
    state, angles, scores = _smoothed(state._replace(pose=pose), rig, pair, dt_s)
    body = telling.body_of(state, rig, pair, angles, scores)
    return state, body, telling.guide_of(state, rig, pair, settled_at is not None)


def _heard(frames: tuple[int, int], pair: Pair) -> tuple[int, int]:
    first, second = pair
    return (
        frames[0] if first is None else first.frame,
        frames[1] if second is None else second.frame,
    )


def _with_rig(state: State, seen: Seen) -> State:
    """The rig, assumed at the first sight of a whole person where none is calibrated."""
    whole = [report for report in seen if report is not None and not report.cut]
    if state.rig is not None or not whole:
        return state
    return state._replace(rig=assumed_rig(whole[0], whole[-1], state.settings.body.stature_m))


def _faced(state: State, seen: Seen) -> State:
    """Facade and flank, settled between the views' votes (P48); one view alone decides itself.

    Of a body that both views have measured, the one that is left decides nothing in `default`:
    arms that are raised narrow the upper body as a turn would, and nobody is left to say no.
    """
    first, second = seen
    if first is None or second is None:
        own = first or second
        assert own is not None
        other: Facing = "flank" if own.vote == "facade" else "facade"
        facing = (own.vote, other) if second is None else (other, own.vote)
        held = state.settings.mode == "default" and state.opening.measured
        return state if held else state._replace(facing=facing)
    sights = [
        Sight(before, report.vote, report.upper_body_px, *report.thresholds_px)
        for before, report in zip(state.facing, (first, second), strict=True)
    ]
    ratio = 1.0
    if state.settings.mode == "default" and state.pose is not None and state.rig is not None:
        scales = scales_at(state.rig, state.pose[:3])
        ratio = scales[0] / scales[1]
    return state._replace(facing=arbitrate(sights[0], sights[1], ratio))


def _posed(state: State, rig: Rig, seen: Seen, settled_at: Vector | None) -> Vector:
    """Position and angles of this instant, not yet smoothed (P50-P54)."""
    front = 0 if state.facing[0] == "facade" else 1
    before = rest_pose() if state.pose is None else state.pose
    pose = fused(before, seen[front], seen[1 - front])
    if settled_at is None:
        pose[:3] = place_of(rig, roots_of(seen), before[:3], front)
    else:
        pose[:3] = settled_at
    pose[POSE_INDEX["torso_y"]] = YAW_DEG[front]
    return pose


def _believed(
    state: State, rig: Rig, seen: Seen, pose: Vector, dt_s: float
) -> tuple[State, Vector]:
    """The pose that the silhouettes propose, else the fused one with its doubts settled.

    Both are departures from the paper. An assumed rig's places are not those that the network was
    taught in: there the doubts are settled by matching.
    """
    if state.settings.mode != "default":
        return state, pose
    bdp = state.opening.bdp
    assert bdp is not None
    memory = None if state.insight is None else state.insight.memory
    calibrated = state.scale_source == "calibrated"
    known = insight.step(memory, bdp, rig, seen, dt_s) if calibrated else None
    if known is None:
        state = state._replace(insight=None, beside_m=None)
        return state, _settled(state, rig, seen, pose)
    before = rest_pose() if state.pose is None else state.pose
    body = body_vector(bdp)
    pose, beside_m = insight.pose_and_rest(body, before, known.joints_m)
    return state._replace(insight=known, beside_m=beside_m), pose


def _settled(state: State, rig: Rig, seen: Seen, pose: Vector) -> Vector:
    """What one view alone cannot tell, by both silhouettes: a departure from the paper (L2, L3)."""
    first, second = seen
    if first is None or second is None:
        return pose
    if (first.width, first.height) != (second.width, second.height):
        return pose
    assert state.opening.bdp is not None
    before = rest_pose() if state.pose is None else state.pose
    known, body = state.opening, body_vector(state.opening.bdp)
    upright_m = known.measured_at_m[1] if known.measured else float(body[8] + body[14])
    pose[POSE_INDEX["torso_x"]] = 0.0
    fitted = bool(known.samples) and not known.measured
    return settled(pose, before, body, rig, (first, second), upright_m, fitted)


def _smoothed(
    state: State, rig: Rig, pair: Pair, dt_s: float
) -> tuple[State, Vector, tuple[float, float]]:
    """The smooth angles, and S of the pose in each view; a pose that fits badly is not believed."""
    assert state.pose is not None
    assert state.opening.bdp is not None
    body = body_vector(state.opening.bdp)
    first, second = (_score(body, state.pose, rig, n, report) for n, report in enumerate(pair))
    fits = max(first, second) >= LOST_SCORE
    believed = fits or state.smooth.P is None  # there is nothing else to go by yet
    raw = state.pose[list(ANGLES_IN_POSE)] if believed else None
    smooth, angles, _ = smoothing.step(state.smooth, raw, dt_s)
    state = state._replace(smooth=smooth, badly=0 if fits else state.badly + 1)
    return state, angles, (first, second)


def _score(body: Vector, pose: Vector, rig: Rig, n: int, report: Report | None) -> float:
    """S of the whole body in one picture, true perspective; 0 where that view has nobody."""
    if report is None or report.root_px is None:
        return 0.0
    seen, view = packed(report), view_of(rig.cameras[n])
    return float(match(body, pose, view, ALL_LIMBS, report.width, seen, count(seen)))


def _without_pose(state: State) -> State:
    """Nobody is in any view: what was learnt of the body is kept, its pose is not."""
    fresh = smoothing.init(len(ANGLE_NAMES), state.smooth.period_s)
    return state._replace(pose=None, badly=0, smooth=fresh, insight=None)
