"""Two reports in, one body out: held against a person who stands, squats, lifts and leaves."""

from itertools import pairwise
from types import SimpleNamespace
from typing import Any, Literal

import msgspec
import numpy as np
import pytest
from staging import (
    NOBODY,
    PAPER,
    PERSON,
    RIG,
    Stage,
    Told,
    between,
    exact,
    observation,
    opening,
    person_of,
    report,
    silhouettes,
    squatting,
    standing,
)
from two_people import PERIOD_S, first_m, instant, other_m, seen

from calibration.gate import rig_agreement
from calibration.gate.sight_clash import Clash
from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, JOINT_NAMES, POSE_INDEX, Vector
from common.body.kinematics import joints
from common.body.proportions import body_vector, stature
from common.bus.instant import Instant
from common.bus.message_codec import decode, encode
from common.bus.messages import Guide, ScaleSource
from common.config.settings import Settings
from common.method import DEFAULT, Mode
from common.rig.camera import project
from integrator import diagnostics, merge, merge_state
from integrator.belief import LOST_S
from integrator.frame_numbers import NO_FRAME, FrameTimes
from integrator.measuring.known_body import Measured, Unknown, Unmeasured
from integrator.person import Following, Posed, Sighting, Waiting
from integrator.pose import smoothing
from integrator.rig import same_person
from integrator.rig.body_position import scales_at

LOST = round(15 * LOST_S)
MODES = pytest.mark.parametrize("mode", ["paper", "default"])


@pytest.fixture(autouse=True)
def exact_silhouettes(monkeypatch: pytest.MonkeyPatch) -> None:
    exact(monkeypatch)


def angle(told: Told, name: str) -> float:
    return told.body.pose[POSE_INDEX[name]]


def place(told: Told) -> tuple[float, ...]:
    return told.body.pose[:3]


def errors_m(told: Told, truth: Vector) -> Vector:
    """Distance of each joint from the true one."""
    true = joints(body_vector(PERSON), truth)
    distances: Vector = np.linalg.norm(np.array(told.body.joints_m) - true, axis=1)
    return distances


def after_opening(stage: Stage) -> Stage:
    """The body measured, the arms let down."""
    stage.show([opening()] * 7 + between(opening(), standing(), 12))
    return stage


MOVES = {
    "stand": standing(),
    "squat": squatting(50.0),
    "right": standing(r_hip_x=55.0, r_knee_x=-50.0),
    "left": standing(l_hip_x=55.0, l_knee_x=-50.0),
}


def test_standing_squatting_and_lifting_are_told_apart() -> None:
    """P52-P54, M16: rendered, through both viewers and the integrator.

    Both hips must bend in a squat and none while standing, one at least while a leg is lifted.
    Which one is not asked: the flank's silhouette cannot tell legs apart, and the facade's theta_Z
    wanders past 185 while a leg points at it.
    """
    bent: dict[str, list[float]] = {}
    for name, target in MOVES.items():
        stage = after_opening(Stage(settings=PAPER))
        last = stage.show(between(standing(), target, 16) + [target] * 4)[-1]
        bent[name] = sorted(angle(last, f"{side}_hip_x") for side in "rl")
        assert last.body.status == "tracking"
        front = next(
            r for r, f in zip(last.reports, last.body.facing, strict=True) if f == "facade"
        )
        assert front is not None
        search = person_of(front).search
        assert search is not None
        assert search.squatting == (name == "squat")
    assert bent["stand"] == pytest.approx([0.0, 0.0], abs=10.0)
    assert bent["squat"] == pytest.approx([50.0, 50.0], abs=8.0)
    for lifted in ("right", "left"):
        assert bent[lifted][1] == pytest.approx(55.0, abs=10.0)
        assert bent[lifted][0] < 20.0


@pytest.mark.parametrize("side", ["r", "l"])
def test_an_arm_raised_sideways_is_the_facades(side: str) -> None:
    """P51: theta_Z down from the opening posture to 120 degrees (240)."""
    target_deg = 120.0 if side == "r" else 240.0
    target = standing((0.0, 0.0), **{f"{side}_shoulder_z": target_deg})
    stage = after_opening(Stage(settings=PAPER))
    last = stage.show(between(standing(), target, 12) + [target] * 4)[-1]
    assert angle(last, f"{side}_shoulder_z") == pytest.approx(target_deg, abs=8.0)
    assert errors_m(last, target).mean() < 0.1


