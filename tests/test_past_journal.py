"""The journal of a run, read: from disk, as often as one likes, through all of its parts."""

import os
from pathlib import Path

import msgspec

from common.bus.messages import Body
from common.config.settings import Settings
from runtime.store.journal import HEAD, NAME, Head, Journal, framed, parts_of
from runtime.store.past_journal import Journalled, put_aside, read_journal
from runtime.store.past_run import open_run

SETTINGS = Head(settings=Settings(clip="clips/walk"), facts={"clip": "walk"})


def body(frame: int) -> Body:
    return Body(frame=frame, captured_s=frame / 15, clock_s=0.0, status="empty", views="none")


def journal_of(folder: Path, frames: int, most_bytes: int) -> Journal:
    written = Journal(folder, SETTINGS, most_bytes)
    for frame in range(frames):
        written.keep([body(frame)])
    return written


def test_a_run_that_was_cut_short_after_hours_is_read_from_all_of_its_parts(tmp_path: Path) -> None:
    journal_of(tmp_path, 100, 4000)
    assert len(parts_of(tmp_path)) > 4
    assert open_run(tmp_path).poses["frame"].tolist() == [*range(100)]


def test_messages_are_read_anew_each_time_and_with_what_came_since(tmp_path: Path) -> None:
    written = journal_of(tmp_path, 2, 4000)
    bodies = Journalled(tmp_path, Body)
    assert [each.frame for each in bodies] == [0, 1]
    written.keep([body(2)])
    assert [each.frame for each in bodies] == [0, 1, 2]


def test_a_part_that_was_torn_keeps_the_others(tmp_path: Path) -> None:
    journal_of(tmp_path, 100, 4000)
    first, second, *_ = parts_of(tmp_path)
    of_first = [each.frame for each in Journalled(tmp_path, Body)]
    os.truncate(first, 0)
    left = [each.frame for each in Journalled(tmp_path, Body)]
    assert left == of_first[-len(left) :]
    assert 50 < len(left) < 100
    assert second.stat().st_size


def test_no_journal_and_one_of_another_version_are_none(tmp_path: Path) -> None:
    assert read_journal(tmp_path) is None
    (tmp_path / NAME).write_bytes(framed(HEAD, msgspec.msgpack.encode({"of": "a later version"})))
    assert read_journal(tmp_path) is None
    assert not put_aside(tmp_path, tmp_path / "aside")


def test_all_parts_are_put_aside(tmp_path: Path) -> None:
    journal_of(tmp_path, 100, 4000)
    assert put_aside(tmp_path, tmp_path / "saved" / "aside")
    assert parts_of(tmp_path) == []
    assert len(open_run(tmp_path / "saved" / "aside").poses["frame"]) == 100


def test_a_posture_of_another_version_makes_the_journal_one_of_that_version(tmp_path: Path) -> None:
    """It is found before anything is read, not while results are written."""
    journal_of(tmp_path, 2, 4000).close()
    with (tmp_path / NAME).open("ab") as file:
        file.write(framed(b"p", msgspec.msgpack.encode({"of": "a later version"})))
    assert read_journal(tmp_path) is None
