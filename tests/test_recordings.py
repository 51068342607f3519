"""What was performed in clips and runs, tracked once and kept."""

import shutil
from collections.abc import Callable
from glob import glob
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from spoiling import copied, edit_json

from lab.posture_models.evaluation import Recording
from lab.postures.posture_evaluation import Plan
from lab.training import recordings as stage
from lab.training.recordings import RecordingError, announced, recordings
from runtime.offline import clip_cache
from runtime.offline.batch import Asked, track_all
from runtime.store.clip_paths import ClipsFailed
from runtime.store.runs import RunError
from synth.write import ClipSet
from tritrack.commands.options import CACHE
from tritrack.making import make_clips

QUIET = Console(quiet=True)
PERFORMED = (("s90001", "raise_right_lateral"), ("s02", "squat"))


@pytest.fixture(scope="module")
def clips(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    out = tmp_path_factory.mktemp("clips")
    wanted = ClipSet("postures", seed=2, postures=("squat",))
    return [clip, *make_clips(out, wanted, "160x120", QUIET)]


@pytest.fixture(scope="module")
def runs(
    clips: list[Path], recorded_run: Path, tmp_path_factory: pytest.TempPathFactory
) -> list[Path]:
    out = tmp_path_factory.mktemp("runs")
    track_all(clips[1:], out, Asked(), QUIET)
    return [recorded_run, out / clips[1].name]


@pytest.fixture
def tracked_names(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The clips that are really tracked from here on."""
    names = []
    plain: Callable[..., object] = stage._tracked

    def counted(due: stage.Due, *rest: object) -> object:
        names.append(due.path.name)
        return plain(due, *rest)

    monkeypatch.setattr(stage, "_tracked", counted)
    return names


def same(first: list[Recording], second: list[Recording]) -> bool:
    return all(
        (one.performer, one.posture) == (two.performer, two.posture)
        and np.array_equal(one.rows, two.rows)
        for one, two in zip(first, second, strict=True)
    )


@pytest.mark.slow
def test_clips_their_runs_and_what_was_kept_give_the_same(
    clips: list[Path], runs: list[Path], tmp_path: Path, tracked_names: list[str]
) -> None:
    """A second reading tracks nothing and changes no bit."""
    first = recordings(clips, None, tmp_path, QUIET)
    assert tracked_names == [path.name for path in clips]
    again = recordings(clips, None, tmp_path, QUIET)
    assert len(tracked_names) == len(clips)
    assert same(first, again)
    assert same(first, recordings(runs, None, tmp_path, QUIET))
    assert [one.clip for one in first] == list(map(str, clips))


@pytest.mark.slow
def test_work_that_was_stopped_goes_on_where_it_was(
    clips: list[Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    tracked_names: list[str],
) -> None:
    """Ctrl-C after the first of two: only the second is tracked later, nothing is half-written."""
    monkeypatch.setattr(stage, "BATCH", 1)
    plain = stage._keep

    def stopped(*given: object) -> None:
        plain(*given)  # type: ignore[arg-type]
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(stage, "_keep", stopped)
        with pytest.raises(KeyboardInterrupt):
            recordings(clips, None, tmp_path, QUIET)
    assert len(list(tmp_path.iterdir())) == 1
    recordings(clips, None, tmp_path, QUIET)
    assert tracked_names == [path.name for path in clips]


def test_the_opening_posture_is_no_part_of_the_motion(runs: list[Path], tmp_path: Path) -> None:
    """Measuring and empty frames name nothing: a model of a T-pose would know every clip."""
    longer = shutil.copytree(runs[0], tmp_path / "longer")
    with np.load(runs[0] / "poses.npz", allow_pickle=False) as found:
        arrays = dict(found)
    moving = np.isin(arrays["status"], ("tracking", "predicted"))
    arrays["status"][np.flatnonzero(moving)[:30]] = "measuring"
    np.savez(longer / "poses.npz", **arrays)
    one, other = recordings([runs[0], longer], None, tmp_path / "kept", QUIET)
    whole, less = (np.isfinite(each.rows).all(axis=1).sum() for each in (one, other))
    assert 0 < whole <= moving.sum()
    assert 0 < less <= moving.sum() - 30
    assert (one.posture, one.performer) == ("raise_right_lateral", "s90001")


def test_a_clip_without_a_posture_is_named_before_any_is_tracked(
    clips: list[Path], tmp_path: Path, tracked_names: list[str]
) -> None:
    folder = copied(clips[0], tmp_path / "clip")
    edit_json(folder / "meta.json", lambda meta: meta.pop("posture"))
    with pytest.raises(RecordingError, match=r"clip names no posture: write it into .*meta.json"):
        recordings([*clips, folder], None, tmp_path / "kept", QUIET)
    assert not tracked_names


def test_clips_say_themselves_who_performs_what(clips: list[Path], runs: list[Path]) -> None:
    told = [(one.performer, one.posture, one.clip) for one in announced([*clips, *runs], QUIET)]
    assert told == [
        (*performed, str(path))
        for paths in (clips, runs)
        for performed, path in zip(PERFORMED, paths, strict=True)
    ]


@pytest.mark.parametrize(
    ("damage", "told"),
    [
        ("no summary", r"run has no summary\.json: track the clip again"),
        ("half the poses", r"run was damaged .*: track the clip again"),
        ("pickled", r"run was damaged .*: track the clip again"),
    ],
)
def test_a_damaged_run_is_named(runs: list[Path], tmp_path: Path, damage: str, told: str) -> None:
    run = tmp_path / "run"
    run.mkdir()
    poses, summary = (runs[0] / "poses.npz").read_bytes(), (runs[0] / "summary.json").read_text()
    (run / "poses.npz").write_bytes(
        poses[: len(poses) // 2] if damage == "half the poses" else poses
    )
    if damage == "pickled":
        np.savez(run / "poses.npz", allow_pickle=True, frame=np.array([{}], object))
    if damage != "no summary":
        (run / "summary.json").write_text(summary)
    with pytest.raises(RecordingError, match=told):
        recordings([run], None, tmp_path, QUIET)


@pytest.mark.slow
def test_clips_that_cannot_be_used_are_said_after_the_others_were_tracked(
    clips: list[Path], tmp_path: Path
) -> None:
    broken = copied(clips[0], tmp_path / "broken")
    (broken / "cam2.avi").write_bytes(b"")
    said = StringIO()
    with pytest.raises(ClipsFailed, match="1 of 2 clips could not be tracked"):
        recordings([broken, clips[0]], None, tmp_path / "kept", Console(file=said, width=999))
    assert "error: " in said.getvalue()
    assert "cam2.avi" in said.getvalue()
    assert len(list((tmp_path / "kept").iterdir())) == 1


def test_what_is_no_clip_is_refused(tmp_path: Path) -> None:
    (tmp_path / "calibration.json").write_text("{}")
    with pytest.raises(ClipsFailed, match="no clip is left"):
        recordings([tmp_path / "calibration.json"], None, tmp_path, QUIET)


@pytest.mark.slow
def test_a_cache_that_cannot_be_written_is_named(clips: list[Path], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RunError, match=r"cannot write .*file: .*--cache"):
        recordings(clips[:1], None, tmp_path / "file", QUIET)


def test_the_cache_is_not_among_what_a_pattern_takes_for_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`tritrack train runs/*/`, after clips were learnt from."""
    monkeypatch.chdir(tmp_path)
    assert Plan().cache == CACHE
    clip_cache.write(CACHE, "key", b"kept")
    assert glob("runs/*/") == []