@MODES
def test_the_body_is_followed_through_the_room(mode: Mode) -> None:
    """P27, P44, P50: 0.4 m to the side and 0.4 m back, within 6 cm on the floor."""
    stage = after_opening(Stage(settings=Settings(mode=mode)))
    path = between(standing(), standing((0.4, 0.0)), 15)
    path += between(standing((0.4, 0.0)), standing((0.4, -0.4)), 15)
    for told, truth in zip(stage.show(path), path, strict=True):
        assert place(told)[::2] == pytest.approx(truth[[0, 2]], abs=0.06)
        assert told.body.views == "both"


def test_the_guide_carries_the_scale_of_where_the_body_is() -> None:
    """P2, P29, P45: r_t1 and r_t2 for the viewers' next frame, from this frame's place."""
    stage = after_opening(Stage())
    path = between(standing(), standing((0.3, 0.5)), 20)
    told = stage.show(path)
    for before in told:
        assert before.guide.scale_px_per_m == pytest.approx(
            scales_at(RIG, np.array(before.body.pose[:3])), rel=1e-6
        )
    last, body = told[-1].guide, stage.state.person.body
    assert isinstance(body, Measured)
    measured_at_m = np.array(body.measured_at_m)
    factors = np.array(last.scale_px_per_m) / np.array(scales_at(RIG, measured_at_m))
    assert factors == pytest.approx([4.0 / 3.5, 4.0 / 4.3], rel=0.03)


@pytest.mark.slow
def test_a_raised_hand_does_not_change_the_scale() -> None:
    """P29: the highest pixel is the hand then; T' / T "is not usable" (section 4.2)."""
    stage = after_opening(Stage())
    before = stage.show([standing()])[-1].guide.scale_px_per_m
    raised = standing(r_shoulder_z=20.0, l_shoulder_z=340.0)
    after = stage.show(between(standing(), raised, 16) + [raised] * 4)[-1].guide.scale_px_per_m
    assert after == pytest.approx(before, rel=0.02)


@MODES
def test_an_empty_room_has_nobody_though_it_scores(mode: Mode) -> None:
    """M25: S of an empty silhouette is e^-1 for any model; presence decides, not S."""
    stage = Stage(settings=Settings(mode=mode))
    for told in [stage.see((NOBODY, NOBODY)) for _ in range(3)]:
        assert (told.body.status, told.body.views) == ("empty", "none")
        assert told.body.joints_m == ()
        assert told.body.score == (0.0, 0.0)
    stage.show([opening()] * 2)
    gone = stage.see((NOBODY, NOBODY))
    assert gone.body.status == "empty"
    assert gone.guide.bdp is not None


def test_a_pose_is_told_from_the_first_frame_on() -> None:
    """Measuring, by prior proportions; tracking once three frames have made the body (P46)."""
    told = Stage(settings=PAPER).show([opening()] * 8)
    assert [t.body.status for t in told] == ["measuring"] * 2 + ["tracking"] * 6
    for t in told:
        assert len(t.body.joints_m) == len(t.body.confidence) == 15
        assert errors_m(t, opening()).mean() < 0.15
        assert decode(encode(t.body), type(t.body)) == t.body
        assert decode(encode(t.guide), type(t.guide)) == t.guide
    assert [t.guide.measured for t in told] == [False] * 2 + [True] * 6
    assert told[-1].guide.bdp is not None
    assert stature(told[-1].guide.bdp) == pytest.approx(1.75, abs=0.08)


def test_who_never_stretches_the_arms_is_tracked_by_prior_proportions() -> None:
    """P10: nothing is measured, and nothing is waited for."""
    told = Stage(settings=PAPER).show([standing()] * 8)
    assert {t.body.status for t in told} == {"tracking"}
    assert not told[-1].guide.measured
    assert errors_m(told[-1], standing()).mean() < 0.15


