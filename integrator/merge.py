"""Two reports in, or one, and one body out: place, body, facing, pose, in section 4's order."""

from typing import Final

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, Vector
from common.body.kinematics import ALL_LIMBS
from common.body.proportions import body_vector
from common.body.stick_body import ADULT, THESIS
from common.bus.messages import Body, Guide, Report
from common.config import Settings
from common.method import Method
from common.raster.bits import count
from common.raster.kernel import match, view_of
from common.raster.silhouette_report import words_of
from common.rig.camera import Rig
from integrator import opening_posture, outgoing
from integrator.fit import proposed_pose, shape_fit
from integrator.merge_state import Posed, ScaleSource, State
from integrator.opening_posture import Opening
from integrator.pairing import Pair, Seen
from integrator.paper import fused_pose
from integrator.pose import joint_limits, smoothing
from integrator.rig.assumed_rig import assumed_rig
from integrator.rig.body_position import facing_of
from integrator.rig.undistortion import undistorted_pair, undistorted_rig
from integrator.single import single_view
from integrator.single.sight import Annotations, Sight

NOTHING_SAID = Annotations()
LOST_SCORE: Final = 0.35
"""A body whose S is lower than this in every view is not believed."""


def init(
    rig: Rig | None,
    period_s: float,
    settings: Settings,
    method: Method,
    *,
    alone: bool = False,
    source: ScaleSource | None = None,
    opening: Opening = Opening(),
) -> State:
    """An integrator that has heard nothing.

    Args:
        rig: The cameras of viewer 1 and viewer 2, for the working size; None: a rig of the
            paper's kind is assumed when somebody is seen.
        period_s: Time between frames.
        settings: Of the run.
        method: What is done beyond the print.
        alone: One viewer is all that the run has.
        source: Where the rig is from; None: it is calibrated, if there is one.
        opening: What is known of the body.
    """
    source = source or ("assumed" if rig is None else "calibrated")
    proposes = method.proposals and (alone or source == "calibrated")
    smooth = smoothing.init(len(ANGLE_NAMES), period_s)
    return State(settings, method, rig, source, proposes, smooth, opening)


def step(
    state: State, pair: Pair, annotations: Annotations = NOTHING_SAID
) -> tuple[State, Body, Guide]:
    """One instant: what each viewer reports of it becomes one body, and a guide for the next.

    Universal BDPs come from the opening posture (P46), the arbiter settles the facing (P48),
    position and angles are fused (P50-P54) and smoothed; the viewers are told BDPs, positions
    and facing for their next frame (P2). One view alone is lifted (thesis 3.1.5).

    Args:
        state: From `init` or the step before.
        pair: What each viewer reports.
        annotations: What the user says of the frame, where one view is alone.
    """
    state, dt_s = _at(state, pair)
    straight = undistorted_pair(state.rig, pair)
    seen = straight.detections
    state = _with_rig(state, seen)
    if seen == (None, None) or state.rig is None:
        state = _without_pose(state)
        return (state, *outgoing.nobody(state, pair))
    rig = undistorted_rig(state.rig)
    opened, settled_at = opening_posture.step(
        state.opening, rig, seen, state.settings.body.opening_frames
    )
    state = state._replace(opening=opened)
    state, seen = _posed(state, rig, seen, dt_s, settled_at, annotations)
    if state.method.shape_fit and state.pose is not None:
        fitted = shape_fit.step(state.opening, rig, seen, state.pose)
        state = state._replace(opening=fitted)
    scores = _scores(state, rig, seen)
    state, angles = _smoothed(state, max(scores) >= LOST_SCORE, dt_s)
    body = outgoing.body_of(state, state.rig or rig, pair, angles, scores)
    return state, body, outgoing.guide_of(state, state.rig or rig, pair, settled_at is not None)


def _at(state: State, pair: Pair) -> tuple[State, float]:
    """The state at the moment of a pair, and the time since the one before."""
    now_s, before_s = pair.newest.captured_s, state.last_s
    frames = tuple(
        before if report is None else report.frame
        for before, report in zip(state.frames, pair, strict=True)
    )
    dt_s = 0.0
    if state.found is not None and before_s is not None:  # whom nobody saw before owes nothing
        dt_s = max(0.0, now_s - before_s)
    return state._replace(frames=(frames[0], frames[1]), last_s=now_s), dt_s


def _with_rig(state: State, seen: Seen) -> State:
    """The rig, assumed at the first sight of a whole person where none is calibrated."""
    whole = [report for report in seen if report is not None and not report.cut]
    if state.rig is not None or not whole:
        return state
    return state._replace(rig=assumed_rig(whole[0], whole[-1], state.settings.body.stature_m))


