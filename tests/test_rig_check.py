"""What a run says of its calibration."""

from typing import Any

import msgspec
import pytest
from staging import RIG, report

from calibration.gate.pair_trust import PairTrust
from calibration.gate.rig_trust import Trust
from calibration.tracks.lateness import UNSEEN, Clock
from common.body.observation import Box, Landmarks
from common.bus.messages import Body, View, ViewerNumber
from common.video.clip_facts import Clip, ClipView, Meta
from runtime.offline import rig_check
from runtime.offline.rig_check import (
    DOUBTED,
    Witness,
    clock_facts,
    clock_words,
    clocks_seen,
    doubted,
    doubts,
    late_by,
    trust_facts,
)

TRUST: dict[str, Any] = {
    "apart_mm": 61.4,
    "apart_px": 2.6,
    "soles_mm": -80.2,
    "stature_m": 1.86,
    "late_frames": 0.2,
    "facing_deg": 3.2,
    "motion_mm": 21.4,
    "advice": "camera 2 seems turned by 8 degrees against camera 1: calibrate again",
}


@pytest.mark.parametrize("facts", [{}, {"trust": {**TRUST, "advice": ""}}])
def test_a_run_that_is_believable_or_cannot_tell_says_nothing(facts: dict[str, Any]) -> None:
    assert doubts(facts) == []


def test_a_run_that_is_not_believable_says_what_is_wrong_and_what_to_do_in_one_line() -> None:
    (told,) = doubts({"trust": TRUST})
    assert "views 61 mm (2.6 px) apart, soles -80 mm over the floor" in told
    assert "facings 3 degrees apart, motions 21 mm" in told
    assert "camera 2 seems turned by 8 degrees against camera 1: calibrate again" in told


def two_views(late_s: float = 0.0) -> Clip:
    size = (160, 120)
    views = tuple(
        ClipView(number, f"cam{number}.avi", size, size, 15.0, 60, late_s=late_s * (number == 2))
        for number in (1, 2)
    )
    return Clip("late", views, 1, None, Meta())


def test_a_clock_that_was_set_is_told_with_the_seconds() -> None:
    facts = clock_facts(two_views(-0.4), (Clock(-0.4),), {})
    assert facts == {
        "clock": {"state": "found", "applied_s": -0.4, "may_be_s": [], "may_be_on_time": True}
    }
    assert clock_words(facts) == ["view 2 is -0.40 s late: its times were set back by that"]


def test_a_clock_that_is_right_or_shown_by_nobody_is_not_spoken_of() -> None:
    assert clock_words(clock_facts(two_views(), (Clock(0.02),), {})) == []
    assert clock_words(clock_facts(two_views(), (UNSEEN,), {})) == []
    assert clock_words({}) == []


def test_a_gait_that_repeats_itself_is_said_with_all_that_may_be() -> None:
    facts = clock_facts(two_views(), (Clock(0.5, (-0.5, 1.5), False),), {})
    assert facts["clock"]["may_be_s"] == [-0.5, 0.5, 1.5]
    (word,) = clock_words(facts)
    assert "(-0.50, +0.50, +1.50 s)" in word
    assert "hardly believed; say it by --offset SECONDS" in word
    on_time = clock_facts(two_views(), (Clock(0.5, (0.0,)),), {})
    assert on_time["clock"]["may_be_s"] == [0.0, 0.5]
    assert clock_words(on_time) == [], "a good walk is no reason for a warning"


def test_an_offset_that_is_given_is_not_ambiguous() -> None:
    facts = clock_facts(two_views(0.5), (Clock(0.0, (1.0,)),), {2: 0.5})
    assert facts == {
        "clock": {"state": "given", "applied_s": 0.5, "may_be_s": [], "may_be_on_time": True}
    }


@pytest.mark.parametrize(
    ("clock", "late"),
    [
        (Clock(0.06), True),
        (Clock(-0.06), True),
        (Clock(0.04), False),
        (Clock(2.0, (3.0,)), False),
        (UNSEEN, False),
    ],
)
def test_a_clip_is_tracked_again_where_its_clock_is_found_to_be_off(
    clock: Clock, late: bool
) -> None:
    assert any(late_by(two_views(), (clock,), {})) is late
    assert late_by(two_views(), (clock,), {2: 0.1}) == (0.0,), "the user said it"