def test_a_body_that_fits_nothing_is_predicted_then_lost_then_found() -> None:
    """L1: found again by itself, once the person is there."""
    stage = after_opening(Stage(settings=PAPER))
    stage.show([standing()])
    block = NOBODY.copy()
    block[2:14, 10:150] = True  # a banner
    states = [stage.see((block, block)).body for _ in range(LOST + 1)]
    assert [body.status for body in states] == ["predicted"] * (LOST - 1) + ["lost"] * 2
    assert set(states[-1].confidence) == {0.0}
    assert states[0].joints_m
    assert not states[-1].joints_m
    again = stage.show([standing()] * 6)[-1]
    assert again.body.status == "tracking"
    assert errors_m(again, standing()).mean() < 0.12


@pytest.mark.slow
def test_one_view_that_never_believed_anybody_is_lost_at_once() -> None:
    """A door that opens where nobody was; a body that was believed is predicted for a while."""
    banner = NOBODY.copy()
    banner[2:14, 10:150] = True
    first = Stage(views=(1,)).see((banner, None)).body
    assert (first.status, first.joints_m) == ("lost", ())
    stage = Stage(views=(1,))
    assert stage.show([standing()] * 3)[-1].body.status == "tracking"
    assert stage.see((banner, None)).body.status == "predicted"
    stage.see((NOBODY, None))
    assert stage.see((banner, None)).body.status == "lost"


def test_who_is_partly_outside_the_only_picture_is_tracked_and_guessed_outside() -> None:
    """A desk's camera shows no feet: what it does show is believed."""
    near = [standing((0.0, 0.15 * n)) for n in range(8)]
    told = Stage(views=(1,)).show(near)[-1]
    assert told.reports[0] is not None
    assert person_of(told.reports[0]).cut
    assert told.body.status == "tracking"
    sure = dict(zip(JOINT_NAMES, told.body.confidence, strict=True))
    assert sure["l_ankle"] == sure["r_ankle"] == 0.0 < sure["neck"]


@pytest.mark.parametrize(
    ("people", "source", "counts"),
    [
        ("all", "calibrated", True),
        ("all", "person", True),
        ("all", "assumed", False),
        (1, "calibrated", False),
    ],
)
def test_the_floor_counts_where_it_is_known_and_others_may_hide_the_person(
    people: Literal[1, "all"], source: ScaleSource, counts: bool
) -> None:
    stage = Stage(views=(1,))
    stage.state = stage.state._replace(scale_source=source, settings=Settings(people=people))
    stage.show([standing()] * 2)
    found = stage.state.person.found
    assert found is not None
    assert found.alone is not None
    assert (found.alone.place is not None) == counts


@pytest.mark.parametrize("silent", [0, 1])
def test_one_viewer_alone_carries_on(silent: int) -> None:
    """The other falls silent while tracking: position across the line of sight, views named."""
    stage = after_opening(Stage(settings=PAPER))
    stage.show([standing()])
    for _ in range(5):
        masks = list(silhouettes(standing()))
        masks[silent] = None  # type: ignore[call-overload]
        told = stage.see((masks[0], masks[1]))
    assert told.body.views == ("2" if silent == 0 else "1")
    assert told.body.status == "tracking"
    assert told.body.score[silent] == 0.0
    assert errors_m(told, standing()).mean() < 0.12
    both = stage.show([standing()])[-1]
    assert both.body.views == "both"


def test_who_leaves_one_view_for_the_other_is_told_by_what_that_one_knows() -> None:
    """Its front and back, and where its segments lean, are by its own camera."""
    stage, (first, second) = Stage(), silhouettes(standing())
    for masks, number in (((first, None), 1), ((None, second), 2), ((first, None), 1)):
        stage.see(masks)
        found = stage.state.person.found
        assert found is not None
        assert found.alone is not None
        assert found.alone.number == number


@MODES
@pytest.mark.parametrize("alone", [1, 2])
def test_a_run_with_one_viewer_tells_a_body(mode: Mode, alone: int) -> None:
    told = Stage(settings=Settings(mode=mode), views=(alone,)).show([standing()] * 6)
    assert {t.body.views for t in told} == {str(alone)}
    assert len(told[-1].body.joints_m) == 15
    assert told[-1].reports[2 - alone] is None
    assert told[-1].body.score[alone - 1] > 0.6
    assert told[-1].body.score[2 - alone] == 0.0


