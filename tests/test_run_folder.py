"""The folder of a live run: what one that was cut short left is put aside, not written over."""

import json
import os
from pathlib import Path

import pytest
from msgspec.structs import replace

from common.bus.messages import Body
from common.config.settings import Settings
from common.rig.camera import Rig, paper_rig
from common.rig.rig_file import load_rig
from common.video.clip_facts import Clip, ClipView, Meta
from runtime.live.admission import LiveRefused
from runtime.live.page_desk import SAVED
from runtime.live.run_folder import (
    KEPT,
    finish_pictures,
    new_journal,
    new_log,
    new_pictures,
    owned,
    refuse_kept_pictures,
)
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


RIG = paper_rig((160, 120), (200.0, 210.0), (4.5, 4.0))


def clip_of(sizes: tuple[tuple[int, int], ...], rig: Rig | None) -> Clip:
    views = tuple(ClipView(n, n, size, size, 15.0, 0) for n, size in enumerate(sizes, 1))
    return Clip("room", views, 1, rig, Meta())


def test_pictures_are_kept_beside_the_calibration_that_the_run_has(tmp_path: Path) -> None:
    named = [replace(one, name=name) for one, name in zip(RIG.cameras, "ab", strict=True)]
    clip = clip_of(((160, 120), (160, 120)), replace(RIG, cameras=tuple(named)))
    folder = new_pictures(tmp_path, clip, wanted=True)
    assert folder == tmp_path / "pictures"
    rig = load_rig(folder / "calibration.json")
    assert (rig.width, rig.height) == (160, 120)
    assert [one.name for one in rig.cameras] == ["cam1", "cam2"]
    for one, own in zip(rig.cameras, RIG.cameras, strict=True):
        assert (one.K, one.R, one.t) == (own.K, own.R, own.t)


def test_a_calibration_is_for_one_shape_of_pictures(tmp_path: Path) -> None:
    """Another size of that shape is scaled; another shape, or none, leaves it out."""
    twice = replace(RIG.cameras[1], K=((420.0, 0.0, 160.0), (0.0, 420.0, 120.0), (0.0, 0.0, 1.0)))
    rig = replace(RIG, cameras=(RIG.cameras[0], twice))
    folder = new_pictures(tmp_path, clip_of(((160, 120), (320, 240)), rig), wanted=True)
    assert folder is not None
    assert load_rig(folder / "calibration.json").cameras[1].K == RIG.cameras[1].K
    for clip in (clip_of(((160, 120), (120, 160)), RIG), clip_of(((160, 120),) * 2, None)):
        folder = new_pictures(tmp_path, clip, wanted=True)
        assert folder is not None
        assert [*folder.iterdir()] == [], "nothing of the run before either"


def test_a_run_without_pictures_has_no_folder_for_them(tmp_path: Path) -> None:
    clip = clip_of(((160, 120),), None)
    assert new_pictures(tmp_path, clip, wanted=True) is not None
    with pytest.raises(LiveRefused, match="pictures holds what cameras showed in another run"):
        refuse_kept_pictures(tmp_path)
    assert new_pictures(tmp_path, clip, wanted=False) is None
    refuse_kept_pictures(tmp_path)
    assert [*tmp_path.iterdir()] == []
    assert finish_pictures(None, []) == {}


def test_what_viewers_left_becomes_a_clip_and_what_is_missing_is_said(tmp_path: Path) -> None:
    times = {"cam1": (2.0, 2.1, 2.2, 2.5), "cam2": (2.05, 2.15), "cam2_2": (3.0, 3.1)}
    for name, times_s in times.items():
        (tmp_path / f"{name}.times.txt").write_text("".join(f"{each}\n" for each in times_s))
    notes: list[str] = []
    facts = finish_pictures(tmp_path, notes)["pictures"]
    assert facts["cam1"] == {"frames": 4, "fps": 10.0, "missing": 2}
    assert facts["cam2"] == {"frames": 2, "fps": 10.0, "missing": 0}
    assert [*facts] == [*times]
    meta = json.loads((tmp_path / "meta.json").read_text())
    assert meta["capture_s"]["cam2_2"] == [1.0, 1.1]
    assert [path.name for path in tmp_path.iterdir()] == ["meta.json"]
    assert notes[0] == "2 of 6 pictures of cam1 are missing"
    assert notes[1].startswith("the viewer of cam2 was started again: what it showed from then on")
    assert notes[1].endswith("cam2_2.avi, its times in meta.json")
    assert len(notes) == 2


def test_a_run_that_kept_no_picture_says_so(tmp_path: Path) -> None:
    notes: list[str] = []
    assert finish_pictures(tmp_path, notes) == {}
    assert notes == [f"no picture was kept in {tmp_path}"]


def test_a_run_does_not_replace_the_pictures_that_it_plays(tmp_path: Path) -> None:
    video = tmp_path / "run/pictures/cam1.avi"
    video.parent.mkdir(parents=True)
    video.write_bytes(b"RIFF")
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "run")
    view = ClipView(1, str(link / "pictures/cam1.avi"), (160, 120), (160, 120), 15.0, 3)
    clip = Clip("room", (view,), 1, None, Meta())
    for wanted in (True, False):
        with pytest.raises(LiveRefused, match="pictures, which it would replace: name another"):
            new_pictures(tmp_path / "run", clip, wanted)
    assert video.is_file()


def test_two_live_runs_do_not_write_into_one_folder(tmp_path: Path) -> None:
    out = tmp_path / "run"
    with owned(out):
        (file,) = out.iterdir()
        with owned(out):
            pass
    assert [*out.iterdir()] == []
    file.write_text(str(os.getppid()))
    with pytest.raises(LiveRefused, match=rf"process {os.getppid()}\) writes into .*run: end it"):
        owned(out).__enter__()
    assert file.is_file()
