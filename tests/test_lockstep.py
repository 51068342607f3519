"""Offline runs: repeatable to the byte, and honest about frames that are missing."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console
from spoiling import Film, copied, cut_off, edit_json, refilmed

from common.config.settings import Settings
from common.config.settings_error import SettingsError
from synth.write import ClipSet, write_set
from tritrack.offline.batch import Asked, track_all
from tritrack.offline.lockstep import Decoders, track_clip
from tritrack.offline.performance import Watch
from tritrack.overrides import overridden
from tritrack.store.pose_arrays import poses

QUIET = Console(quiet=True)


def tracked(clip: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    with Decoders() as decoders:
        done = track_clip(Settings(clip=str(clip)), decoders)
    return poses([body for body in done.bodies if body.frame >= 0]), done.facts


def test_the_same_clip_gives_the_same_bytes(clip: Path, tmp_path: Path) -> None:
    for out in ("first", "second"):
        track_all([clip], tmp_path / out, Asked(), QUIET)
    first, second = ((tmp_path / out / clip.name / "poses.npz") for out in ("first", "second"))
    assert first.read_bytes() == second.read_bytes()


def test_nothing_is_written_but_the_run_folder(clip: Path, tmp_path: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in clip.parent.rglob("*")}
    track_all([clip], tmp_path, Asked(), QUIET)
    assert {path: path.stat().st_mtime_ns for path in clip.parent.rglob("*")} == before
    files = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    assert files == {f"{clip.name}/poses.npz", f"{clip.name}/summary.json"}


def test_the_order_of_clips_does_not_change_one(clip: Path, tmp_path: Path) -> None:
    """A decoder that was left in the middle of a film, or used before, reads the next as new."""
    other = copied(clip, tmp_path / "other")
    cut_off(other)
    alone, _ = tracked(clip)
    with Decoders() as decoders:
        track_clip(Settings(clip=str(other)), decoders)
        after = poses(track_clip(Settings(clip=str(clip)), decoders).bodies)
    for name, values in alone.items():
        np.testing.assert_array_equal(after[name], values, err_msg=name)


def test_a_view_that_ends_early_leaves_the_other_to_go_on(clip: Path, tmp_path: Path) -> None:
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: film[:40], cameras=(2,))
    rows, facts = tracked(folder)
    assert rows["frame"].tolist() == list(range(69))
    assert set(rows["views"][15:40]) == {"both"}
    assert set(rows["views"][40:]) == {"1"}
    assert np.isfinite(rows["joints_m"][40:]).all()
    assert facts["warnings"] == ["the views differ in length: 69 and 40 frames"]


def only(kept: list[int]) -> Callable[[Film], Film]:
    return lambda film: [film[i] for i in kept]


def test_frames_that_one_camera_missed_are_paired_by_their_moments(
    clip: Path, tmp_path: Path
) -> None:
    """Camera 1 misses frames 30 and 31, camera 2 frame 50; `capture_s` says so."""
    folder = copied(clip, tmp_path / "clip")
    gone = {1: {30, 31}, 2: {50}}
    kept = {n: [i for i in range(69) if i not in gone[n]] for n in (1, 2)}
    for n in (1, 2):
        refilmed(folder, only(kept[n]), cameras=(n,))
    moments = {f"cam{n}": [i / 15 for i in kept[n]] for n in (1, 2)}
    edit_json(folder / "meta.json", lambda meta: meta.update(capture_s=moments))
    rows, facts = tracked(folder)
    assert rows["frame"].tolist() == list(range(67))
    np.testing.assert_allclose(rows["time_s"], moments["cam1"])
    alone = np.flatnonzero(rows["views"] == "1")
    assert [kept[1][row] for row in alone if kept[1][row] > 12] == [50]
    assert facts["warnings"] == []


def test_the_stressed_clip_has_a_row_for_each_of_camera_1s_frames(data_dir: Path) -> None:
    folder = data_dir / "dev_stress" / "frame_drops"
    rows, facts = tracked(folder)
    moments = json.loads((folder / "meta.json").read_text())["capture_s"]["cam1"]
    assert rows["frame"].tolist() == list(range(len(moments)))
    np.testing.assert_allclose(rows["time_s"], moments)
    assert facts["warnings"] == []


def test_every_nth_frame_keeps_its_number_and_time(clip: Path) -> None:
    with Decoders() as decoders:
        rows = poses(track_clip(Settings(clip=str(clip), every=2), decoders).bodies)
    assert rows["frame"].tolist() == list(range(0, 69, 2))
    np.testing.assert_allclose(rows["time_s"], np.arange(0, 69, 2) / 15)


def test_a_command_line_goes_before_the_settings() -> None:
    given = Settings(mode="paper", size="80x60")
    assert overridden(given, None, None) == given
    assert overridden(given, "default", None) == Settings(mode="default", size="80x60")
    assert overridden(given, None, "96x96") == Settings(mode="paper", size="96x96")
    with pytest.raises(SettingsError, match="must be from 32x32 to 4096x4096 pixels, got 5000x50"):
        overridden(given, None, "5000x50")


def test_a_pair_filmed_without_calibration_is_tracked(data_dir: Path, tmp_path: Path) -> None:
    """configs/frontside_walk.toml: its run folder bears the file's name, not a video's."""
    config = Path(__file__).parents[1] / "configs" / "frontside_walk.toml"
    if "TRITRACK_DATA" not in os.environ:
        pytest.skip("the settings name the clips by TRITRACK_DATA")
    pytest.importorskip("skimage", reason="a busy clip needs the extra `single`")
    done = track_all([config], tmp_path, Asked(), QUIET)
    assert list(done["clips"]) == ["frontside_walk"]
    assert done["clips"]["frontside_walk"]["scale_source"] == "person"
    with np.load(tmp_path / "frontside_walk" / "poses.npz", allow_pickle=False) as found:
        assert np.isfinite(found["joints_m"]).all(axis=(1, 2)).mean() > 0.9


@pytest.fixture(scope="module")
def squats(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Somebody who squats, which repeats nothing within two seconds."""
    wanted = ClipSet("postures", seed=90_001, postures=("squat",))
    return write_set(tmp_path_factory.mktemp("squats"), wanted, (160, 120))[0]