def test_bodies_of_a_view_that_is_late_by_nobody_knows_how_much_are_hardly_believed() -> None:
    body = Body(
        frame=0, captured_s=0.0, clock_s=0.0, status="tracking", views="both", confidence=(0.9, 0.4)
    )
    unknown = (Clock(1.0, (2.0,), False),)
    (left,) = doubted([body], two_views(), unknown, {})
    assert left.confidence == pytest.approx((0.9 * DOUBTED, 0.4 * DOUBTED))
    assert doubted([body], two_views(), (Clock(1.0, (0.1,)),), {}) == [body]
    assert doubted([body], two_views(), (UNSEEN,), {}) == [body]
    assert doubted([body], two_views(), (Clock(0.05, (), False),), {}) == [body], (
        "found, and less than a frame"
    )
    assert doubted([body], two_views(), unknown, {2: 1.0}) == [body], "the user said it"


LANDMARKS = Landmarks(tuple((40.0 + 3 * n, 100.0 - 5 * n) for n in range(15)), (0.8,) * 15, 30.0)


def seen_at(viewer: ViewerNumber, moment_s: float) -> View:
    """A report of somebody upright, at that moment."""
    box = Box(left=30, right=90, top=10, bottom=110)
    return report(viewer, captured_s=moment_s, box=box, landmarks=LANDMARKS)


def body_with(moved: tuple[ViewerNumber, ...] = ()) -> Body:
    return Body(frame=0, captured_s=0.0, clock_s=0.0, status="tracking", views="both", moved=moved)


def test_what_both_views_see_is_kept_until_a_camera_is_moved() -> None:
    """View 2 misses the second instant; from the fourth on nothing is kept, moved or no more."""
    witness = Witness()
    witness({}, {1: seen_at(1, 0.0), 2: seen_at(2, 0.02)}, body_with())
    witness({}, {1: seen_at(1, 0.1)}, body_with())
    witness({}, {1: seen_at(1, 0.2), 2: seen_at(2, 0.22)}, body_with())
    witness({}, {1: seen_at(1, 0.3), 2: seen_at(2, 0.32)}, body_with((2,)))
    witness({}, {1: seen_at(1, 0.4), 2: seen_at(2, 0.42)}, body_with())
    (sighting,) = witness.sightings(two_views())
    (first, second), size_px = sighting
    assert first.times_s.tolist() == [0.0, 0.1, 0.2]
    assert second.times_s.tolist() == [0.02, 0.22]
    assert size_px == (160, 120)
    assert second.joints_px[1].tolist() == [list(place) for place in LANDMARKS.joints_px]


def test_of_a_long_run_its_first_frames_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    assert rig_check.MOST_FRAMES == 3000
    monkeypatch.setattr(rig_check, "MOST_FRAMES", 3)
    witness = Witness()
    for n in range(5):
        witness({}, {1: seen_at(1, n / 10)} if n else {2: seen_at(2, 0.0)}, body_with())
    (sighting,) = witness.sightings(two_views())
    (first, second), _ = sighting
    assert first.times_s.tolist() == [0.1, 0.2, 0.3]
    assert second.times_s.tolist() == [0.0]


def test_one_view_has_no_clock_to_be_held_against(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rig_check, "clocks_of", lambda seen: (Clock(seen.size_px[0] / 100),))
    both = two_views()
    alone = msgspec.structs.replace(both, views=both.views[:1])
    assert clocks_seen(both, Witness()) == (Clock(1.6),)
    assert clocks_seen(alone, Witness()) == ()


def test_a_clock_is_off_by_frames_that_are_looked_at() -> None:
    """Every third of 15 a second are 0.2 s apart: three quarters are 0.15 s, and no more."""
    clip = msgspec.structs.replace(two_views(), every=3)
    assert any(late_by(clip, (Clock(0.16),), {}))
    assert any(late_by(clip, (Clock(-0.16),), {}))
    assert not any(late_by(clip, (Clock(0.14),), {}))
    fast = msgspec.structs.replace(clip.views[1], fps=90.0)
    clip = msgspec.structs.replace(clip, views=(clip.views[0], fast))
    assert not any(late_by(clip, (Clock(0.14),), {})), "the rate is view 1's"