@MODES
def test_without_a_calibration_the_person_sets_the_scale(mode: Mode) -> None:
    """scale_source: a body of 1.75 m on the floor, and the measure's own within 5 %."""
    stage = Stage(rig=None, settings=Settings(mode=mode))
    assert stage.state.scale_source == "assumed"
    first = stage.show([opening()])[-1]
    assert first.body.bdp is not None
    assert stature(first.body.bdp) == pytest.approx(1.75, abs=0.02)
    last = stage.show([opening()] * 6)[-1]
    assert last.body.bdp is not None
    assert stature(last.body.bdp) == pytest.approx(1.75, rel=0.05)
    feet = [last.body.joints_m[JOINT_NAMES.index(f"{side}_ankle")][1] for side in "rl"]
    assert feet == pytest.approx([0.07, 0.07], abs=0.06)
    assert Stage().state.scale_source == "calibrated"


def test_a_person_partly_outside_sets_no_scale() -> None:
    stage = Stage(rig=None)
    cut = NOBODY.copy()
    cut[40:120, 70:90] = True
    assert stage.see((cut, cut)).body.status == "empty"
    assert stage.state.rig is None


def test_a_view_that_cuts_the_person_off_sets_no_scale() -> None:
    """View 2 sees the upper half: the scale is the other view's alone, whichever that is."""
    whole = silhouettes(standing())
    half = whole[1].copy()
    half[60:] = False
    half[0:60, 80] = True
    both, alone = Stage(rig=None), Stage(rig=None)
    both.see((whole[0], half))
    alone.see((whole[0], None))
    assert both.state.rig == alone.state.rig is not None
    mirrored = Stage(rig=None)
    mirrored.see((half, whole[0]))
    assert mirrored.state.rig == both.state.rig


def test_a_person_behind_a_camera_is_followed_by_the_other() -> None:
    """P50 in a free rig: camera 2 stands beside the person and looks away from them.

    What it cannot say of them is no number in a guide, and a guide without it still reaches both.
    """
    away = msgspec.structs.replace(RIG.cameras[1], t=(0.0, 1.0, -1.0))
    rig = msgspec.structs.replace(RIG, cameras=(RIG.cameras[0], away))
    stage = Stage(rig=rig, settings=PAPER)
    for _ in range(4):
        told = stage.see((silhouettes(standing())[0], NOBODY))
    assert told.body.views == "1"
    assert told.guide.scale_px_per_m[0] == pytest.approx(50.0, rel=0.02)
    assert told.guide.scale_px_per_m[1] == 0.0
    assert decode(encode(told.guide), Guide) == told.guide
    back = stage.see((None, silhouettes(standing())[0]))
    assert back.reports[1] is not None
    search = person_of(back.reports[1]).search
    assert search is not None
    assert search.score > 0.5


def test_joints_in_the_pictures_are_the_joints_in_the_world() -> None:
    """C1."""
    told = after_opening(Stage()).show([standing((0.2, 0.1))])[-1]
    world = np.array(told.body.joints_m)
    for camera, pixels in zip(RIG.cameras, told.body.joints_px, strict=True):
        assert np.array(pixels) == pytest.approx(project(camera, world), abs=1e-6)


def turned(yaw_deg: float) -> Vector:
    return standing(torso_y=yaw_deg)


def test_a_turn_to_camera_2_exchanges_facade_and_flank() -> None:
    """P47-P49: exactly one facade at any time; theta_Y^T is 0 or -90."""
    stage = after_opening(Stage(settings=PAPER))
    path = between(turned(0.0), turned(-90.0), 20) + [turned(-90.0)] * 3
    told = stage.show(path)
    assert all(set(t.body.facing) == {"facade", "flank"} for t in told)
    assert told[0].body.facing == ("facade", "flank")
    assert told[-1].body.facing == ("flank", "facade")
    yaw_deg = told[-1].guide.pose[POSE_INDEX["torso_y"]]
    assert yaw_deg == -90.0
    changes = sum(a.body.facing != b.body.facing for a, b in pairwise(told))
    assert changes == 1


def test_a_late_partner_is_not_waited_for() -> None:
    """Reports of one instant alone are told as such; the guide says who was heard last."""
    state = merge_state.init(RIG, 1 / 15, Settings(), DEFAULT)
    masks = silhouettes(standing())
    first = report(1, masks[0], root_px=(80.0, 61.0), frame=7)
    state, body, guide = merge.step(state, Instant((first, None)))
    assert (body.frame, body.views, guide.frames) == (7, "1", (7, -1))
    second = msgspec.structs.replace(report(2, masks[1], root_px=(80.0, 61.0)), frame=9)
    state, body, guide = merge.step(state, Instant((None, second)))
    assert (body.frame, body.views, guide.frames) == (-1, "2", (7, 9))


