"""What is odd about a performance, a line each."""

from collections.abc import Collection

import msgspec
import numpy as np
import pytest
from staging import report as staged

from calibration.gate import rig_agreement
from common.body.proportions import thesis_bdp
from common.bus.instant import Instant
from common.bus.messages import Agreement, ScaleSource, View
from common.config.part_settings import BodySettings
from common.config.settings import Settings
from common.method import DEFAULT
from common.rig.camera import paper_rig
from integrator import diagnostics, merge_state
from integrator.diagnostics import DOUBTED, Present
from integrator.measuring.known_body import Measured, Unknown
from integrator.person import Waiting
from integrator.rig import same_person

RIG = paper_rig((160, 120), (200.0, 200.0), (4.5, 4.5))


def report(viewer: int, seen: bool = True, cut: bool = False) -> View:
    return staged(viewer, np.full((1, 8), seen), cut=cut)


def noticed(*pairs: Instant, measured: bool = True) -> diagnostics.State:
    """Of a run that follows one person."""
    state = diagnostics.State()
    for pair in pairs:
        state = diagnostics.step(state, pair, [Present(0, pair.detections, measured)])
    return state


def of_several(*shown: dict[int, Instant], measured: Collection[int] = ()) -> diagnostics.State:
    """Of a run that follows several, each instant by the number of the person whom it shows."""
    state = diagnostics.State()
    for each in shown:
        people = [Present(n, own.detections, n in measured) for n, own in each.items()]
        state = diagnostics.step(state, next(iter(each.values())), people)
    return state


def merged(calibrated: bool = True, measured: bool = True) -> merge_state.State:
    state = merge_state.init(
        RIG if calibrated else None, 1 / 15, Settings(body=BodySettings(stature_m=1.62)), DEFAULT
    )
    body = Measured(thesis_bdp(1.75), (0.0, 1.0, 0.0)) if measured else Unknown()
    return state._replace(person=Waiting(body))


def test_a_good_performance_is_not_odd() -> None:
    assert diagnostics.warnings(noticed(Instant((report(1), report(2)))), merged()) == []


def test_without_calibration_the_assumed_stature_is_named_from_the_start() -> None:
    (told,) = diagnostics.assumed(merged(calibrated=False))
    assert "no calibration" in told
    assert "1.62 m" in told
    assert "tritrack calibrate person" in told
    assert diagnostics.warnings(diagnostics.State(), merged(calibrated=False)) == [told]


def test_proportions_that_were_not_measured_are_the_theses() -> None:
    seen = noticed(Instant((report(1), None)), measured=False)
    (told,) = diagnostics.warnings(seen, merged(measured=False))
    assert told.startswith("nobody took the opening posture")
    assert "thesis's proportions" in told


def test_of_several_people_those_who_were_not_measured_are_named() -> None:
    both = Instant((report(1), report(2)))
    shown = of_several({1: both, 2: both, 4: both}, {2: both}, measured=[2])
    (told,) = diagnostics.warnings(shown, merged(measured=False))
    assert told.startswith("persons 1 and 4 did not take the opening posture")
    all_of_them = of_several({1: both, 2: both}, measured=[1, 2])
    assert diagnostics.warnings(all_of_them, merged(measured=False)) == []


def test_of_several_people_each_who_is_cut_off_is_counted_by_viewer() -> None:
    whole, cut = Instant((report(1), report(2))), Instant((report(1), report(2, cut=True)))
    hidden = Instant((report(1), report(2, seen=False)))
    shown = of_several({1: whole, 2: cut}, {1: cut, 2: cut}, {1: whole, 2: hidden}, measured=[1, 2])
    assert diagnostics.warnings(shown, merged()) == [
        "viewer 2 saw person 1 partly outside its picture in 1 of 3 frames, "
        "person 2 partly outside its picture in 2 of 2 frames: what is outside is guessed"
    ]


def test_no_more_than_the_first_twenty_people_are_kept() -> None:
    both = Instant((report(1), report(2)))
    shown = of_several(*({n: both} for n in range(1, 40)), {3: both})
    assert [one.number for one in shown.people] == list(range(1, 21))
    assert shown.people[2].seen == (2, 2)


def test_pictures_that_showed_no_scene_are_told_with_their_kind_and_time() -> None:
    faults = ("", "frozen", "frozen", "", "black")
    seen = [
        msgspec.structs.replace(report(2, seen=not fault), fault=fault, captured_s=40.0 + n)
        for n, fault in enumerate(faults)
    ]
    (told,) = diagnostics.warnings(
        noticed(*(Instant((report(1), each)) for each in seen)), merged()
    )
    assert told.startswith(
        "the picture of camera 2 is black or frozen in 3 frames, first at 41.0 s"
    )


def test_an_empty_room_misses_no_opening_posture() -> None:
    empty = Instant((report(1, seen=False), report(2, seen=False)))
    nobody = noticed(empty, measured=False)
    assert diagnostics.warnings(nobody, merged(measured=False)) == []


def test_a_person_partly_outside_is_counted_by_viewer() -> None:
    pairs = [Instant((report(1), report(2, cut=n < 3))) for n in range(10)] + [
        Instant((report(1), None))
    ]
    assert diagnostics.warnings(noticed(*pairs), merged()) == [
        "viewer 2 saw the person partly outside its picture in 3 of 10 frames: "
        "what is outside is guessed"
    ]


def test_each_way_to_be_without_a_calibration_is_named() -> None:
    plain = merged()
    assumed, person = (
        diagnostics.assumed(plain._replace(scale_source=source)) for source in ("assumed", "person")
    )
    assert diagnostics.assumed(plain) == []
    assert "a rig of the paper's kind is assumed" in assumed[0]
    assert "calibrated by the person" in person[0]


@pytest.mark.parametrize("source", ["calibrated", "person", "assumed"])
@pytest.mark.parametrize("trusts", [True, False])
@pytest.mark.parametrize("by", [-0.01, 0.01])
def test_a_rig_is_doubted_that_both_views_contradict_and_the_user_does_not_insist_on(
    source: ScaleSource, trusts: bool, by: float
) -> None:
    """A rig that was assumed is known to be wrong."""
    told = Agreement(
        motion_mm=0.0, apart_mm=91.0, soles_mm=-12.0, facing_deg=33.0, believed=DOUBTED + by
    )
    settings = Settings(trust_calibration=trusts)
    state = merged()._replace(scale_source=source, settings=settings)
    said = diagnostics.doubt(state._replace(agreement=rig_agreement.State(told=told)))
    doubted = source != "assumed" and not trusts and by < 0.0
    assert bool(said) == doubted
    if doubted:
        assert "91 mm apart" in said
        assert "-12 mm over the floor" in said
        assert "33 degrees" in said
    assert diagnostics.doubt(state) == ""


def test_views_that_followed_different_people_are_named_with_the_time_and_the_frames() -> None:
    assert diagnostics.different_people(merged()) == []
    same = same_person.State(left_out=(0, 12), since_s=1.33)
    (told,) = diagnostics.warnings(diagnostics.State(), merged()._replace(same=same))
    assert "followed different people, first at 1.3 s" in told
    assert "view 2 was left out in 12 frames" in told
    assert "view 1" not in told
