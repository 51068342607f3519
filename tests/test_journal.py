"""The journal of a live run: whatever is cut off or fails, what was kept before is read again."""

import errno
import os
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.bus.messages import Body, Posture
from common.config.settings import Settings
from runtime.store.journal import MOST_BODIES, NAME, Head, Journal, parts_of
from runtime.store.past_journal import LOG, put_aside, read_journal
from runtime.store.past_run import open_run
from runtime.store.pose_arrays import poses
from runtime.store.runs import write_run

HEAD = Head(settings=Settings(clip="clips/walk"), facts={"clip": "walk"})


def body(frame: int) -> Body:
    return Body(frame=frame, captured_s=frame / 15, clock_s=0.0, status="empty", views="none")


def frames_in(folder: Path) -> list[int]:
    told = read_journal(folder)
    return [] if told is None else [each.frame for each in told.bodies]


def test_what_is_kept_is_read_at_once_without_an_end(tmp_path: Path) -> None:
    """As after kill -9: nothing was closed."""
    one = Journal(tmp_path, HEAD)
    one.keep([body(0), Posture(frame=0, captured_s=0.0, clock_s=0.0, name="squat")])
    one.keep([body(1)])
    told = read_journal(tmp_path)
    assert told is not None
    assert (told.head, [*told.bodies]) == (HEAD, [body(0), body(1)])
    assert [posture.name for posture in told.postures] == ["squat"]


@given(st.integers(0, 400))
def test_a_torn_tail_costs_the_record_that_is_torn(tmp_path_factory: Any, cut: int) -> None:
    folder = tmp_path_factory.mktemp("torn")
    one = Journal(folder, HEAD)
    ends = []
    for frame in range(5):
        one.keep([body(frame)])
        ends.append((folder / NAME).stat().st_size)
    left = max(0, ends[-1] - cut)
    os.truncate(folder / NAME, left)
    assert frames_in(folder) == [frame for frame, end in enumerate(ends) if end <= left]


def test_a_byte_that_is_wrong_costs_what_stands_behind_it(tmp_path: Path) -> None:
    one = Journal(tmp_path, HEAD)
    one.keep([body(0)])
    at = (tmp_path / NAME).stat().st_size
    one.keep([body(1), body(2)])
    data = bytearray((tmp_path / NAME).read_bytes())
    data[at + 20] ^= 1
    (tmp_path / NAME).write_bytes(data)
    assert frames_in(tmp_path) == [0]


def test_the_disk_that_it_takes_is_bounded_and_the_newest_stay(tmp_path: Path) -> None:
    most = 2000
    one = Journal(tmp_path, HEAD, most, most_parts=1)
    for frame in range(100):
        one.keep([body(frame)])
    sizes = [path.stat().st_size for path in parts_of(tmp_path)]
    assert len(sizes) == 2
    assert max(sizes) <= most
    kept = frames_in(tmp_path)
    assert kept == list(range(kept[0], 100))
    assert len(kept) > 5
    assert one.let_go == kept[0]


def test_older_parts_go_where_the_results_would_not_find_room(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Written of all of them they need as much again; the part before the newest stays."""
    scarce = SimpleNamespace(free=2 * 1800 * MOST_BODIES)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: scarce)
    one = Journal(tmp_path, HEAD, 2000)
    for frame in range(100):
        one.keep([body(frame)])
    assert len(parts_of(tmp_path)) == 2
    assert frames_in(tmp_path) == list(range(one.let_go, 100))


def test_frames_without_anybody_are_few_bytes_and_whole_rows(tmp_path: Path) -> None:
    """So a part is full by its rows too."""
    one = Journal(tmp_path, HEAD)
    one.keep([body(0)] * MOST_BODIES)
    one.keep([body(1)])
    assert [path.name for path in parts_of(tmp_path)] == ["journal.000000.bin", NAME]


def test_a_full_disk_is_told_once_and_what_comes_when_it_has_room_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It takes half a record, then nothing: of that record nothing is left."""
    one = Journal(tmp_path, HEAD)
    one.keep([body(0)])
    written = os.write
    calls = iter((10, None, None, None))

    def full(file: int, data: bytes) -> int:
        most = next(calls)
        if most is None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return written(file, data[:most])

    with monkeypatch.context() as patched:
        patched.setattr(os, "write", full)
        one.keep([body(1)])
        assert len(one.odd) == 1, "it is told at once"
        one.keep([body(2)])
    one.keep([body(3)])
    assert frames_in(tmp_path) == [0, 3]
    assert len(one.odd) == 1
    assert "No space left on device" in one.odd[0]


def test_a_run_that_was_cut_short_is_read_as_one_that_was_not(tmp_path: Path) -> None:
    """An older run's results in the same folder are not taken for it."""
    write_run(tmp_path, [body(7)], Settings(), {"warnings": []})
    Journal(tmp_path, HEAD).keep([body(0), body(-1), body(1)])
    run = open_run(tmp_path)
    want = poses([body(0), body(1)])
    assert run.poses["frame"].tolist() == want["frame"].tolist()
    assert (run.summary["clip"], run.summary["frames"]) == ("walk", 2)
    assert "cut short" in run.summary["warnings"][0]


def test_a_journal_goes_with_its_run_and_one_of_a_run_cut_short_is_put_aside(
    tmp_path: Path,
) -> None:
    one = Journal(tmp_path, HEAD)
    one.keep([body(0)])
    (tmp_path / LOG).write_text("it ran out of memory\n")
    assert put_aside(tmp_path, tmp_path / "saved")
    assert (tmp_path / "saved" / LOG).read_text() == "it ran out of memory\n"
    assert (tmp_path / LOG).read_text() == "", "the next run's own"
    assert open_run(tmp_path / "saved").poses["frame"].tolist() == [0]
    two = Journal(tmp_path, HEAD)
    assert not put_aside(tmp_path, tmp_path / "saved_too")
    two.remove()
    assert not (tmp_path / NAME).exists()


def test_a_record_that_the_disk_takes_piece_by_piece_is_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written = os.write
    monkeypatch.setattr(os, "write", lambda file, data: written(file, data[:7]))
    one = Journal(tmp_path, HEAD)
    one.keep([body(0), body(1)])
    one.keep([body(2)])
    assert frames_in(tmp_path) == [0, 1, 2]


def test_what_was_written_outlives_a_power_cut_every_five_seconds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    synced, now_s = list[float](), [100.0]
    monkeypatch.setattr("runtime.store.journal.time.monotonic", lambda: now_s[0])
    monkeypatch.setattr(os, "fsync", lambda _: synced.append(now_s[0]))
    one = Journal(tmp_path, HEAD)
    assert (tmp_path / NAME).stat().st_size > 0, "its head is there before the first body"
    for now_s[0] in (104.9, 105.1, 106.0, 110.0, 110.3):
        one.keep([body(0)])
    assert synced == [105.1, 110.3]
