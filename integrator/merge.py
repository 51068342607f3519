"""The reports of an instant in, one body out: place, body, facing, pose, in section 4's order."""

from typing import NamedTuple

from calibration.gate import moved_cameras, rig_agreement, silhouette_motion
from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, Vector
from common.body.kinematics import ALL_LIMBS
from common.body.observation import Observation
from common.body.proportions import body_vector
from common.body.stick_body import ADULT, THESIS
from common.bus.instant import Instant, Seen
from common.bus.messages import Body, Guide
from common.raster.bits import count
from common.raster.kernel import match, view_of
from common.raster.silhouette_report import words_of
from common.rig.camera import Camera, Rig
from integrator import opening_posture, outgoing
from integrator.fit import proposed_pose, shape_fit
from integrator.fit.proposed_pose import ProposedPose
from integrator.frame_numbers import NO_FRAME, frame_at
from integrator.merge_state import Posed, State
from integrator.paper import fused_pose
from integrator.pose import joint_limits, smoothing
from integrator.rig.assumed_rig import assumed_rig
from integrator.rig.best_pair import Places, Two, best_pair, two_of
from integrator.rig.body_position import facing_of
from integrator.rig.tilted_camera import assumed_rig_of_one
from integrator.rig.undistortion import undistorted_instant, undistorted_rig
from integrator.single import single_view
from integrator.single.sight import Annotations, Sight


class Sighting(NamedTuple):
    """What the views show of a person, and what it is held against."""

    rig: Rig
    """Cameras without distortion."""
    seen: Seen
    """One of them at least is there."""
    pair: Places
    """The two views that show the person best."""
    dt_s: float
    """Time since the instant before; 0 where nobody was there."""
    annotations: Annotations

    @property
    def two(self) -> Two:
        """What is given to what takes two views."""
        return two_of(self.rig, self.seen, self.pair)


def step(
    state: State, instant: Instant, annotations: Annotations = Annotations()
) -> tuple[State, Body, Guide]:
    """One instant: what each viewer reports of it becomes one body, and a guide for the next.

    Universal BDPs come from the opening posture (P46), the arbiter settles the facing (P48),
    position and angles are fused (P50-P54) and smoothed; the viewers are told BDPs, positions
    and facing for their next frame (P2). One view alone is lifted (thesis 3.1.5).

    Args:
        state: From `merge_state.init` or the step before.
        instant: What each viewer reports.
        annotations: What the user says of the frame, where one view is alone.
    """
    state, dt_s = _at(state, instant)
    state = state._replace(
        stands=moved_cameras.step(state.stands, instant),
        motion=silhouette_motion.step(state.motion, instant),
    )
    shown = undistorted_instant(state.rig, instant)
    seen = shown.detections
    state = _with_rig(state, seen)
    if not any(seen) or state.rig is None:
        state = _without_pose(state)
        return (state, *outgoing.no_detection(state, instant))
    rig = undistorted_rig(state.rig)
    state = _with_pair(state, best_pair(state.pair, rig, seen))
    now = Sighting(rig, seen, state.pair or (0, 0), dt_s, annotations)
    state = _with_agreement(state, instant, now)
    state, settled_at = _with_opening(state, now)
    state, now = _with_pose(state, now, settled_at)
    state = _with_shape(state, now)
    scores = _scores(state, now)
    state = outgoing.weighed(state, instant, scores, annotations)
    state, angles = _smoothed(state, dt_s)
    body = outgoing.body_of(state, instant, now.seen, angles, scores)
    guide = outgoing.guide_of(state, instant, settled_at is not None)
    return state, body, guide


def _at(state: State, instant: Instant) -> tuple[State, float]:
    """The state at the moment of an instant, and the time since the one before."""
    now_s, before_s = instant.newest.captured_s, state.last_s
    frames = tuple(
        before if report is None else report.frame
        for before, report in zip(state.frames, instant.views, strict=True)
    )
    uprights = tuple(
        before if report is None else report.upright
        for before, report in zip(state.uprights, instant.views, strict=True)
    )
    dt_s = 0.0
    if state.found is not None and before_s is not None:  # whom nobody saw before owes nothing
        dt_s = max(0.0, now_s - before_s)
    number = _number(state, instant)
    return state._replace(
        frames=frames,
        uprights=uprights,
        last_s=now_s,
        number=number,
        numbered=max(number, state.numbered),
    ), dt_s


def _number(state: State, instant: Instant) -> int:
    """Rows are counted by camera 1's frames; by those of the first that is there in a run without
    it."""
    first, *others = instant.views
    if first is not None:
        return first.frame
    if state.times is None:
        there = [report.frame for report in others if report is not None]
        return there[0] if there and state.frames[0] < 0 else NO_FRAME
    return frame_at(state.times, instant.newest.captured_s, state.numbered, state.last_s)


def _with_rig(state: State, seen: Seen) -> State:
    """The rig, assumed at the first sight of a whole person where none is calibrated."""
    whole = [person for person in seen if person is not None and not person.cut]
    if state.rig is not None or not whole:
        return state
    stature_m = state.settings.body.stature_m
    if state.alone:
        rig = assumed_rig_of_one(whole[0], stature_m)
    else:
        rig = assumed_rig(whole[0], whole[-1], stature_m)
    return state._replace(rig=rig, stands=moved_cameras.told_by(state.stands, None, rig))


