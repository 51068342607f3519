"""A rig that changes while somebody is followed."""

import numpy as np
import pytest
from staging import PERSON, RIG, Stage, between, exact, opening, report, standing

from common.body.proportions import stature
from common.bus.messages import ViewerNumber
from common.config.settings import Settings
from common.rig.camera import Rig, paper_rig
from integrator.live_rig.rig_change import set_back, with_rig, word_of
from integrator.live_rig.rig_job import Solved, Trusted
from integrator.measuring.known_body import Measured, Unmeasured


def larger(rig: Rig, times: float) -> Rig:
    """The same cameras in a world whose metre is shorter."""
    size, focal, far_m = (rig.width, rig.height), rig.cameras[0].K[0][0], 4.0 * times
    return paper_rig(size, (focal, focal), (far_m, far_m), (times, times))


@pytest.fixture
def stage(monkeypatch: pytest.MonkeyPatch) -> Stage:
    exact(monkeypatch)
    return Stage()


def test_a_measured_body_is_measured_again_by_the_new_rig(stage: Stage) -> None:
    stage.show([opening()] * 8)
    before = stage.state.person.body
    assert isinstance(before, Measured)
    told = with_rig(stage.state, larger(RIG, 1.2)).person.body
    assert isinstance(told, Measured)
    assert told.bdp.r_upper_leg.height == pytest.approx(1.2 * PERSON.r_upper_leg.height, rel=0.06)


def test_a_body_that_was_not_measured_has_the_stature_that_the_rig_is_told_by(stage: Stage) -> None:
    stage.show([standing()] * 3)
    told = with_rig(stage.state, larger(RIG, 1.5)).person.body
    assert isinstance(told, Unmeasured)
    assert stature(told.bdp) == pytest.approx(Settings().body.stature_m)


def test_the_person_is_found_in_the_new_world_from_the_next_instant_on(stage: Stage) -> None:
    stage.show(between(standing(), standing((0.3, 0.2)), 10))
    stage.state = with_rig(stage.state, larger(RIG, 1.5))
    told = stage.show([standing((0.3, 0.2))] * 3)[-1].body
    assert told.scale_source == "person"
    assert told.calibration == 1
    assert np.array(told.joints_m)[0][[0, 2]] == pytest.approx([0.45, 0.3], abs=0.12)


@pytest.mark.parametrize(("viewer", "back_s"), [(1, 0.0), (2, 0.2)])
def test_only_view_2_is_set_back_and_the_rooms_clock_is_let_be(
    viewer: ViewerNumber, back_s: float
) -> None:
    said = report(viewer, captured_s=3.0, clock_s=50.0, next_s=3.1)
    told = set_back(said, 0.2)
    assert told.captured_s == 3.0 - back_s
    assert told.next_s == pytest.approx(3.1 - back_s)
    assert told.clock_s == 50.0


@pytest.mark.parametrize(
    ("before", "late_s", "begins", "late"),
    [
        (None, 0.0, "the cameras are now calibrated by the person", "degrees; the body"),
        (41.0, -0.0667, "a better calibration by the person is used now", "late; the body"),
    ],
)
def test_what_is_said_of_a_new_rig_names_what_it_is_known_to(
    before: float | None, late_s: float, begins: str, late: str
) -> None:
    by = Trusted(12.4, ())
    was = None if before is None else Trusted(before, ())
    said = word_of(Solved(RIG, by, was, turn_error_deg=1.6), late_s)
    assert said.startswith(f"{begins}: views 12 mm apart, camera 2 known to 2 degrees")
    assert late in said
    assert ("camera 2 -67 ms late" in said) is bool(late_s)


@pytest.mark.parametrize(
    ("moved", "named"), [((2,), "camera 2 was"), ((1, 2), "both cameras were")]
)
def test_what_is_said_of_a_camera_that_was_moved_names_it(
    moved: tuple[ViewerNumber, ...], named: str
) -> None:
    solved = Solved(RIG, Trusted(12.4, ()), Trusted(41.0, ()))
    said = word_of(solved, 0.2, moved)
    assert said == f"{named} placed anew by the person: views 12 mm apart"