def test_an_integrator_is_a_value() -> None:
    """The same pairs give the same bodies again."""
    stage = after_opening(Stage())
    state, masks = stage.state, silhouettes(standing())
    pair = Instant(
        (
            report(1, masks[0], root_px=(80.0, 61.0), frame=30, captured_s=2.0),
            report(2, masks[1], root_px=(80.0, 61.0), frame=30, captured_s=2.0),
        )
    )
    one, other = merge.step(state, pair), merge.step(state, pair)
    assert one[1:] == other[1:]


def instants(period_s: float = 0.1, alone: bool = False) -> merge_state.State:
    """An integrator that has heard nothing; camera 1 takes ten frames a second."""
    times = None if alone else FrameTimes(period_s)
    return merge_state.init(
        RIG, period_s, Settings(), DEFAULT, merge_state.Start(alone, times=times)
    )


def following(pose: Vector, period_s: float = 0.1, **more: Any) -> Following:
    """Somebody whose body is known had a pose at the instant before."""
    found, smooth = Posed(pose, ("facade", "flank")), smoothing.init(len(ANGLE_NAMES), period_s)
    return Following(Unmeasured(PERSON), found, smooth, **more)


def test_what_is_remembered_of_one_pair_of_views_is_none_of_another() -> None:
    """The networks' memory is of where the pair's cameras stand, the agreement is between them."""
    kept: Any = SimpleNamespace()
    person = following(standing())
    person = person._replace(found=person.found._replace(memory=kept))
    agreement = rig_agreement.State(last_s=3.0)
    before = instants()._replace(pair=(0, 1), person=person, agreement=agreement)
    same, other = merge._with_pair(before, (0, 1)), merge._with_pair(before, (0, 2))
    assert (same.person, same.agreement) == (person, agreement)
    assert other.pair == (0, 2)
    assert other.person.found == person.found._replace(memory=None)
    assert other.agreement == rig_agreement.State()


def test_an_instant_counts_on_from_what_each_viewer_reported_last() -> None:
    """Frames, uprights, times: a viewer that says nothing keeps what it said."""
    state = instants()._replace(frames=(4, 9), last_s=0.4, number=4, numbered=4)
    second = report(2, frame=12, captured_s=0.62)
    first = report(1, frame=6, captured_s=0.6)
    both, dt_s = merge._at(state, Instant((first, second)))
    assert (both.frames, both.number, both.numbered, both.last_s) == ((6, 12), 6, 6, 0.6)
    assert dt_s == 0.0, "nobody was there before"
    state = state._replace(person=following(standing()))
    later = msgspec.structs.replace(second, clock_s=1.0)
    own, dt_s = merge._at(state, Instant((first, later)))
    assert own.last_s == 0.62
    assert dt_s == pytest.approx(0.22)
    own, dt_s = merge._at(state, Instant((None, second)))
    assert (own.frames, own.number, own.numbered) == ((4, 12), 6, 6)
    assert dt_s == pytest.approx(0.22)
    back, dt_s = merge._at(state._replace(last_s=0.7), Instant((first, None)))
    assert (back.frames, back.last_s, dt_s) == ((6, 9), 0.6, 0.0)
    lower, _ = merge._at(state._replace(numbered=40), Instant((first, None)))
    assert (lower.number, lower.numbered) == (6, 40)


def test_how_a_picture_comes_from_its_file_is_kept_while_a_viewer_is_away() -> None:
    one: Any = SimpleNamespace(frame=3, captured_s=0.3, clock_s=0.3, upright="turned")
    before: Any = ("first", "second")
    state = instants()._replace(uprights=before)
    both: Any = merge._at(state, Instant((one, None)))[0].uprights
    assert both == ("turned", "second")
    one.frame = 5
    both = merge._at(state, Instant((None, one)))[0].uprights
    assert both == ("first", "turned")


