"""Requests for the odd camera: they come back from their bytes, and are answered as offline."""

import time

import msgspec
import pytest
from many_views import around, shown
from sights_as_views import instants_of
from test_odd_camera import with_turns
from test_odd_search import after

from calibration.gate.odd_camera import OddCamera, odd_camera
from calibration.tracks.lateness import Clock
from common.rig.camera import Rig
from integrator.live_rig.odd_job import NONE_ODD, OddAnswer, OddJob, odd_solved
from integrator.live_rig.odd_search import State
from integrator.live_rig.rig_solver import OddSolver

RIG = around(3)
SHOWN = shown(RIG, 11, "walk_toward")
TURNED = with_turns({1: (1.5, 1.5, 0.0)}, RIG)


def job_of(rig: Rig) -> OddJob:
    _, (job,) = after(State(0), instants_of(SHOWN, 11.0))
    told = msgspec.msgpack.encode(msgspec.structs.replace(job, rig=rig))
    return msgspec.msgpack.decode(told, type=OddJob)


@pytest.mark.slow
def test_the_answer_is_what_a_recorded_clip_gives() -> None:
    found = odd_solved(job_of(TURNED))
    assert isinstance(found, OddCamera)
    offline = odd_camera(TURNED, [SHOWN], (Clock(0.0),) * 2)
    assert offline is not None
    assert found.place == offline.place == 1
    assert found.turn == pytest.approx(offline.turn, abs=0.005)
    again = msgspec.msgpack.decode(msgspec.msgpack.encode(found), type=OddAnswer)
    assert again == found


@pytest.mark.slow
def test_in_a_good_rig_none_is_found_nor_without_people() -> None:
    assert odd_solved(job_of(RIG)) == NONE_ODD
    assert odd_solved(OddJob(TURNED, ())) == NONE_ODD
    assert msgspec.msgpack.decode(msgspec.msgpack.encode(NONE_ODD), type=OddAnswer) == NONE_ODD


@pytest.mark.slow
def test_the_child_process_finds_it_too() -> None:
    solver = OddSolver()
    solver.ask(job_of(TURNED))
    until_s, found = time.monotonic() + 100.0, None
    while found is None and time.monotonic() < until_s:
        time.sleep(0.05)
        found = solver.answer()
    solver.close()
    assert isinstance(found, OddCamera)
    assert found.place == 1
