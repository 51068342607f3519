"""What is told of an instant: a body whose doubts count, and where the next search starts."""

from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from staging import (
    NOBODY,
    PAPER,
    PERIOD_S,
    RIG,
    Stage,
    changed,
    exact,
    report,
    silhouettes,
    standing,
)

from calibration.gate import moved_cameras, rig_agreement, silhouette_motion
from common.body.observation import Box, Measure
from common.body.proportions import stature
from common.bus.instant import Instant
from common.bus.messages import Agreement, Guide, Lifting, View
from common.method import DEFAULT
from common.raster.silhouette_report import pack
from common.rig.camera import project
from integrator import belief, guidance, outgoing
from integrator.measuring.known_body import Measured
from integrator.merge_state import State
from integrator.person import Following, Sighting, Waiting
from integrator.rig.body_position import pixels_of, scales_at
from integrator.single.sight import Annotations

SCORES = (0.8, 0.7)
RAISED_M = np.array([0.0, 0.5, 0.0])
LOST_FRAMES = 5
"""A third of a second at the 15 frames a second of `state`."""
FRONT, SIDE = silhouettes(standing())


def seen(n: int, **said: Any) -> View:
    """Of viewer n, with its own place of the navel."""
    given = {"frame": 10 + n, "captured_s": 2.0, "clock_s": 5.0 + n, "root_px": (70.0 + n, 50.0)}
    return report(n, (FRONT, SIDE)[n - 1], **{**given, **said})


BOTH = Instant((seen(1), seen(2)))


@pytest.fixture
def state(monkeypatch: pytest.MonkeyPatch) -> State:
    """Somebody has stood before both for three frames, as printed."""
    exact(monkeypatch)
    stage = Stage(settings=PAPER)
    stage.show([standing((0.2, 0.1))] * 3)
    return stage.state._replace(number=41, frames=(11, 12), calibration=3)


@pytest.fixture
def person(state: State) -> Following:
    assert isinstance(state.person, Following)
    return state.person


def sighting(pair: Instant = BOTH, **more: Any) -> Sighting:
    return Sighting(pair, RIG, RIG, pair.detections, (0, 1), 0.1, **more)


def told(state: State, person: Following, pair: Instant = BOTH) -> Any:
    angles = np.linspace(1.0, 17.0, 17)
    return outgoing.body_of(state, person, sighting(pair), angles, SCORES)


def guide_of(state: State, person: Following, pair: Instant, settled_now: bool) -> Guide:
    return guidance.guide_of(state, person, sighting(pair), settled_now)


def test_a_body_is_of_its_instant_and_of_the_frames_that_it_was_made_of(
    state: State, person: Following
) -> None:
    body = told(state, person)
    assert (body.frame, body.captured_s, body.clock_s) == (41, 2.0, 7.0)
    assert (body.made_of, body.views, body.status) == ((11, 12), "both", "tracking")
    assert (body.calibration, body.scale_source) == (3, "calibrated")
    assert body.confidence == (0.8,) * 15
    assert body.score == SCORES
    assert body.pose[:3] == tuple(person.pose[:3])
    assert sorted(set(body.pose) & set(np.linspace(1.0, 17.0, 17))) == [*np.linspace(1.0, 17.0, 17)]
    assert body.angles_raw_deg != body.pose[-17:]
    assert len(body.extremities_m) == len(body.extremities_confidence) == 7
    alone = told(state, person, Instant((None, seen(2))))
    assert (alone.made_of, alone.views) == ((-1, 12), "2")
    assert told(state, person, Instant((seen(1), None))).views == "1"


def test_matches_of_both_viewers_and_of_their_sticks_are_counted(
    state: State, person: Following
) -> None:
    pair = Instant((seen(1, matches=30), seen(2, matches=12)))
    assert told(state, person, pair).matches == 42