def test_rows_are_camera_2s_only_where_that_is_alone_in_the_run() -> None:
    alone = instants(alone=True)
    second = report(2, frame=12, captured_s=0.6)
    assert merge._number(alone, Instant((None, second))) == 12
    assert merge._number(alone, Instant((report(1, frame=7), second))) == 7
    heard = alone._replace(frames=(3, 11))
    assert merge._number(heard, Instant((None, second))) == NO_FRAME


def test_a_pose_that_is_not_believed_does_not_move_the_smooth_one() -> None:
    """Unless there is nothing else to go by; and as printed there is none."""
    pose = standing((0.2, 0.1))
    raw = pose[list(ANGLES_IN_POSE)]
    started, angles = merge._smoothed(following(pose, doubted=2), DEFAULT, 0.1)
    assert angles == pytest.approx(raw)
    assert started.smooth.P is not None
    other = standing((0.2, 0.1), l_hip_x=30.0)
    moved = started._replace(found=started.found._replace(pose=other))
    _, held = merge._smoothed(moved, DEFAULT, 0.1)
    assert held == pytest.approx(raw, abs=1e-6)
    _, followed = merge._smoothed(moved._replace(doubted=0), DEFAULT, 0.1)
    at = ANGLE_NAMES.index("l_hip_x")
    assert 5.0 < followed[at] <= 30.0
    printed = msgspec.structs.replace(DEFAULT, smoothing=False)
    same, angles = merge._smoothed(moved, printed, 0.1)
    assert same is moved
    assert angles == pytest.approx(other[list(ANGLES_IN_POSE)])


def test_scores_are_those_of_each_views_own_camera_and_silhouette() -> None:
    """A body that stands where it is drawn; the second view shows it raised."""
    pose = standing((0.3, -0.2))
    first, second = silhouettes(pose)
    raised, _ = silhouettes(standing((0.3, -0.2), r_shoulder_z=90.0))
    person = following(pose)

    def scores(*masks: Any) -> tuple[float, ...]:
        given = [None if mask is None else observation(mask) for mask in masks]
        now = Sighting(Instant((None, None)), RIG, RIG, (given[0], given[1]), (0, 1), 0.1)
        return merge._scores(person, now)

    assert scores(first, second) == (1.0, 1.0)
    one, other = scores(raised, second)
    assert 0.5 < one < 0.95
    assert other == 1.0
    assert scores(first, None) == (1.0, 0.0)
    assert scores(None, second) == (0.0, 1.0)
    alone: Any = SimpleNamespace(score=0.37)
    person = person._replace(found=person.found._replace(alone=alone))
    assert scores(first, None) == (0.37, 0.0)
    assert scores(None, second) == (0.0, 0.37)


def test_without_anybody_the_body_is_kept_and_its_pose_is_not() -> None:
    person = following(standing(), doubted=3, ever_confirmed=True)
    state = instants()._replace(person=person)
    after, body, _ = merge.step(state, Instant((report(1, NOBODY, frame=1), None)))
    assert after.person == Waiting(person.body)
    assert (body.status, body.bdp) == ("empty", person.body.bdp)


def test_who_comes_has_a_filter_of_their_own_and_who_stays_keeps_theirs() -> None:
    """At the run's rate; whom a changed rig made to be looked for afresh was believed before."""
    person = following(standing(), doubted=3)
    known, found = Unmeasured(PERSON.scaled(1.1)), Posed(standing((0.2, 0.0)), ("flank", "facade"))
    stays = merge._following(instants()._replace(person=person), known, found)
    assert stays == person._replace(body=known, found=found)
    for believed in (False, True):
        state = instants(0.2)._replace(person=Waiting(ever_confirmed=believed))
        comes = merge._following(state, known, found)
        assert (comes.smooth.period_s, comes.smooth.P) == (0.2, None)
        assert comes.smooth.x.shape == (2, len(ANGLE_NAMES))
        assert (comes.doubted, comes.ever_confirmed) == (0, believed)


def two_views(n: int, one_m: Vector, two_m: Vector) -> Instant:
    """People as both views show them, with silhouettes of one who stands there."""
    shown = zip((0, 1), (one_m, two_m), silhouettes(standing()), strict=True)
    people = [
        msgspec.structs.replace(observation(mask), landmarks=seen(view, joints_m).landmarks)
        for view, joints_m, mask in shown
    ]
    return instant(n, *((each,) for each in people))


