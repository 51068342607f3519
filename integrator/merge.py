"""Two reports in, one body out: position, body, facing, pose, in the order of section 4."""

from typing import Literal

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, Bdp, Vector, rest_pose
from common.body.kinematics import ALL_LIMBS
from common.body.proportions import body_vector
from common.bus.messages import Body, Guide, Report
from common.config import Settings, proposes
from common.raster.bits import count
from common.raster.kernel import match, view_of
from common.rig.camera import Rig
from integrator import opening_posture, outgoing
from integrator.fit import pose_refinement, shape_fit, visual_hull
from integrator.fit.silhouette_pair import packed
from integrator.merge_state import State
from integrator.pairing import Pair, Seen
from integrator.paper import fused_pose
from integrator.paper.arbiter import facing_of
from integrator.pose import smoothing
from integrator.proposal import pose_proposal
from integrator.rig.assumed_rig import assumed_rig
from integrator.rig.undistortion import undistorted_pair as straight_pair
from integrator.rig.undistortion import undistorted_rig as straight_rig
from integrator.track_status import LOST_SCORE


def init(rig: Rig | None, period_s: float, settings: Settings, body: Bdp | None = None) -> State:
    """An integrator that has heard nothing.

    Args:
        rig: The calibrated cameras of viewer 1 and viewer 2, for the working size; None: a rig
            of the paper's kind is assumed when somebody is seen.
        period_s: Time between frames.
        settings: Of the run.
        body: Universal BDPs, metres, where they were measured before.
    """
    source: Literal["calibrated", "assumed"] = "assumed" if rig is None else "calibrated"
    smooth = smoothing.init(len(ANGLE_NAMES), period_s)
    return State(settings, rig, source, smooth, opening_posture.init(body))


def step(state: State, pair: Pair) -> tuple[State, Body, Guide]:
    """One instant: what each viewer reports of it becomes one body, and a guide for the next.

    Universal BDPs come from the opening posture (P46), the arbiter settles the facing (P48),
    position and angles are fused (P50-P54) and smoothed; the viewers are told BDPs, positions
    and facing for their next frame (P2).

    In `default` mode outlines of which no pose is sure and that fit badly are looked at again,
    without what is no part of the person, and so are those after them.
    """
    clean, strays = _of_one_piece(state, pair) if state.doubted else (pair, False)
    after, body, guide = _merged(state, clean)
    if not state.doubted and _is_doubtful(after, body):
        clean, strays = _of_one_piece(state, pair)
        after, body, guide = _merged(state, clean) if strays else (after, body, guide)
    return after._replace(doubted=strays or _is_doubtful(after, body)), body, guide


def _is_doubtful(state: State, body: Body) -> bool:
    known = state.insight
    return min(body.score) < pose_refinement.POOR and not (
        known and pose_refinement.is_confident(known.sure)
    )


def _merged(state: State, pair: Pair) -> tuple[State, Body, Guide]:
    """The same with outlines that are believed."""
    now_s, before_s = pair.newest.captured_s, state.last_s
    dt_s = 0.0 if before_s is None else max(0.0, now_s - before_s)
    state = state._replace(frames=_heard(state.frames, pair), last_s=now_s)
    straight = straight_pair(state.rig, pair)
    seen = straight.detections
    state = _with_rig(state, seen)
    if seen == (None, None) or state.rig is None:
        state = _without_pose(state)
        return (state, *outgoing.nobody(state, pair))
    rig = straight_rig(state.rig)
    opened, settled_at = opening_posture.step(
        state.opening, rig, seen, state.settings.body.opening_frames
    )
    state = state._replace(opening=opened)
    if _is_proposed(state):
        state = _proposed(state, rig, seen, dt_s)
    else:
        state = fused_pose.step(state, rig, seen, settled_at)
    if state.settings.mode == "default":
        assert state.pose is not None
        state = state._replace(opening=shape_fit.step(state.opening, rig, seen, state.pose))
    state, angles, scores = _smoothed(state, rig, straight, dt_s)
    assert state.rig is not None
    body = outgoing.body_of(state, state.rig, pair, angles, scores)
    return state, body, outgoing.guide_of(state, state.rig, pair, settled_at is not None)


def _of_one_piece(state: State, pair: Pair) -> visual_hull.Cleaned:
    """The reports without what is no part of the person: a departure from the paper."""
    if state.rig is None or not _is_proposed(state):
        return visual_hull.Cleaned(pair, False)
    return visual_hull.cleaned(state.rig, pair)


def _is_proposed(state: State) -> bool:
    return proposes(state.settings, state.scale_source == "calibrated")


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


def _proposed(state: State, rig: Rig, seen: Seen, dt_s: float) -> State:
    """The pose that the silhouettes propose, and who sees its facade: beyond the paper."""
    bdp = state.opening.bdp
    assert bdp is not None
    memory = None if state.insight is None else state.insight.memory
    known = pose_proposal.step(memory, bdp, rig, seen, dt_s)
    before = rest_pose() if state.pose is None else state.pose
    body = body_vector(bdp)
    pose, beside_m = pose_proposal.pose_and_rest(body, before, known.joints_m)
    better = pose_refinement.refined(
        pose, known.sure, pose_refinement.Previous(state.pose, state.matched), body, rig, seen
    )
    if better is not None:
        pose, beside_m[pose_proposal.ARMS] = better, 0.0
    state = state._replace(insight=known, beside_m=beside_m, matched=better is not None)
    return state._replace(pose=pose, facing=facing_of(rig, pose))


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
    return state._replace(pose=None, badly=0, smooth=fresh, insight=None, matched=False)