@pytest.mark.parametrize(
    ("doubted", "status", "confidence"),
    [(0, "tracking", 0.8), (1, "predicted", 0.0), (4, "predicted", 0.0), (5, "lost", 0.0)],
)
def test_a_doubted_body_is_predicted_for_four_frames_and_then_has_no_pose(
    state: State, person: Following, doubted: int, status: str, confidence: float
) -> None:
    body = told(state, person._replace(doubted=doubted))
    assert body.status == status
    assert set(body.confidence) == {confidence}
    assert bool(body.joints_m) is (status != "lost")


def test_what_was_found_with_a_pose_goes_before_how_well_it_fits(
    state: State, person: Following
) -> None:
    own = np.linspace(0.1, 0.8, 15)
    person = person._replace(found=person.found._replace(confidence=own))
    assert told(state, person).confidence == tuple(own)


@pytest.mark.parametrize(
    ("pair", "trusts", "left"),
    [(BOTH, False, 0.25), (BOTH, True, 1.0), (Instant((seen(1), None)), False, 1.0)],
    ids=["both", "trusted", "one view"],
)
def test_a_rig_that_both_views_contradict_takes_confidence_away(
    state: State, person: Following, pair: Instant, trusts: bool, left: float
) -> None:
    doubts = rig_agreement.State(told=Agreement(70.0, 0.0, 0.0, 10.0, 0.25))
    settings = msgspec.structs.replace(state.settings, trust_calibration=trusts)
    body = told(state._replace(agreement=doubts, settings=settings), person, pair)
    assert body.confidence == pytest.approx([0.8 * left] * 15)


def test_joints_that_the_only_picture_cuts_off_are_guessed(state: State, person: Following) -> None:
    """The lower half is outside; of two views the other may show it."""
    high = RIG.height // 2
    cut = changed(seen(1, cut=True), height=high)
    body = told(state, person, Instant((cut, None)))
    below = [place[1] > high for place in body.joints_px[0]]
    assert 2 < sum(below) < 12
    assert [sure == 0.0 for sure in body.confidence] == below
    assert {body.status, told(state, person, Instant((cut, seen(2)))).status} == {"tracking"}
    assert 0.0 not in told(state, person, Instant((cut, seen(2)))).confidence


@pytest.mark.parametrize(
    ("annotated", "believed"), [(False, True), (True, False)], ids=["borne out", "placed by hand"]
)
def test_a_body_that_is_believed_is_doubted_no_more(
    state: State,
    person: Following,
    monkeypatch: pytest.MonkeyPatch,
    annotated: bool,
    believed: bool,
) -> None:
    monkeypatch.setattr(belief, "is_believed", lambda *_: believed)
    notes = Annotations(joints_px={"l_wrist": (3.0, 4.0)} if annotated else {})
    person = person._replace(doubted=3, ever_confirmed=False)
    after = belief.weighed(person, sighting(annotations=notes), SCORES, PERIOD_S)
    assert (after.doubted, after.ever_confirmed) == (0, True)


