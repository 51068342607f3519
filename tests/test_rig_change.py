"""A rig that changes while somebody is followed."""

import numpy as np
import pytest
from staging import PERSON, RIG, Stage, between, exact, opening, report, standing

from common.body.proportions import stature
from common.bus.messages import ViewerNumber
from common.config.settings import Settings
from common.rig.camera import Rig, paper_rig
from integrator.live_rig.rig_change import set_back, with_rig


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
    before = stage.state.opening
    assert before.measured
    told = with_rig(stage.state, larger(RIG, 1.2)).opening
    assert told.measured
    assert told.bdp is not None
    assert told.bdp.r_upper_leg.height == pytest.approx(1.2 * PERSON.r_upper_leg.height, rel=0.06)


def test_a_body_that_was_not_measured_has_the_stature_that_the_rig_is_told_by(stage: Stage) -> None:
    stage.show([standing()] * 3)
    told = with_rig(stage.state, larger(RIG, 1.5)).opening
    assert told.bdp is not None
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
