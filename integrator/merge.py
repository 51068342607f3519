"""The views of an instant in, one body out: place, body, facing, pose, in section 4's order."""

from calibration.gate import moved_cameras, rig_agreement, silhouette_motion
from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, Vector
from common.body.kinematics import ALL_LIMBS
from common.body.observation import Observation
from common.body.proportions import body_vector
from common.body.stick_body import ADULT, THESIS
from common.bus.instant import Instant, Seen
from common.bus.messages import Body, Guide
from common.method import Method
from common.raster.bits import count
from common.raster.kernel import match, view_of
from common.raster.silhouette_report import words_of
from common.rig.camera import Camera
from integrator import belief, guidance, outgoing
from integrator.fit import proposed_pose, shape_fit
from integrator.fit.proposed_pose import ProposedPose
from integrator.frame_numbers import NO_FRAME, frame_at
from integrator.measuring import landmark_stature, opening_posture
from integrator.measuring.known_body import Known, Unknown, Unmeasured
from integrator.merge_state import State
from integrator.paper import fused_pose
from integrator.person import Following, Posed, Sighting, Waiting
from integrator.pose import joint_limits, smoothing
from integrator.rig import same_person
from integrator.rig.assumed_rig import assumed_rig
from integrator.rig.best_pair import Places, best_pair, two_of
from integrator.rig.body_position import facing_of
from integrator.rig.tilted_camera import assumed_rig_of_one
from integrator.rig.undistortion import undistorted_instant, undistorted_rig
from integrator.single import single_view
from integrator.single.sight import Annotations, Sight


def step(
    state: State, instant: Instant, annotations: Annotations = Annotations()
) -> tuple[State, Body, Guide]:
    """One instant: the viewers' reports become one body, and a guide for the next.

    Universal BDPs come from the opening posture (P46), the arbiter settles the facing (P48),
    position and angles are fused (P50-P54) and smoothed; the viewers get BDPs, positions and facing
    for their next frame (P2). A single view is lifted (thesis 3.1.5).

    Args:
        state: From `merge_state.init` or the step before.
        instant: The viewers' reports.
        annotations: The user's inputs for the frame, where one view is alone.
    """
    state, dt_s = _at(state, instant)
    state, instant, shown = _of_person(state, instant)
    state = state._replace(
        stands=moved_cameras.step(state.stands, instant),
        motion=silhouette_motion.step(state.motion, instant),
    )
    seen = shown.detections
    state = _with_rig(state, seen)
    if state.rig is None or not any(seen):
        state = state._replace(person=Waiting(state.person.body))
        return state, outgoing.no_person(state, instant), guidance.no_person(state, instant)
    rig = undistorted_rig(state.rig)
    pair = best_pair(state.pair, rig, seen)
    now = Sighting(instant, state.rig, rig, seen, pair, dt_s, annotations)
    return _followed(_with_agreement(_with_pair(state, pair), now), now)


def _of_person(state: State, instant: Instant) -> tuple[State, Instant, Instant]:
    """The instant with the same person in all views, as it is and without distortion.

    An assumed rig does not tell people apart.
    """
    shown = undistorted_instant(state.rig, instant)
    if state.rig is None or state.scale_source == "assumed":
        return state, instant, shown
    lasting = belief.lost_frames(state.period_s)
    expected = same_person.Expected(state.person.expected_m(lasting), lasting)
    same = same_person.step(state.same, undistorted_rig(state.rig), shown, expected)
    if same.is_apart and not state.same.is_apart:
        state = _without_another(state, lasting)
    own = same.chosen
    return (
        state._replace(same=same),
        same_person.of_person(instant, own),
        same_person.of_person(shown, own),
    )


def _without_another(state: State, lasting: int) -> State:
    """The state without what came of two people: agreement, pose, and a body that is a prior of
    both, where their views have not shown one person before."""
    body = state.person.body
    if isinstance(body, Unmeasured) and state.same.met < lasting:
        body = Unknown()
    person = Waiting(body, state.person.ever_confirmed)
    return state._replace(agreement=rig_agreement.State(), person=person)


def _followed(state: State, now: Sighting) -> tuple[State, Body, Guide]:
    """An instant with a person: their body, pose and scores, and the messages about them."""
    due, method = state.settings.body.opening_frames, state.method
    body, settled_at = opening_posture.step(state.person.body, *now.two, due, method)
    if state.scale_source != "assumed":
        state, body = _sized(state, body, now)
    found, body, now = _posed(state, body, now, settled_at)
    if method.shape_fit:
        body = shape_fit.step(body, *now.two, found.pose)
    person = _following(state, body, found)
    scores = _scores(person, now)
    floor, was = state.scale_source != "assumed", state.person
    person = belief.weighed(person, now, scores, state.period_s, before=was, on_floor=floor)
    person, angles = _smoothed(person, method, now.dt_s)
    state = state._replace(person=person, facing=found.facing)
    told = outgoing.body_of(state, person, now, angles, scores)
    return state, told, guidance.guide_of(state, person, now, settled_at is not None)


def _sized(state: State, body: Known, now: Sighting) -> tuple[State, Known]:
    """The body in the size that landmarks show; the pose of a body of another size is forgotten."""
    sized = landmark_stature.step(body, *now.two)
    person = state.person
    if sized.bdp != body.bdp and isinstance(person, Following):
        found = person.found._replace(memory=None, landmarks=None, alone=None)
        state = state._replace(person=person._replace(found=found))
    return state, sized


