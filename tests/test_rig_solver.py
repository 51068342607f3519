"""The process that finds rigs, and a live calibration around it."""

import time

import msgspec
import numpy as np
import pytest
from threadpoolctl import threadpool_limits
from wild_rigs import Trial, filmed

from calibration.tracks.joint_tracks import JointTrack
from common.rig.camera import paper_rig
from integrator.live_rig import rig_solver
from integrator.live_rig.rig_job import (
    Job,
    Solution,
    Solved,
    Unsolved,
    packed,
    solved,
    track_of_bytes,
)
from integrator.live_rig.rig_solver import RigSolver
from synth.motion.motions import performance
from synth.person.people import person

PAPER = paper_rig((160, 120), (200.0, 200.0), (4.5, 4.5))


def rows_of(track: JointTrack) -> bytes:
    return b"".join(packed(row) for row in zip(*track, strict=True))


def nobody(n: int) -> bytes:
    none = np.zeros(15)
    return b"".join(packed((i / 15, np.zeros((15, 2)), none, 0.0, 0.0)) for i in range(n))


FEW = Job((160, 120), 1.75, 1 / 15, (nobody(30), nobody(30)))


def walking() -> Trial:
    someone = person(3)
    sighting = filmed(performance(someone, "walk_toward", 3), PAPER, 0.0, np.random.default_rng(3))
    return Trial(PAPER, sighting, someone.measures["stature_m"], 0.0)


def answer_of(solver: RigSolver, within_s: float) -> Solution | None:
    until_s = time.monotonic() + within_s
    answer = None
    while answer is None and time.monotonic() < until_s:
        time.sleep(0.05)
        answer = solver.answer()
    return answer


def test_a_track_comes_back_from_its_bytes() -> None:
    track = walking().sighting.first
    again = track_of_bytes(rows_of(track))
    for one, other in zip(track, again, strict=True):
        assert np.array_equal(one, other)


def test_a_job_of_too_little_is_refused_with_the_reason() -> None:
    answer = solved(FEW)
    assert isinstance(answer, Unsolved)
    assert "in 0 moments only" in answer.refusal


@pytest.mark.parametrize(
    "error", [OSError(24, "Too many open files"), msgspec.DecodeError("no answer of ours")]
)
def test_a_search_that_cannot_be_begun_is_answered(
    monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    """Its asker would wait for ever, and never ask again."""

    class Refusing:
        def child(self, *_: object) -> None:
            raise error

    monkeypatch.setattr(rig_solver, "platform", Refusing)
    solver = RigSolver()
    solver.ask(FEW)
    answer = answer_of(solver, 5.0)
    assert isinstance(answer, Unsolved)
    assert str(error) in answer.refusal


@pytest.mark.slow
@pytest.mark.live
def test_the_process_finds_what_is_found_here_and_asking_waits_for_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """To the last bit, with one thread in both, as live processes have: more add up otherwise."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        monkeypatch.setenv(name, "1")
    shown = walking()
    tracks = (rows_of(shown.sighting.first), rows_of(shown.sighting.second))
    job = Job(shown.sighting.size_px, shown.stature_m, 1 / 15, tracks, PAPER)
    solver, began_s = RigSolver(), time.monotonic()
    solver.ask(job)
    assert time.monotonic() - began_s < 0.05
    assert solver.answer() is None
    found = answer_of(solver, 100.0)
    with threadpool_limits(1):
        assert found == solved(job)
    assert isinstance(found, Solved)
    assert found.before is not None


@pytest.mark.slow
def test_a_process_that_is_stuck_or_dies_is_an_answer_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rig_solver, "STALL_S", 0.2)
    solver = RigSolver()
    solver.ask(FEW)
    answer = answer_of(solver, 30.0)
    assert isinstance(answer, Unsolved)
    assert "it gave nothing for 0.2 s" in answer.refusal
    monkeypatch.setattr(rig_solver, "MODULE", "integrator.no_such_module")
    solver.ask(FEW)
    answer = answer_of(solver, 30.0)
    assert isinstance(answer, Unsolved)
    assert "is gone" in answer.refusal