def _with_pair(state: State, pair: Places) -> State:
    """The state with the pair of an instant: what networks remember, and the views' agreement, is
    of the pair before."""
    if state.pair in (None, pair):
        return state._replace(pair=pair)
    found = None if state.found is None else state.found._replace(memory=None)
    return state._replace(pair=pair, found=found, agreement=rig_agreement.State())


def _with_agreement(state: State, instant: Instant, now: Sighting) -> State:
    """The state with what the pair shows of whether the rig is right."""
    first = instant.views[now.pair[0]]
    if first is None:
        return state
    agreement = rig_agreement.step(state.agreement, *now.two, first.captured_s)
    return state._replace(agreement=agreement)


def _with_opening(state: State, now: Sighting) -> tuple[State, Vector | None]:
    """The state with what is known of the body; the navel's place if that is now measured (4.2)."""
    due = state.settings.body.opening_frames
    opening, settled_at = opening_posture.step(state.opening, *now.two, due, state.method)
    return state._replace(opening=opening), settled_at


def _with_pose(state: State, now: Sighting, settled_at: Vector | None) -> tuple[State, Sighting]:
    """The state with the pose of an instant, and the instant without clutter: of one view,
    proposed, or searched for by the viewers (4.3, 4.4)."""
    if state.method.stick_lifting or (state.proposes and None in now.two.seen):
        found = _lone(state, now)
    elif state.proposes:
        both = _proposed(state, now)
        found = Posed(
            both.pose,
            facing_of(now.rig, both.pose),
            both.joints_m,
            both.confidence,
            both.memory,
            both.landmarks,
        )
        state = state._replace(opening=state.opening._replace(bdp=both.bdp))
        now = now._replace(seen=both.seen)
    else:
        found = fused_pose.step(state, *now.two, settled_at)
    return state._replace(found=found, facing=found.facing), now


def _lone(state: State, now: Sighting) -> Posed:
    """The pose that one view shows: the other is gone, sees nobody, or there is none."""
    bdp, before = state.opening.bdp, state.found
    assert bdp is not None
    assert state.rig is not None
    rig, seen = two_of(state.rig, now.seen, now.pair)
    place = 0 if seen[0] is not None else 1
    person = seen[place]
    assert person is not None
    method, dt_s, annotations = state.method, now.dt_s, now.annotations
    man = THESIS if method.stick_lifting else ADULT
    number = now.pair[place] + 1
    sight = Sight(method, place, rig, person, man, bdp, state.pose, dt_s, annotations, number)
    alone = before.alone if before is not None else None
    if alone is None or alone.number != number:
        alone = single_view.begun(sight, None if before is None else before.joints_m, alone)
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


def _proposed(state: State, now: Sighting) -> ProposedPose:
    """The pose that both silhouettes propose: beyond the paper."""
    known, opening = state.found, state.opening
    assert opening.bdp is not None
    before = proposed_pose.Before()
    if known is not None:
        before = proposed_pose.Before(known.memory, known.pose, known.landmarks)
    is_first = known is None and not (opening.measured or opening.samples)
    given = proposed_pose.Sighting(
        opening.bdp, now.rig, now.seen, now.pair, now.dt_s, state.method, is_first
    )
    return proposed_pose.step(before, given)


def _with_shape(state: State, now: Sighting) -> State:
    """The state with a body fitted to the silhouettes."""
    if not state.method.shape_fit or state.found is None:
        return state
    fitted = shape_fit.step(state.opening, *now.two, state.found.pose)
    return state._replace(opening=fitted)


def _scores(state: State, now: Sighting) -> tuple[float, ...]:
    """S of the pose in each picture; 0 where that view has nobody."""
    found = state.found
    assert found is not None
    if found.alone is not None:
        own = next(n for n, person in enumerate(now.seen) if person is not None)
        return tuple(found.alone.score if n == own else 0.0 for n in range(len(now.seen)))
    assert state.opening.bdp is not None
    body = body_vector(state.opening.bdp)
    return tuple(
        _score(body, found.pose, camera, person)
        for camera, person in zip(now.rig.cameras, now.seen, strict=True)
    )


def _score(body: Vector, pose: Vector, camera: Camera, person: Observation | None) -> float:
    """S of the whole body in one picture, true perspective; 0 where that view has nobody."""
    if person is None:
        return 0.0
    seen, view = words_of(person), view_of(camera)
    return float(match(body, pose, view, ALL_LIMBS, person.width, seen, count(seen)))


def _smoothed(state: State, dt_s: float) -> tuple[State, Vector]:
    """The smooth angles; those of a pose that is not believed do not count."""
    found = state.found
    assert found is not None
    raw: Vector = found.pose[list(ANGLES_IN_POSE)]
    if not state.method.smoothing:
        return state, raw
    believed = not state.doubted or state.smooth.P is None  # there is nothing else to go by yet
    smooth, angles, _ = smoothing.step(state.smooth, raw if believed else None, dt_s)
    if found.alone is not None and state.method.joint_limits:
        angles = joint_limits.clipped(angles)
    return state._replace(smooth=smooth), angles


def _without_pose(state: State) -> State:
    """Nobody is in any view: what was learnt of the body is kept, its pose is not."""
    fresh = smoothing.init(len(ANGLE_NAMES), state.smooth.period_s)
    return state._replace(found=None, doubted=0, ever_confirmed=False, smooth=fresh)
