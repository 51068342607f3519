"""A camera that looks beside its calibration in a live run: it is turned back, and named."""

import math

import numpy as np
import pytest
from many_views import around, shown
from sights_as_views import instants_of
from staging import PERIOD_S
from test_odd_camera import with_turns

from calibration.gate.odd_camera import OddCamera
from common.bus.control_messages import TurnedBack
from common.bus.instant import Instant
from common.bus.messages import View
from common.config.settings import Settings
from common.method import DEFAULT, PAPER, Method
from common.rig.camera import Rig
from common.rig.turned_camera import angle_deg
from integrator import merge_state
from integrator.live_rig.live_odd_camera import LiveOddCamera
from integrator.live_rig.odd_job import NONE_ODD, OddAnswer, OddJob
from integrator.live_rig.odd_search import ASKS_S
from integrator.merge_state import Start, State

RIG = around(3)
SHOWN = shown(RIG, 11, "walk_toward")
TURNED = with_turns({1: (1.5, 1.5, 0.0)}, RIG)
ODD = OddCamera(1, (math.radians(-1.5), math.radians(-1.5), 0.0), 0.123, 0.015)


class Solver:
    """Finds camera 2 in the rig in which it is turned, at once."""

    def __init__(self) -> None:
        self.jobs: list[OddJob] = []
        self.said: OddAnswer | None = None
        self.is_closed = False

    def ask(self, job: OddJob) -> None:
        self.jobs.append(job)
        self.said = ODD if job.rig == TURNED else NONE_ODD

    def answer(self) -> OddAnswer | None:
        said, self.said = self.said, None
        return said

    def close(self) -> None:
        self.is_closed = True


def room_of(rig: Rig, settings: Settings = Settings(), method: Method = DEFAULT) -> State:
    return merge_state.init(rig, PERIOD_S, settings, method, Start())


def of_one(instant: Instant) -> dict[int, dict[int, View]]:
    """Its views, of one person."""
    return {0: {view.viewer: view for view in instant.views if view is not None}}


def lived(room: State, seconds: float, solver: Solver) -> tuple[State, LiveOddCamera]:
    """A run of one person before three cameras."""
    with LiveOddCamera(room, solver) as odd:
        for instant in instants_of(SHOWN, seconds):
            room = room._replace(last_s=instant.newest.captured_s)
            odd.heard(of_one(instant), room)
            room = odd.changed(room)
    return room, odd


def test_a_turned_camera_is_turned_back_from_then_on_and_named_with_the_cure() -> None:
    solver = Solver()
    before = room_of(TURNED)
    room, odd = lived(before, ASKS_S[0] + 12.0, solver)
    assert room.rig is not None
    assert angle_deg(np.array(room.rig.cameras[1].R) @ np.array(RIG.cameras[1].R).T) < 0.01
    assert room.rig.cameras[0] == TURNED.cameras[0]
    assert (room.calibration, room.scale_source) == (1, "calibrated")
    (said,) = odd.news
    assert said == (
        "10.0 s: camera 2 looks 2.1 degrees beside its calibration: its sight lines pass those of "
        "all other cameras by 123 mm, by 15 mm once it is turned, as it is from now on; calibrate "
        "again, or keep it as calibrated with --trust-calibration"
    )
    assert odd.odd == TurnedBack(2, ODD.turn, 0.123, 0.015)
    assert len(solver.jobs) == 2, "the rig as turned is looked at too, by evidence of its own"
    assert solver.is_closed


def test_a_good_rig_stays() -> None:
    solver, before = Solver(), room_of(RIG)
    room, odd = lived(before, ASKS_S[0] + 1.0, solver)
    assert (room.rig, room.calibration, odd.news, odd.odd) == (RIG, 0, (), None)
    assert len(solver.jobs) == 1


@pytest.mark.parametrize(
    ("room", "why"),
    [
        (room_of(TURNED, Settings(trust_calibration=True)), "the user trusts it"),
        (room_of(around(2)), "of two neither is to blame"),
        (room_of(TURNED)._replace(scale_source="assumed"), "it is no calibration"),
        (room_of(TURNED, Settings(mode="paper"), PAPER), "there are no landmarks"),
    ],
)
def test_it_is_not_asked_where_nothing_would_follow(room: State, why: str) -> None:
    solver = Solver()
    after, _ = lived(room, ASKS_S[0] + 1.0, solver)
    assert (after.rig, solver.jobs) == (room.rig, []), why


def test_what_is_seen_while_a_camera_moves_is_no_evidence() -> None:
    solver, room = Solver(), room_of(TURNED)
    moved = room._replace(stands=room.stands._replace(unconfirmed=(2,)))
    _, odd = lived(moved, ASKS_S[0] + 1.0, solver)
    assert (solver.jobs, odd.news) == ([], ())


def test_an_answer_about_a_rig_that_changed_meanwhile_is_dropped() -> None:
    solver, room = Solver(), room_of(TURNED)
    with LiveOddCamera(room, solver) as odd:
        for instant in instants_of(SHOWN, ASKS_S[0] + 0.5):
            odd.heard(of_one(instant), room)
        assert solver.said == ODD
        other = room._replace(calibration=1)
        assert odd.changed(other) is other
    assert odd.news == ()