class Asked:
    """Who judges a rig; remembers what it is asked by."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, found: Trust | None) -> None:
        self.by: list[tuple[Any, ...]] = []
        self.found = found
        monkeypatch.setattr("calibration.gate.pair_trust.trust_of", self.trust_of)
        monkeypatch.setattr("calibration.gate.pair_trust.advice_on", self.advice_on)

    def trust_of(self, *given: Any) -> Trust | None:
        self.by.append(given)
        return self.found

    def advice_on(self, *given: Any) -> str:
        self.by.append(given)
        return "turn it"


def witnessed(*moments_s: float) -> Witness:
    witness = Witness()
    for moment_s in moments_s:
        witness({}, {1: seen_at(1, moment_s), 2: seen_at(2, moment_s)}, body_with())
    return witness


def test_a_rig_is_judged_by_what_was_seen_and_advised_unless_it_is_insisted_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = Trust(believed=False, moments=80, odd=("late",), **{**TRUST, "advice": ""})
    clip = msgspec.structs.replace(two_views(0.5), rig=RIG, every=2)
    clock, witness = Clock(0.3), witnessed(0.0, 0.1)
    asked = Asked(monkeypatch, found)
    told = trust_facts(clip, witness, (clock,), insisted=False)
    assert told == {"trust": {**msgspec.to_builtins(found), "advice": "turn it"}}
    (rig, sighting, period_s, by), advised = asked.by
    assert (rig, period_s, by) == (RIG, pytest.approx(2 / 15), clock)
    assert sighting.second.times_s.tolist() == [0.0, 0.1]
    assert advised[:1] + advised[2:] == (RIG, period_s, found, clock, 0.5)
    assert advised[1].first.times_s.tolist() == [0.0, 0.1]
    asked.by.clear()
    different = trust_facts(clip, witness, (clock,), insisted=False, different_people=True)
    assert different == {}
    asked.by.clear()
    assert trust_facts(clip, witness, (clock,), insisted=True) == {
        "trust": msgspec.to_builtins(found)
    }
    assert len(asked.by) == 1


def witnessed_people(*instants: int) -> Witness:
    """People seen in so many instants of both views, the first with number 1."""
    witness = Witness()
    for person, count in enumerate(instants, 1):
        body = msgspec.structs.replace(body_with(), person=person)
        for n in range(count):
            witness({}, {1: seen_at(1, n / 10), 2: seen_at(2, n / 10)}, body)
    return witness


def test_each_person_is_evidence_of_their_own_whoever_was_seen_longest_first() -> None:
    """Who was seen half as long as that one counts, who was seen for less does not."""
    each = witnessed_people(2, 8, 4, 3).sightings(two_views())
    assert [len(seen.tracks[0].times_s) for seen in each] == [8, 4]


def test_of_very_many_people_those_are_kept_who_were_seen_longest_and_the_last(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(rig_check, "MOST_PEOPLE", 3)
    assert sorted(witnessed_people(2, 8, 4, 3, 1).seen.rows) == [2, 3, 5]


def test_who_was_never_seen_in_a_view_is_no_evidence_and_no_error() -> None:
    clip, witness = msgspec.structs.replace(two_views(), rig=RIG), Witness()
    for n in range(3):
        witness({}, {2: seen_at(2, n / 10)}, body_with())
    assert trust_facts(clip, witness, (Clock(0.0),), insisted=False) == {}


@pytest.mark.parametrize(
    ("believe", "believed", "instants"),
    [
        ((False, False), False, 8),
        ((False, True), True, 6),
        ((True, False), True, 8),
        ((None, False), False, 6),
    ],
)
def test_a_rig_is_wrong_where_it_contradicts_everybody(
    monkeypatch: pytest.MonkeyPatch,
    believe: tuple[bool | None, bool],
    believed: bool,
    instants: int,
) -> None:
    """A mistake about who is who in a view contradicts one of them alone; advice is by the person
    seen longest who could be judged."""
    by_instants = dict(zip((8, 6), believe, strict=True))
    advised: list[int] = []

    def least(_rig: Any, seen: Any, *_: Any) -> PairTrust | None:
        own = by_instants[len(seen.tracks[0].times_s)]
        trust = (
            None
            if own is None
            else Trust(believed=own, moments=80, odd=(), **{**TRUST, "advice": ""})
        )
        return None if trust is None else PairTrust(0, 1, trust)

    def advice(_found: Any, _rig: Any, seen: Any, *_: Any) -> str:
        advised.append(len(seen.tracks[0].times_s))
        return ""

    monkeypatch.setattr("calibration.gate.pair_trust.least_believed", least)
    monkeypatch.setattr("calibration.gate.pair_trust.advice_of", advice)
    clip = msgspec.structs.replace(two_views(), rig=RIG)
    facts = trust_facts(clip, witnessed_people(6, 8), (Clock(0.0),), insisted=False)
    assert facts["trust"]["believed"] is believed
    assert advised == [instants]


def test_a_rig_of_which_too_little_is_seen_is_not_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    clip, seen = msgspec.structs.replace(two_views(), rig=RIG), witnessed(0.0, 0.1)
    asked = Asked(monkeypatch, None)
    alone = msgspec.structs.replace(clip, views=clip.views[:1])
    for such, witness in ((two_views(), seen), (alone, seen), (clip, witnessed(0.0))):
        assert trust_facts(such, witness, (Clock(0.0),), insisted=False) == {}
    assert asked.by == []
    assert trust_facts(clip, seen, (Clock(0.0),), insisted=False) == {}
    assert len(asked.by) == 1, "no advice on what could not be judged"


def test_one_view_tells_nothing_of_a_clock() -> None:
    both = two_views(0.3)
    assert clock_facts(msgspec.structs.replace(both, views=both.views[:1]), (), {}) == {}


def test_times_in_the_summary_are_rounded_to_what_is_known_of_them() -> None:
    facts = clock_facts(two_views(0.123456), (Clock(-0.001, (2.3449, 1.2351), False),), {})
    assert facts == {
        "clock": {
            "state": "ambiguous",
            "applied_s": 0.1235,
            "may_be_s": [0.0, 1.24, 2.34],
            "may_be_on_time": False,
        }
    }
    assert str(facts["clock"]["may_be_s"][0]) == "0.0", "not -0.0"
    unknown = clock_facts(two_views(), (UNSEEN,), {})["clock"]
    assert (unknown["state"], unknown["may_be_on_time"]) == ("unknown", True)


def three_views() -> Clip:
    third = ClipView(3, "cam3.avi", (160, 120), (160, 120), 15.0, 60, name="door")
    pair = two_views()
    return msgspec.structs.replace(pair, views=(*pair.views, third))


def test_of_three_cameras_each_has_a_clock_of_its_own() -> None:
    """Camera 3 is late, the clock of camera 2 is given."""
    three = three_views()
    clocks = (Clock(0.4), Clock(-0.3))
    assert late_by(three, clocks, {2: 0.4}) == (0.0, -0.3)
    set_by = msgspec.structs.replace(three.views[2], late_s=-0.3)
    later = msgspec.structs.replace(three, views=(*three.views[:2], set_by))
    facts = clock_facts(later, clocks, {2: 0.0})
    assert [*facts] == ["clocks"]
    assert [*facts["clocks"]] == ["cam2", "door"]
    assert [each["state"] for each in facts["clocks"].values()] == ["given", "found"]
    assert clock_words(facts) == ["door is -0.30 s late: its times were set back by that"]
    unknown = (Clock(0.0), Clock(1.0, (2.0,), False))
    (word,) = clock_words(clock_facts(three, unknown, {}))
    assert word.startswith("how late door is, the motion does not show")
    assert word.endswith("say it by cameras.door.offset_s in the settings")
    body = msgspec.structs.replace(body_with(), confidence=(0.8,))
    (left,) = doubted([body], three, unknown, {})
    assert left.confidence == pytest.approx((0.8 * DOUBTED,))


def test_of_three_cameras_the_pair_is_told_that_is_believed_least(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = Trust(believed=False, moments=80, odd=("apart",), **{**TRUST, "advice": ""})
    asked: list[Any] = []

    def least(rig: Any, seen: Any, *_: Any) -> PairTrust:
        asked.append(([camera.name for camera in rig.cameras], len(seen.tracks)))
        return PairTrust(0, 2, found)

    monkeypatch.setattr("calibration.gate.pair_trust.least_believed", least)
    monkeypatch.setattr("calibration.gate.pair_trust.advice_of", lambda *_: "turn the door's")
    rig = msgspec.structs.replace(RIG, cameras=(*RIG.cameras, RIG.cameras[0]))
    three, witness = msgspec.structs.replace(three_views(), rig=rig), Witness()
    for moment_s in (0.0, 0.1):
        witness({}, {n: seen_at(n, moment_s) for n in (1, 2, 3)}, body_with())
    facts = trust_facts(three, witness, (Clock(0.0), Clock(0.0)), insisted=False)
    assert asked == [(["cam1", "cam2", "door"], 3)]
    assert facts["trust"]["cameras"] == ["cam1", "door"]
    (said,) = doubts(facts)
    assert "cam1 and door 61 mm" in said
    assert "door +0.2 frames late; turn the door's" in said


def test_two_of_several_cameras_are_held_against_each_other_whatever_their_numbers() -> None:
    first, _ = two_views().views
    third = ClipView(3, "cam3.avi", (160, 120), (160, 120), 15.0, 60)
    witness = Witness()
    witness({}, {1: seen_at(1, 0.1), 3: seen_at(3, 0.3)}, body_with())
    clip = msgspec.structs.replace(two_views(), views=(first, third))
    (sighting,) = witness.sightings(clip)
    assert [track.times_s.tolist() for track in sighting.tracks] == [[0.1], [0.3]]