def _posed(
    state: State,
    rig: Rig,
    seen: Seen,
    dt_s: float,
    settled_at: Vector | None,
    annotations: Annotations,
) -> tuple[State, Seen]:
    """The state with the pose of an instant, and the reports without clutter: of one view,
    proposed, or searched for by the viewers."""
    if state.method.stick_lifting or (state.proposes and None in seen):
        return _with_pose(state, _lone(state, seen, dt_s, annotations)), seen
    if state.proposes:
        return _proposed(state, rig, seen, dt_s)
    return _with_pose(state, fused_pose.step(state, rig, seen, settled_at)), seen


def _with_pose(state: State, found: Posed) -> State:
    return state._replace(found=found, facing=found.facing)


def _lone(state: State, seen: Seen, dt_s: float, annotations: Annotations) -> Posed:
    """The pose that one view shows: the other is gone, sees nobody, or there is none."""
    n = 0 if seen[0] is not None else 1
    report, bdp = seen[n], state.opening.bdp
    assert report is not None
    assert bdp is not None
    assert state.rig is not None
    man = THESIS if state.method.stick_lifting else ADULT
    before, number = state.found, report.viewer
    sight = Sight(state.method, number, state.rig, report, man, bdp, state.pose, dt_s, annotations)
    known = before.alone if before is not None else None
    alone = known or single_view.begun(sight, None if before is None else before.joints_m)
    found = single_view.step(before.memory if before is not None else None, alone, sight)
    body = found.body
    return Posed(
        body.pose,
        facing_of(state.rig, body.pose),
        body.joints_m,
        body.confidence,
        found.memory,
        alone=found.alone,
    )


def _proposed(state: State, rig: Rig, seen: Seen, dt_s: float) -> tuple[State, Seen]:
    """The pose that both silhouettes propose, and who sees its facade: beyond the paper."""
    known, opening = state.found, state.opening
    assert opening.bdp is not None
    is_prior = not (opening.measured or opening.samples)
    before = proposed_pose.Before()
    if known is not None:
        before = proposed_pose.Before(known.memory, known.pose, known.matched)
    is_first = known is None and is_prior
    now = proposed_pose.Instant(opening.bdp, rig, seen, dt_s, state.method, is_first)
    found = proposed_pose.step(before, now)
    facing = facing_of(rig, found.pose)
    posed = Posed(found.pose, facing, found.joints_m, found.confidence, found.memory, found.matched)
    state = state._replace(opening=opening._replace(bdp=found.bdp))
    return _with_pose(state, posed), found.seen


def _smoothed(state: State, fits: bool, dt_s: float) -> tuple[State, Vector]:
    """The smooth angles; a pose that fits badly is not believed."""
    found = state.found
    assert found is not None
    state = state._replace(badly=0 if fits else state.badly + 1)
    raw: Vector = found.pose[list(ANGLES_IN_POSE)]
    if not state.method.smoothing:
        return state, raw
    believed = fits or state.smooth.P is None  # there is nothing else to go by yet
    smooth, angles, _ = smoothing.step(state.smooth, raw if believed else None, dt_s)
    if found.alone is not None and state.method.joint_limits:
        angles = joint_limits.clipped(angles)
    return state._replace(smooth=smooth), angles


def _scores(state: State, rig: Rig, seen: Seen) -> tuple[float, float]:
    """S of the pose in each picture; 0 where that view has nobody."""
    found = state.found
    assert found is not None
    if found.alone is not None:
        return (found.alone.score, 0.0) if seen[0] is not None else (0.0, found.alone.score)
    assert state.opening.bdp is not None
    body = body_vector(state.opening.bdp)
    first, second = (_score(body, found.pose, rig, n, report) for n, report in enumerate(seen))
    return first, second


def _score(body: Vector, pose: Vector, rig: Rig, n: int, report: Report | None) -> float:
    """S of the whole body in one picture, true perspective; 0 where that view has nobody."""
    if report is None:
        return 0.0
    seen, view = words_of(report), view_of(rig.cameras[n])
    return float(match(body, pose, view, ALL_LIMBS, report.width, seen, count(seen)))


def _without_pose(state: State) -> State:
    """Nobody is in any view: what was learnt of the body is kept, its pose is not."""
    fresh = smoothing.init(len(ANGLE_NAMES), state.smooth.period_s)
    return state._replace(found=None, badly=0, smooth=fresh)
