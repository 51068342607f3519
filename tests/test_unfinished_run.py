"""The files of a run that goes on: what was saved comes back, and nothing is left at the end."""

from pathlib import Path
from typing import NamedTuple

import pytest

from common.bus.messages import Body
from common.config.settings import Settings
from tritrack.store.journal import Head
from tritrack.store.past_journal import read_journal
from tritrack.unfinished.unfinished_run import BODIES, CannotResume, UnfinishedRun, saved_in

HEAD = Head(settings=Settings(), facts={"clip": "walk"})
IDENTITY = {"the settings": "1", "cam1.avi": "2"}


class State(NamedTuple):
    """Of a stage."""

    instants: int


def body(frame: int) -> Body:
    return Body(frame=frame, captured_s=frame / 15, clock_s=0.0, status="tracking", views="both")


def test_what_was_saved_comes_back_and_what_came_after_it_does_not(tmp_path: Path) -> None:
    run = UnfinishedRun(tmp_path / "run", IDENTITY, HEAD)
    bodies = run.messages(BODIES)
    for frame in range(5):
        bodies.append(body(frame))
        if frame == 2:
            run.save("instants", State(3))
    run.close()
    told = read_journal(tmp_path / "run")
    assert told is not None
    assert [one.frame for one in told.bodies] == [0, 1, 2, 3, 4]
    again = UnfinishedRun(tmp_path / "run", IDENTITY, HEAD, saved_in(tmp_path / "run", IDENTITY))
    assert [one.frame for one in again.messages(BODIES)] == [0, 1, 2]
    assert again.resumed("instants", State) == State(3)
    assert again.resumed("poses", State) is None
    again.remove()
    assert not (tmp_path / "run").exists()


def test_what_differs_is_named(tmp_path: Path) -> None:
    run = UnfinishedRun(tmp_path, IDENTITY, HEAD)
    run.messages(BODIES)
    run.save("instants", State(0))
    run.close()
    with pytest.raises(CannotResume, match=r"since it was begun cam1\.avi, cam2\.avi changed"):
        saved_in(tmp_path, {"the settings": "1", "cam1.avi": "3", "cam2.avi": "4"})


def test_a_run_that_saved_nothing_begins_anew(tmp_path: Path) -> None:
    run = UnfinishedRun(tmp_path, IDENTITY, HEAD)
    run.messages(BODIES).append(body(0))
    run.close()
    assert saved_in(tmp_path, IDENTITY) is None
    assert len(UnfinishedRun(tmp_path, IDENTITY, HEAD).messages(BODIES)) == 0


def test_a_run_that_begins_anew_has_one_journal_whole_and_no_state_of_before(
    tmp_path: Path,
) -> None:
    """What the first pass had yet to write must not come into the second one's journal."""
    run = UnfinishedRun(tmp_path, IDENTITY, HEAD)
    first = run.messages(BODIES)
    for frame in range(9_000):
        first.append(body(frame))
    run.save("instants", State(9_000))
    first.append(body(9_000))
    run.restart()
    assert saved_in(tmp_path, IDENTITY) is None, "the second pass goes on from nothing"
    second = run.messages(BODIES)
    for frame in range(7):
        second.append(body(100 + frame))
    del first
    run.close()
    told = read_journal(tmp_path)
    assert told is not None
    assert [one.frame for one in told.bodies] == [*range(100, 107)]