def _following(state: State, body: Known, found: Posed) -> Following:
    """The person, new or known, with their body and pose."""
    person = state.person
    if isinstance(person, Following):
        return person._replace(body=body, found=found)
    smooth = smoothing.init(len(ANGLE_NAMES), state.period_s)
    return Following(body, found, smooth, ever_confirmed=person.ever_confirmed)


def _at(state: State, instant: Instant) -> tuple[State, float]:
    """The state at the time of an instant, and the time since the one before."""
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
    if isinstance(state.person, Following) and before_s is not None:  # else nothing before
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
    """Rows are counted by camera 1's frames; in a run without it by those of the first camera
    present."""
    first, *others = instant.views
    if first is not None:
        return first.frame
    if state.times is None:
        there = [report.frame for report in others if report is not None]
        return there[0] if there and state.frames[0] < 0 else NO_FRAME
    return frame_at(state.times, instant.newest.captured_s, state.numbered, state.last_s)


def _with_rig(state: State, seen: Seen) -> State:
    """The rig, assumed at the first view of a whole person where none is calibrated."""
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
    """The state with the pair of an instant; a new pair resets the networks' memory and the
    views' agreement."""
    if state.pair in (None, pair):
        return state._replace(pair=pair)
    person = state.person
    if isinstance(person, Following):
        person = person._replace(found=person.found._replace(memory=None))
    return state._replace(pair=pair, person=person, agreement=rig_agreement.State())


def _with_agreement(state: State, now: Sighting) -> State:
    """The state with the pair's evidence about the rig."""
    first = now.instant.views[now.pair[0]]
    if first is None:
        return state
    agreement = rig_agreement.step(state.agreement, *now.two, first.captured_s)
    return state._replace(agreement=agreement)


def _posed(
    state: State, body: Known, now: Sighting, settled_at: Vector | None
) -> tuple[Posed, Known, Sighting]:
    """The pose of an instant, with its body, and the instant without clutter: from one view,
    proposed, or searched for by the viewers (4.3, 4.4).

    Args:
        state: Of the instant before.
        body: The body as now known.
        now: The instant.
        settled_at: Place of the navel where the body has just been measured (4.2).
    """
    if state.method.stick_lifting or (state.proposes and None in now.two.seen):
        return _lone(state, body, now), body, now
    if not state.proposes:
        return fused_pose.step(state, body, now.two, settled_at), body, now
    both = _proposed(state, body, now)
    found = Posed(
        both.pose,
        facing_of(now.rig, both.pose),
        both.joints_m,
        both.confidence,
        both.memory,
        both.landmarks,
    )
    return found, body._replace(bdp=both.bdp), now._replace(seen=both.seen)


def _lone(state: State, body: Known, now: Sighting) -> Posed:
    """The pose from a single view: the other is lost, sees no person, or does not exist."""
    before, method = state.person.found, state.method
    filed = two_of(now.filed_rig, now.seen, now.pair)
    place, person = filed.first_seen
    man = THESIS if method.stick_lifting else ADULT
    number = now.pair[place] + 1
    held = (filed.rig, person, man, body.bdp, state.person.pose, now.dt_s, now.annotations)
    on_floor = state.settings.people == "all" and state.scale_source != "assumed"
    sight = Sight(method, place, *held, number, on_floor=on_floor)
    alone = None if before is None else before.alone
    if alone is None or alone.number != number:
        alone = single_view.begun(sight, None if before is None else before.joints_m, alone)
    found = single_view.step(None if before is None else before.memory, alone, sight)
    return Posed(
        found.body.pose,
        facing_of(now.filed_rig, found.body.pose),
        found.body.joints_m,
        found.body.confidence,
        found.memory,
        alone=found.alone,
    )


def _proposed(state: State, body: Known, now: Sighting) -> ProposedPose:
    """The pose proposed by both silhouettes: beyond the paper."""
    known = state.person.found
    before = proposed_pose.Before()
    if known is not None:
        before = proposed_pose.Before(known.memory, known.pose, known.landmarks)
    is_first = known is None and isinstance(body, Unmeasured) and not body.samples
    given = proposed_pose.Sighting(
        body.bdp, now.rig, now.seen, now.pair, now.dt_s, state.method, is_first
    )
    return proposed_pose.step(before, given)


def _scores(person: Following, now: Sighting) -> tuple[float, ...]:
    """S of the pose in each picture; 0 where that view has no person."""
    alone = person.found.alone
    if alone is not None:
        own = next(n for n, seen in enumerate(now.seen) if seen is not None)
        return tuple(alone.score if n == own else 0.0 for n in range(len(now.seen)))
    body = body_vector(person.body.bdp)
    return tuple(
        _score(body, person.pose, camera, seen)
        for camera, seen in zip(now.rig.cameras, now.seen, strict=True)
    )


def _score(body: Vector, pose: Vector, camera: Camera, person: Observation | None) -> float:
    """S of the whole body in one picture, true perspective; 0 where that view has no person."""
    if person is None:
        return 0.0
    seen, view = words_of(person), view_of(camera)
    return float(match(body, pose, view, ALL_LIMBS, person.width, seen, count(seen)))


def _smoothed(person: Following, method: Method, dt_s: float) -> tuple[Following, Vector]:
    """The smoothed angles; those of a pose that is not believed do not count."""
    raw: Vector = person.pose[list(ANGLES_IN_POSE)]
    if not method.smoothing:
        return person, raw
    believed = not person.doubted or person.smooth.P is None  # there is no other angle yet
    smooth, angles, _ = smoothing.step(person.smooth, raw if believed else None, dt_s)
    if person.found.alone is not None and method.joint_limits:
        angles = joint_limits.clipped(angles)
    return person._replace(smooth=smooth), angles