def test_what_the_network_remembers_of_a_body_that_both_lost_is_forgotten_every_five_frames(
    person: Following, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(belief, "is_believed", lambda *_: False)
    memory: Any = object()
    found = person.found._replace(memory=memory)
    person = person._replace(found=found, doubted=0, ever_confirmed=False)
    kept = []
    for _ in range(2 * LOST_FRAMES):
        person = belief.weighed(person, sighting(), SCORES, PERIOD_S)
        kept.append(person.found.memory is memory)
        person = person._replace(found=found)
    assert person.doubted == 2 * LOST_FRAMES
    assert kept == [True, True, True, True, False] * 2


@pytest.mark.parametrize(("ever_confirmed", "doubted"), [(True, 1), (False, LOST_FRAMES)])
def test_one_view_keeps_what_it_remembers_and_loses_at_once_who_it_never_met(
    state: State,
    person: Following,
    monkeypatch: pytest.MonkeyPatch,
    ever_confirmed: bool,
    doubted: int,
) -> None:
    monkeypatch.setattr(belief, "is_believed", lambda *_: False)
    memory, alone = object(), object()
    found = person.found._replace(memory=memory, alone=alone)  # type: ignore[arg-type]
    person = person._replace(found=found, ever_confirmed=ever_confirmed)
    after = belief.weighed(person, sighting(Instant((seen(1), None))), SCORES, PERIOD_S)
    assert after.doubted == doubted
    assert after.found.memory is memory


def test_as_printed_each_viewer_starts_where_it_had_the_body_itself(
    state: State, person: Following
) -> None:
    guide = guide_of(state, person, BOTH, False)
    assert guide.root_px == ((71.0, 50.0), (72.0, 50.0))
    assert (guide.frame, guide.clock_s, guide.frames) == (41, 7.0, (11, 12))
    place = person.pose[:3]
    shared = pixels_of(RIG, place)
    assert guide_of(state, person, Instant((seen(1), None)), False).root_px == (
        (71.0, 50.0),
        shared[1],
    )
    assert guide_of(state, person, BOTH, True).root_px == shared, "the body has just been measured"
    assert guide_of(state._replace(method=DEFAULT), person, BOTH, False).root_px == shared


def test_a_guide_tells_the_size_of_a_metre_and_the_row_of_who_stands_upright(
    state: State, person: Following
) -> None:
    """By how the body was measured, where it was: 1.1 m high, 0.3 m nearer to camera 1."""
    guide = guide_of(state, person, BOTH, False)
    place = person.pose[:3]
    assert guide.scale_px_per_m == pytest.approx(scales_at(RIG, place))
    assert guide.pose == tuple(person.pose)
    assert guide.rest_row_px == pytest.approx([at[1] for at in pixels_of(RIG, place)])
    known = Measured(person.body.bdp, (0.0, 1.1, 0.3))
    later = guide_of(state, person._replace(body=known), BOTH, False)
    raised = pixels_of(RIG, np.array([place[0], 1.1, place[2]]))
    assert later.rest_row_px == pytest.approx([at[1] for at in raised])
    assert later.measured
    assert later.scale_px_per_m == pytest.approx(scales_at(RIG, place), rel=1e-6)


@pytest.mark.parametrize(
    ("stick", "source", "asked"),
    [(True, "assumed", True), (True, "calibrated", False), (False, "assumed", False)],
)
def test_a_stick_is_asked_of_one_view_that_fits_badly_by_an_assumed_rig(
    state: State, person: Following, stick: bool, source: Any, asked: bool
) -> None:
    assert not guide_of(state._replace(scale_source="assumed"), person, BOTH, False).stick

    class Alone:
        """One view that wants a stick, or not."""

    alone: Any = Alone()
    alone.stick = stick
    state = state._replace(scale_source=source)
    person = person._replace(found=person.found._replace(alone=alone))
    assert guide_of(state, person, Instant((seen(1), None)), False).stick is asked


def test_where_nobody_is_the_lengths_and_the_facing_are_kept(
    state: State, person: Following
) -> None:
    empty = Instant((report(1, NOBODY, frame=11), None))
    waiting = Waiting(person.body)
    state = state._replace(facing=("flank", "facade"), proposes=True, person=waiting)
    body, guide = outgoing.no_person(state, empty), guidance.no_person(state, empty)
    assert (body.status, body.views, body.joints_m, body.made_of) == ("empty", "none", (), (11, -1))
    assert (body.facing, guide.facing) == (state.facing,) * 2
    assert body.bdp == guide.bdp == person.body.bdp
    assert (body.calibration, body.scale_source) == (3, "calibrated")
    assert (guide.frames, guide.status, guide.proposes) == ((11, 12), "empty", True)
    assert not guide.measured


def test_what_else_is_told_of_an_instant_is_what_the_state_knows(
    state: State, person: Following
) -> None:
    """Cameras that moved, motion, what one view decided, whose picture is none is at -1."""
    stands = moved_cameras.MovedCameras(unconfirmed=(2,))
    lifting = Lifting("left", 0.9, (0.5,) * 10)
    alone: Any = SimpleNamespace(lifting=lifting, stick=False)
    known = state._replace(stands=stands)
    one = person._replace(found=person.found._replace(alone=alone))
    body = told(known, one, Instant((None, seen(2))))
    assert (body.moved, body.lifting) == ((2,), lifting)
    assert told(state, person).lifting is None
    assert body.confidence == pytest.approx([0.4] * 15), "half of it is left"
    agreed = rig_agreement.State(told=Agreement(70.0, 0.0, 0.0, 10.0, 0.7))
    assert told(known._replace(agreement=agreed), one).confidence == pytest.approx([0.4] * 15)
    assert told(known._replace(agreement=agreed), one).agreement == agreed.told
    assert told(known._replace(agreement=agreed), one, Instant((None, seen(2)))).agreement is None
    half_s = [seen(1, captured_s=at_s) for at_s in (0.0, 0.5)]
    moved = changed(half_s[1], silhouette=pack(NOBODY), area_px=90)
    motion = silhouette_motion.init(2)
    for each in (half_s[0], moved):
        motion = silhouette_motion.step(
            motion, Instant((None, msgspec.structs.replace(each, viewer=2)))
        )
    assert guide_of(state._replace(motion=motion), person, BOTH, False).moves == (False, True)
    empty = outgoing.no_person(known, Instant((report(1, NOBODY), None)))
    assert empty.moved == (2,)
    behind = outgoing.filed_pixels(np.array([[np.nan, np.nan], [3.0, 4.0]]), None)
    assert behind == ((-1.0, -1.0), (3.0, 4.0))


def test_scales_of_a_camera_that_has_the_body_behind_it_are_none() -> None:
    for bad in (-3.0, float("nan"), float("inf"), 0.0):
        assert guidance._or_unseen((bad, 50.0)) == (0.0, 50.0)
        assert guidance._or_unseen((60.0, bad)) == (60.0, 0.0)


def test_extremities_are_as_sure_as_they_are_seen_and_the_rig_is_believed(
    state: State, person: Following, monkeypatch: pytest.MonkeyPatch
) -> None:
    sure = np.linspace(0.1, 0.7, 7)
    asked: list[Any] = []

    def seen_ends(ends_m: Any, rig: Any, given: Any, stature_m: float) -> Any:
        asked.append((rig, given, stature_m))
        return ends_m + RAISED_M, sure

    ruled = np.array(told(state, person).extremities_m)
    monkeypatch.setattr(outgoing, "seen_extremities", seen_ends)
    stands = moved_cameras.MovedCameras(unconfirmed=(1,))
    body = told(state._replace(stands=stands), person)
    assert body.extremities_confidence == pytest.approx(0.5 * sure)
    assert np.array(body.extremities_m) == pytest.approx(ruled + RAISED_M)
    for camera, pixels in zip(RIG.cameras, body.extremities_px, strict=True):
        assert np.array(pixels) == pytest.approx(project(camera, np.array(body.extremities_m)))
    assert asked == [(RIG, BOTH.detections, stature(person.body.bdp))]
    doubted = told(state, person._replace(doubted=1))
    assert doubted.extremities_confidence == (0.0,) * 7
    assert np.array(doubted.extremities_m) == pytest.approx(ruled)
    assert len(asked) == 1


@pytest.mark.parametrize(
    ("box", "said"),
    [
        (Box(10, 40, 0, 90), "step back"),
        (Box(10, 40, 20, 119), "step back"),
        (Box(0, 40, 20, 90), "step towards its middle"),
        (Box(0, 40, 20, 119), "step back"),
    ],
    ids=["head", "feet", "side", "corner"],
)
def test_a_person_partly_outside_a_picture_is_asked_back_into_it(box: Box, said: str) -> None:
    """However they are followed, and by the camera that cuts them off alone."""
    cut = changed(seen(1), cut=True, box=box).person
    advice = outgoing.advice_of((cut, seen(2).person), ("facade", "flank"), "tracking")
    assert advice == (f"partly outside the picture: {said}", "")


def test_what_is_wrong_with_the_opening_posture_is_said_where_the_facade_is_seen() -> None:
    """Before a camera at the side the same silhouette is the posture's flank; once the body is
    measured nothing is wrong."""
    lowered = "the arms are not stretched out to the sides"
    side = Measure(height_px=80.0, centre_px=(70.0, 20.0), depth_px=9.0)
    people = tuple(changed(seen(n), refusal=lowered, measure=side).person for n in (1, 2))
    assert outgoing.advice_of(people, ("facade", "flank"), "measuring") == (lowered, "")
    assert outgoing.advice_of(people, ("flank", "facade"), "measuring") == ("", lowered)
    assert outgoing.advice_of(people, ("facade", "flank"), "tracking") == ()
    touched = changed(seen(2), refusal="stand apart", measure=None).person
    assert outgoing.advice_of((None, touched), ("facade", "flank"), "measuring") == (
        "",
        "stand apart",
    )


def test_a_body_carries_the_advice_to_its_person(state: State, person: Following) -> None:
    assert told(state, person, BOTH).advice == ()
    cut = changed(seen(1, cut=True), box=Box(0, 40, 20, 90))
    advice = told(state, person, Instant((cut, seen(2)))).advice
    assert advice == ("partly outside the picture: step towards its middle", "")


def test_only_the_view_that_is_alone_and_cut_says_what_is_outside(state: State) -> None:
    """Camera 2 alone: what lies left of its picture's border, or right of it."""
    first_px, second_px = np.full((15, 2), 50.0), np.full((15, 2), 50.0)
    second_px[3], second_px[4], second_px[5] = (-0.1, 50.0), (160.1, 50.0), (80.0, 120.1)
    second_px[6], second_px[7], second_px[8] = (0.0, 50.0), (160.0, 120.0), (80.0, -0.1)
    first_px[9] = (-3.0, 7.0)
    pixels = first_px, second_px
    outside = [n in (3, 4, 5, 8) for n in range(15)]
    assert outgoing._outside(Instant((None, seen(2, cut=True))), pixels).tolist() == outside
    first_only = outgoing._outside(Instant((seen(1, cut=True), None)), pixels)
    assert first_only.tolist() == [n == 9 for n in range(15)]
    for whole in (
        Instant((None, seen(2))),
        Instant((seen(1, cut=True), seen(2, cut=True))),
        Instant((report(1, NOBODY), None)),
    ):
        assert not outgoing._outside(whole, pixels).any()


@pytest.mark.parametrize(
    ("seen_by", "says"),
    [("11", "both"), ("10", "1"), ("01", "2"), ("00", "none"), ("1", "1"), ("101", "1+3")],
)
def test_of_two_cameras_a_word_says_who_sees_the_person_and_of_more_their_numbers(
    seen_by: str, says: str
) -> None:
    person = seen(1).person
    assert outgoing._views(tuple(person if one == "1" else None for one in seen_by)) == says


def test_matches_of_a_stick_count_with_those_of_its_viewer() -> None:
    fit: Any = SimpleNamespace(matches=7)
    one: Any = SimpleNamespace(search=SimpleNamespace(matches=30), stick=fit)
    assert outgoing._matches(one) == 37
    one.stick = None
    assert outgoing._matches(one) == 30
    one.search = None
    assert outgoing._matches(one) == 0


@pytest.mark.parametrize(("rate_hz", "frames"), [(15.0, 5), (30.0, 10), (10.0, 3), (1.0, 1)])
def test_a_body_is_lost_after_a_third_of_a_second_at_any_rate(rate_hz: float, frames: int) -> None:
    assert belief.lost_frames(1.0 / rate_hz) == frames
