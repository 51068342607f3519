"""The files of a run that goes on: what was saved comes back, and nothing is left at the end."""

import os
import zlib
from pathlib import Path
from typing import NamedTuple

import pytest

from common.bus.messages import Body
from common.config.settings import Settings
from runtime.store.journal import Head
from runtime.store.past_journal import read_journal
from runtime.unfinished.unfinished_run import (
    BODIES,
    CannotResume,
    UnfinishedRun,
    refuse_another,
    saved_in,
)

HEAD = Head(settings=Settings(), facts={"clip": "walk"})
IDENTITY = {"the settings": "1", "cam1.avi": "2"}


class State(NamedTuple):
    """Of a stage."""

    instants: int


class Other(NamedTuple):
    """Of another stage."""

    guide: str
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


def test_what_changed_is_named_in_the_order_in_which_it_was_begun(tmp_path: Path) -> None:
    """Files that are new come last."""
    with pytest.raises(CannotResume) as error:
        refuse_another(tmp_path, {"b": "1", "a": "2"}, {"c": "3", "a": "4"})
    assert str(error.value) == (
        f"{tmp_path} holds a run that cannot go on: since it was begun b, a, c changed; undo "
        "that, or leave out --resume to begin anew"
    )
    refuse_another(tmp_path, IDENTITY, dict(reversed(IDENTITY.items())))


def test_a_state_is_due_every_ten_seconds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    times_s = iter((100.0, 109.9, 110.0, 112.0, 112.0, 121.9, 122.0))
    monkeypatch.setattr("runtime.unfinished.unfinished_run.time.monotonic", lambda: next(times_s))
    run = UnfinishedRun(tmp_path, IDENTITY, HEAD)
    run.messages(BODIES)
    due = [run.due, run.due, run.due]
    run.save("instants", State(1))
    due += [run.due, run.due]
    run.close()
    assert due == [False, True, True, False, True]


def test_what_an_older_run_left_goes_where_one_begins_anew(tmp_path: Path) -> None:
    older = UnfinishedRun(tmp_path, IDENTITY, HEAD)
    older.messages(BODIES).append(body(0))
    older.messages("heard").append(body(0))
    older.save("instants", State(1))
    older.close()
    UnfinishedRun(tmp_path, IDENTITY, HEAD)
    assert [*tmp_path.iterdir()] == []
    assert saved_in(tmp_path, IDENTITY) is None


def test_what_was_damaged_is_named_with_the_cure(tmp_path: Path) -> None:
    run = UnfinishedRun(tmp_path, IDENTITY, HEAD)
    run.messages("heard").append(body(0))
    run.save("instants", State(1))
    run.close()
    saved = saved_in(tmp_path, IDENTITY)
    again = UnfinishedRun(tmp_path, IDENTITY, HEAD, saved)
    state = tmp_path / "unfinished" / "state.bin"
    with pytest.raises(CannotResume) as error:
        again.resumed("instants", Other)
    assert str(error.value).startswith(f"{state}: ")
    assert str(error.value).endswith(": leave out --resume to begin anew")
    (tmp_path / "unfinished" / "heard.bin").write_bytes(b"short")
    with pytest.raises(CannotResume, match=r"heard\.bin .*: leave out --resume to begin anew$"):
        again.messages("heard")
    whole = state.read_bytes()
    state.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    with pytest.raises(CannotResume) as error:
        saved_in(tmp_path, IDENTITY)
    assert str(error.value) == f"{state} was damaged: leave out --resume to begin anew"
    content = b"no state"
    state.write_bytes(zlib.crc32(content).to_bytes(4, "little") + content)
    with pytest.raises(CannotResume, match=r"state\.bin cannot be read \(.*\): leave out"):
        saved_in(tmp_path, IDENTITY)


def test_a_run_folder_with_results_stays_where_what_was_unfinished_goes(tmp_path: Path) -> None:
    run = UnfinishedRun(tmp_path / "run", IDENTITY, HEAD)
    run.messages(BODIES).append(body(0))
    run.messages("heard")
    (tmp_path / "run" / "poses.npz").write_bytes(b"")
    run.remove()
    assert [path.name for path in (tmp_path / "run").iterdir()] == ["poses.npz"]


def test_a_state_outlives_a_power_cut_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All of it is handed to the disk, and the disk asked to keep it, before it has its name."""
    synced: list[int] = []
    monkeypatch.setattr(os, "fsync", lambda file: synced.append(os.fstat(file).st_size))
    run = UnfinishedRun(tmp_path, IDENTITY, HEAD)
    heard = run.messages("heard")
    heard.append(body(0))
    run.save("instants", State(1))
    run.close()
    folder = tmp_path / "unfinished"
    sizes = [(folder / name).stat().st_size for name in ("heard.bin", "state.bin")]
    assert synced == sizes
    assert min(sizes) > 0
