"""Posture models from clips and from runs."""

import json
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from spoiling import copied, edit_json

from common.footage import ClipError
from recognizer.model_file import load
from tritrack.making import make_clips
from tritrack.offline import ClipsFailed, track_all
from tritrack.training import TrainingError, recordings, train_postures

QUIET = Console(quiet=True)
POSTURES = ("raise_right_lateral", "squat")


@pytest.fixture(scope="module")
def clips(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    out = tmp_path_factory.mktemp("clips")
    return make_clips(out, "postures", 2, 1, 1, "160x120", POSTURES, QUIET)


@pytest.fixture(scope="module")
def runs(clips: list[Path], tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    out = tmp_path_factory.mktemp("runs")
    return [out / name for name in track_all(clips, out, None, (1, 2), None, QUIET)["clips"]]


def test_a_model_learns_the_postures_that_the_clips_name(clips: list[Path], tmp_path: Path) -> None:
    facts = train_postures(clips, tmp_path / "deep" / "m.npz", None, QUIET)
    assert facts["sequences"] == {"raise_right_lateral": 2, "squat": 2}
    model = load(tmp_path / "deep" / "m.npz", POSTURES)
    assert list(model.card.performers) == facts["performers"] == ["s02", "s03"]


def test_clips_and_their_runs_give_the_same_model(
    clips: list[Path], runs: list[Path], tmp_path: Path
) -> None:
    train_postures(clips, tmp_path / "clips.npz", None, QUIET)
    train_postures(runs, tmp_path / "runs.npz", None, QUIET)
    assert (tmp_path / "clips.npz").read_bytes() == (tmp_path / "runs.npz").read_bytes()


def test_the_opening_posture_is_no_part_of_the_motion(runs: list[Path]) -> None:
    """Measuring and empty frames name nothing: a model of a T-pose would know every clip."""
    (recording,) = recordings(runs[:1], None, QUIET)
    with np.load(runs[0] / "poses.npz", allow_pickle=False) as found:
        moving = np.isin(found["status"], ("tracking", "predicted"))
    assert 0 < np.isfinite(recording.rows).all(axis=1).sum() <= moving.sum()
    assert (recording.posture, recording.performer) == ("raise_right_lateral", "s02")


def test_a_clip_without_a_posture_is_named(clips: list[Path], tmp_path: Path) -> None:
    folder = tmp_path / "clip"
    copied(clips[0], folder)
    edit_json(folder / "meta.json", lambda meta: meta.pop("posture"))
    with pytest.raises(TrainingError, match=r"clip names no posture: write it into .*meta.json"):
        train_postures([folder], tmp_path / "m.npz", None, QUIET)


@pytest.mark.parametrize("damage", ["no summary", "half the poses", "pickled"])
def test_a_damaged_run_is_named(runs: list[Path], tmp_path: Path, damage: str) -> None:
    run = tmp_path / "run"
    run.mkdir()
    poses, summary = (runs[0] / "poses.npz").read_bytes(), (runs[0] / "summary.json").read_text()
    (run / "poses.npz").write_bytes(
        poses[: len(poses) // 2] if damage == "half the poses" else poses
    )
    if damage == "pickled":
        np.savez(run / "poses.npz", status=np.array([{}], object))
    if damage != "no summary":
        (run / "summary.json").write_text(summary)
    with pytest.raises(TrainingError, match=r"run is no run folder: .*track the clip again"):
        train_postures([run], tmp_path / "m.npz", None, QUIET)


def test_what_is_no_clip_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ClipError, match="neither cam1"):
        train_postures([tmp_path], tmp_path / "m.npz", None, QUIET)
    (tmp_path / "calibration.json").write_text("{}")
    with pytest.raises(ClipsFailed, match="no clip is left"):
        train_postures([tmp_path / "calibration.json"], tmp_path / "m.npz", None, QUIET)


def test_a_model_that_cannot_be_written_is_named(runs: list[Path], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(TrainingError, match=r"cannot learn or write .*file"):
        train_postures(runs, tmp_path / "file" / "m.npz", None, QUIET)


def test_a_motion_too_short_to_learn_from_is_said(runs: list[Path], tmp_path: Path) -> None:
    run = tmp_path / "run"
    run.mkdir()
    with np.load(runs[0] / "poses.npz", allow_pickle=False) as found:
        np.savez(run / "poses.npz", **{name: found[name] for name in found.files})
        arrays = {name: found[name] for name in found.files}
    arrays["status"] = np.full_like(arrays["status"], "lost")
    np.savez(run / "poses.npz", **arrays)
    facts = json.loads((runs[0] / "summary.json").read_text())
    (run / "summary.json").write_text(json.dumps(facts))
    with pytest.raises(TrainingError, match=r"m\.npz"):
        train_postures([run], tmp_path / "m.npz", None, QUIET)