@pytest.mark.slow
@pytest.mark.parametrize("calibrated", [True, False], ids=["calibrated", "by the person"])
def test_a_view_that_is_late_is_found_and_the_clip_is_tracked_with_its_times_set_back(
    squats: Path, tmp_path: Path, calibrated: bool
) -> None:
    """Camera 2 was started six frames later: it shows all 0.4 s earlier, and is told so."""
    folder = copied(squats, tmp_path / "clip")
    refilmed(folder, lambda film: film[6:], cameras=(2,))
    if not calibrated:
        (folder / "calibration.json").unlink()
    shown: list[object] = []
    with Decoders() as decoders:
        watch = Watch(lambda *_: shown.append(1), shown.clear)
        done = track_clip(Settings(clip=str(folder)), decoders, watch=watch)
    assert done.facts["clock"]["state"] == "found"
    assert done.facts["clock"]["applied_s"] == pytest.approx(-0.4, abs=0.05)
    assert len(shown) == len(done.bodies)
    if calibrated:
        found = poses([body for body in done.bodies if body.frame >= 0])
        truth = np.load(squats / "truth.npz")
        names = truth["joint_names"].tolist()
        true_m = truth["joints3d"][:, [names.index(name) for name in found["joint_names"]]]
        off_m = np.linalg.norm(found["joints_m"] - true_m[found["frame"]], axis=-1)[29:]
        assert np.nanmean(off_m) < 0.04


@pytest.mark.slow
def test_an_offset_that_is_given_is_used_and_not_looked_for(squats: Path, tmp_path: Path) -> None:
    folder = copied(squats, tmp_path / "clip")
    refilmed(folder, lambda film: film[6:], cameras=(2,))
    track_all([folder], tmp_path / "runs", Asked(offset_s=-0.4), QUIET)
    told = json.loads((tmp_path / "runs/clip/summary.json").read_text())
    assert told["clock"] == {
        "state": "given",
        "applied_s": -0.4,
        "may_be_s": [],
        "may_be_on_time": True,
    }
    assert told["settings"]["offset_s"] == -0.4
