"""What a live run keeps of what was said: the newest, as it was said."""

from pathlib import Path

import msgspec
import pytest

from common.bus.control_messages import Pulse
from common.bus.messages import Body, Posture
from common.config.settings import Settings
from runtime.live.launch import nothing_heard
from runtime.live.recorded import MessageLog, SoFar, WholeRun
from runtime.live.run_facts import note_lost, note_unseen
from runtime.store import journal
from runtime.store.journal import Head, Journal
from runtime.store.past_journal import Journalled
from runtime.store.past_run import open_run
from runtime.store.runs import NO_PERSON_SEEN, write_run


def test_no_more_than_the_bound_is_kept_and_what_gave_way_is_counted() -> None:
    """However long a run is, its supervisor takes no more room than this."""
    kept = MessageLog(Pulse, most=3)
    beats = [Pulse(process="viewer 1", state="running", frames=n) for n in range(8)]
    kept.add(beats[:2])
    assert ([*kept], kept.let_go) == (beats[:2], 0)
    kept.add(beats[2:])
    assert ([*kept], kept.let_go) == (beats[-3:], 5)


def test_the_newest_are_found_from_the_end_up_to_the_first_that_is_not_wanted() -> None:
    kept = MessageLog(Pulse)
    kept.add(Pulse(process="viewer 1", state="running", frames=n) for n in (9, 1, 7, 8))
    assert [pulse.frames for pulse in kept.newest(lambda each: each.frames > 5)] == [7, 8]
    assert [pulse.frames for pulse in kept.newest(lambda _: True, most=1)] == [8]
    assert MessageLog(Pulse).newest(lambda _: True) == []


def body(frame: int) -> Body:
    return Body(frame=frame, captured_s=frame / 15, clock_s=0.0, status="empty", views="none")


def long_run(out: Path, most_bytes: int, most_parts: int) -> tuple[Journal, MessageLog[Body]]:
    """A run of 300 frames, of which memory holds the newest 20."""
    written = Journal(out, Head(settings=Settings(), facts={}), most_bytes, most_parts)
    newest = MessageLog(Body, most=20)
    for frame in range(300):
        newest.add([body(frame)])
        written.keep([body(frame)])
    return written, newest


def test_a_run_that_is_longer_than_memory_is_written_whole(tmp_path: Path) -> None:
    """Of what memory lost the journal has kept every part."""
    written, newest = long_run(tmp_path, 4000, 100)
    write_run(tmp_path, WholeRun(newest, Journalled(tmp_path, Body)), Settings(), {})
    assert len(journal.parts_of(tmp_path)) > 10
    written.remove()
    assert open_run(tmp_path).poses["frame"].tolist() == [*range(300)]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["poses.npz", "summary.json"]


def test_of_a_run_that_is_longer_than_the_disk_allows_is_said_how_much_is_lost(
    tmp_path: Path,
) -> None:
    """It is said when it begins, and at the end how many frames it were."""
    written, newest = long_run(tmp_path, 4000, 3)
    kept = [each.frame for each in WholeRun(newest, Journalled(tmp_path, Body))]
    assert kept == [*range(written.let_go, 300)]
    assert 0 < written.let_go < 280
    assert ["a long run" in line for line in written.odd] == [True]
    heard = nothing_heard()._replace(bodies=newest, journal=written)
    note_lost(heard)
    assert heard.notes[0].startswith(f"the first {written.let_go} frames of a long run are not in")


def test_a_short_run_is_read_from_memory_alone(tmp_path: Path) -> None:
    """It may be that the disk took none of it."""
    newest = MessageLog(Body)
    newest.add([body(0), body(1)])
    heard = nothing_heard()._replace(bodies=newest)
    note_lost(heard)
    assert ([*WholeRun(newest, Journalled(tmp_path, Body))], heard.notes) == ([*newest], [])


def test_a_run_whose_frames_show_nobody_says_so() -> None:
    """One that ends before its first frame has nothing to say of it."""
    heard = nothing_heard()
    note_unseen(heard)
    assert heard.notes == []
    heard.so_far.take([body(0), body(1)], [])
    note_unseen(heard)
    assert heard.notes == [NO_PERSON_SEEN]
    heard.so_far.take([msgspec.structs.replace(body(2), status="lost")], [])
    note_unseen(heard)
    assert heard.notes == [NO_PERSON_SEEN]


def test_a_performance_is_named_by_the_last_window_that_had_a_name() -> None:
    told = SoFar()
    assert told.posture == ""
    for name in ("", "squat", "kick_left_side", ""):
        told.take([], [Posture(frame=0, captured_s=0.0, clock_s=0.0, name=name)])
    assert told.posture == "kick_left_side"


def test_of_several_people_each_has_the_last_name_of_their_own() -> None:
    told = SoFar()
    for person, name in ((1, "squat"), (2, "kick_left_side"), (1, ""), (0, "squat"), (2, "squat")):
        posture = Posture(frame=0, captured_s=0.0, clock_s=0.0, name=name, person=person)
        told.take([], [posture])
    assert told.postures == {1: "squat", 2: "squat"}


def test_what_is_told_so_far_reads_no_body_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that a supervisor of an hours-long run stands still for none of its answers."""
    told = SoFar([body(0), body(1)])
    monkeypatch.setattr("runtime.live.recorded.decode", lambda *_: pytest.fail("read again"))
    assert (told.moves, told.posture) == ((), "")