def test_a_view_that_turns_to_another_person_is_left_out_and_the_rig_is_not_doubted() -> None:
    state = merge_state.init(RIG, PERIOD_S, Settings(), DEFAULT)
    for n in range(30):
        state, body, _ = merge.step(state, two_views(n, first_m(n), first_m(n)))
        assert body.views == "both"
    for n in range(30, 60):
        state, body, _ = merge.step(state, two_views(n, first_m(n), other_m(n)))
    assert (body.views, body.seen) == ("1", (True, False))
    assert state.agreement.told is None
    assert diagnostics.doubt(state) == ""


def test_what_came_of_two_people_is_forgotten_and_a_body_that_was_seen_before_is_kept() -> None:
    prior = Unmeasured(PERSON)
    person = Waiting(prior, ever_confirmed=True)
    for met, body in ((LOST - 1, Unknown()), (LOST, prior)):
        pair = same_person.Pair((0, 1), Clash(met))
        state = merge_state.init(RIG, PERIOD_S, Settings(), DEFAULT)._replace(
            person=person, same=same_person.State(pairs=(pair,))
        )
        assert merge._without_another(state, LOST).person == Waiting(body, ever_confirmed=True)


def test_a_doubted_instant_does_not_exchange_the_person_for_a_surer_one() -> None:
    """The followed one's landmarks are unsure in view 2 for half a second."""
    masks = silhouettes(standing()), silhouettes(standing((2.2, -2.2)))
    state = merge_state.init(RIG, PERIOD_S, Settings(), DEFAULT)
    for n in range(50):
        if n == 41:
            assert isinstance(state.person, Following)
            state = state._replace(person=state.person._replace(doubted=1))
        sure = 0.4 if 40 <= n < 48 else 0.9
        people = [
            [seen(view, first_m(n), sure if view else 0.9), seen(view, other_m(n))]
            for view in (0, 1)
        ]
        shown = [
            [
                msgspec.structs.replace(observation(mask[view]), landmarks=one.landmarks)
                for mask, one in zip(masks, people[view], strict=True)
            ]
            for view in (0, 1)
        ]
        state, *_ = merge.step(state, instant(n, *shown))
        assert state.same.chosen == (0, 0), n


def test_an_assumed_rig_tells_no_people_apart() -> None:
    state = merge_state.init(RIG, PERIOD_S, Settings(), DEFAULT)._replace(scale_source="assumed")
    for n in range(30):
        state, *_ = merge.step(state, two_views(n, first_m(n), other_m(n)))
        assert state.same == same_person.State()


def test_a_body_that_landmarks_contradict_is_sized_by_them_and_its_pose_begins_anew() -> None:
    state = merge_state.init(RIG, PERIOD_S, Settings(), DEFAULT)
    for n in range(3):
        state, *_ = merge.step(state, two_views(n, first_m(n), first_m(n)))
    assert isinstance(state.person, Following)
    known = state.person.body
    assert isinstance(known, Unmeasured)
    small = known._replace(bdp=known.bdp.scaled(0.5), statures_m=())
    state = state._replace(person=state.person._replace(body=small, doubted=2))
    for n in range(3, 20):
        state, body, _ = merge.step(state, two_views(n, first_m(n), first_m(n)))
    assert body.bdp is not None
    assert stature(body.bdp) == pytest.approx(1.75, rel=0.06)


def test_a_new_size_forgets_the_pose_and_not_the_doubt() -> None:
    state = merge_state.init(RIG, PERIOD_S, Settings(), DEFAULT)
    for n in range(3):
        state, *_ = merge.step(state, two_views(n, first_m(n), first_m(n)))
    assert isinstance(state.person, Following)
    rig, both = RIG, two_views(3, first_m(3), first_m(3))
    now = Sighting(both, rig, rig, both.detections, (0, 1), PERIOD_S)
    small = Unmeasured(PERSON.scaled(0.5), statures_m=(1.75,) * 10)
    state = state._replace(person=state.person._replace(body=small, doubted=2))
    after, sized = merge._sized(state, small, now)
    assert stature(sized.bdp) == pytest.approx(1.75, rel=0.03)
    assert isinstance(after.person, Following)
    assert (after.person.found.memory, after.person.doubted) == (None, 2)
    assert merge._sized(after, sized, now)[0] is after
