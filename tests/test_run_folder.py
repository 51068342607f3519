"""The folder of a live run: what one that was cut short left is put aside, not written over."""

from pathlib import Path

import pytest

from common.bus.messages import Body
from common.config.settings import Settings
from common.video.clip_facts import Clip, ClipView, Meta
from runtime.live.admission import LiveRefused
from runtime.live.page_desk import SAVED
from runtime.live.run_folder import KEPT, new_journal, new_log
from runtime.store.journal import has_journal
from runtime.store.past_journal import LOG, read_journal

CLIP = Clip("room", (ClipView(1, 0, (160, 120), (160, 120), 15.0, 0),), 1, None, Meta())


def cut_short(folder: Path, notes: list[str]) -> None:
    """A run that had one body, and whose journal nobody took away."""
    journal = new_journal(folder, CLIP, Settings(), notes)
    journal.keep([Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="none")])
    journal.close()


def test_a_log_is_of_one_run_alone(tmp_path: Path) -> None:
    out = tmp_path / "new" / "run"
    path = new_log(out)
    assert (path, path.read_text()) == (out / LOG, "")
    path.write_text("the run before")
    left = out / f"{KEPT}viewers"
    left.mkdir()
    (left / "background_1.npz").write_text("")
    (out / "mine").mkdir()
    assert new_log(out).read_text() == ""
    assert not left.exists()
    assert (out / "mine").is_dir()


def test_the_log_of_a_run_that_was_cut_short_stays_until_it_is_put_aside(tmp_path: Path) -> None:
    notes: list[str] = []
    new_log(tmp_path).write_text("it was dark")
    cut_short(tmp_path, notes)
    assert notes == []
    assert has_journal(tmp_path)
    assert new_log(tmp_path).read_text() == "it was dark"
    new_journal(tmp_path, CLIP, Settings(), notes).close()
    (aside,) = (tmp_path / SAVED).iterdir()
    assert aside.name.startswith("cut_short_2")
    assert notes == [f"the run before this one was cut short: what it measured is in {aside}"]
    assert (aside / LOG).read_text() == "it was dark"


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(LiveRefused, match=r"cannot write .*file/run: .*; name another --out"):
        new_log(tmp_path / "file" / "run")
    cut_short(tmp_path, [])
    (tmp_path / SAVED).write_text("no folder")
    with pytest.raises(LiveRefused, match="cannot be put aside"):
        new_journal(tmp_path, CLIP, Settings(), [])


def test_a_recording_that_was_torn_goes_aside_with_its_run(tmp_path: Path) -> None:
    """A whole one is written over, as the run's other results are."""
    cut_short(tmp_path, [])
    for name in (".recording.abc.mcap", "recording.mcap"):
        (tmp_path / name).write_text(name)
    notes: list[str] = []
    journal = new_journal(tmp_path, CLIP, Settings(), notes)
    (aside,) = (tmp_path / SAVED).iterdir()
    assert (aside / ".recording.abc.mcap").read_text() == ".recording.abc.mcap"
    assert not (tmp_path / ".recording.abc.mcap").exists()
    assert (tmp_path / "recording.mcap").exists()
    journal.keep([Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="none")])
    journal.close()
    told = read_journal(tmp_path)
    assert told is not None
    assert told.head.facts["clip"] == "room"
