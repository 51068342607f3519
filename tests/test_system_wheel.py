"""The wheel, installed where a person's own files are called as our folders are.

Its first command is a live run, which compiles everything, as on a person's machine: no other slow
test compiles from nothing.
"""

import json
import os
import shutil
import subprocess
import sys
from importlib.metadata import distributions
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import pytest
from installing import needed, pip, put_into
from rich.console import Console
from source_map import packages

from runtime.offline.batch import Asked, track_all

ROOT: Final = Path(__file__).parents[1]
NAMES: Final = [name for name in packages(ROOT) if name != "tritrack"]
OWN: Final = f"""
import {", ".join(NAMES)}
from tritrack import track
print(*({", ".join(f"{name}.MINE" for name in NAMES)}))
print(sum(bool(body.joints_m) for body in track("{{clip}}")))
"""
LIMIT_S: Final = 900.0
"""No command takes longer; the first compiles."""
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel as pip builds it."""
    pytest.importorskip("hatchling", reason="pip install 'tritrack[dev]'")
    folder = tmp_path_factory.mktemp("wheel")
    how = ("--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", str(folder))
    done = pip("wheel", *how, str(ROOT))
    assert done.returncode == 0, done.stderr
    return next(folder.glob("tritrack-*.whl"))


@pytest.fixture(scope="module")
def programs(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the programs of an environment of its own, which has the wheel for one camera, and
    of the libraries those alone that the wheel asks for."""
    folder = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    within, before = ("--python", str(folder / "bin" / "python")), set(site(folder).iterdir())
    done = pip(*within, "install", "--quiet", "--no-compile", "--no-deps", str(wheel))
    assert done.returncode == 0, done.stderr
    (told,) = distributions(name="tritrack", path=[str(site(folder))])
    libraries = needed(told.requires or (), ("single",))
    put_into(site(folder), libraries.values())
    added = {path.name for path in set(site(folder).iterdir()) - before}
    assert added.isdisjoint({*NAMES, "websockets"})
    assert {"hmmlearn", "filterpy", "skimage"} <= added
    done = pip(*within, "check")
    assert done.returncode == 0, done.stdout
    return folder / "bin"


def site(environment: Path) -> Path:
    return next(environment.glob("lib/python3*/site-packages"))


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with files of one's own, which every program there finds before all others."""
    folder = tmp_path_factory.mktemp("desk")
    for name in NAMES:
        (folder / f"{name}.py").write_text(f"MINE = 'my {name}'\n")
    return folder


def said(desk: Path, *words: str | Path) -> str:
    ours = {"VIRTUAL_ENV", "TRITRACK_DATA", "TRITRACK_LOG", "NUMBA_CACHE_DIR"}
    inherited = {name: value for name, value in os.environ.items() if name not in ours}
    done = subprocess.run(
        words,
        cwd=desk,
        env={**inherited, "PYTHONPATH": str(desk), "XDG_CACHE_HOME": str(desk / "cache")},
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    assert done.returncode == 0, f"{words}: {done.stdout}{done.stderr}"
    return done.stdout


class First(NamedTuple):
    """A live run, where nothing was compiled before."""

    run: Path
    compiled: dict[Path, int]
    """When each compiled function was written, ns."""


@pytest.fixture(scope="module")
def first(programs: Path, desk: Path) -> First:
    assert not (desk / "cache").exists()
    said(desk, programs / "tritrack", "demo", "--no-page", "--out", "demo")
    return First(desk / "demo", compiled_of(desk))


def compiled_of(desk: Path) -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in (desk / "cache").rglob("*.nbc")}


@pytest.fixture(scope="module")
def tracked(first: First, programs: Path, desk: Path, clip: Path) -> Path:
    """A run of both views."""
    said(desk, programs / "python", "-m", "tritrack", "track", clip, "--out", "runs")
    return desk / "runs" / clip.name


def test_nothing_but_tritrack_is_added(wheel: Path, programs: Path) -> None:
    record = next(site(programs.parent).glob("tritrack-*/RECORD")).read_text()
    folders = {line.split("/", maxsplit=1)[0] for line in record.splitlines()}
    assert folders == {"..", "tritrack", f"{'-'.join(wheel.name.split('-')[:2])}.dist-info"}


@pytest.mark.skipif(sys.platform != "linux", reason="parts of a run are forked on Linux alone")
def test_a_first_live_run_compiles_before_its_clip_begins_and_not_in_its_midst(
    first: First,
) -> None:
    """Else its integrator stands still for seconds, and is killed as one that hangs."""
    summary = json.loads((first.run / "summary.json").read_text())
    assert summary["frames"] > 60
    began_s = (first.run / "poses.npz").stat().st_mtime - (summary["frames"] - 1) / 15
    assert len(first.compiled) > 100
    assert max(first.compiled.values()) / 1e9 < began_s
    assert not [told for told in summary["warnings"] if "killed" in told]


def test_after_the_first_run_no_command_of_every_day_compiles(
    first: First, tracked: Path, programs: Path, desk: Path, clip: Path
) -> None:
    assert said(desk, programs / "python", "-m", "tritrack.first_run") == ""
    for words in (
        ("track", clip, "--views", "1", "--out", "one"),
        ("single", clip / "cam1.avi", "--out", "single"),
    ):
        said(desk, programs / "tritrack", *words)
        assert compiled_of(desk) == first.compiled, words
    assert not [path for path in first.compiled if b"__mp_main__" in path.read_bytes()]
    assert not [path for path in first.compiled if b"__main__" in path.read_bytes()]
    assert (desk / "single" / "cam1" / "body.bvh").is_file()
    assert (desk / "single" / "cam1" / "angles.png").is_file()


def test_nor_does_a_live_run_whose_cameras_nobody_calibrated(
    first: First, programs: Path, desk: Path, clip: Path
) -> None:
    """Its viewers fit a stick figure until the rig is known: compiled in their midst, that would
    make them hang for the first ten seconds of the first run."""
    shutil.copytree(clip, desk / "bare" / clip.name)
    settings = desk / "live.toml"
    settings.write_text(
        f'clip = "{desk / "bare" / clip.name}"\nsize = "160x120"\n'
        '[bus]\nendpoint = "auto"\n[page]\nport = 0\n'
    )
    said(desk, programs / "tritrack", "live", settings, "--out", "bare run")
    summary = json.loads((desk / "bare run" / "summary.json").read_text())
    assert [told for told in summary["warnings"] if told.startswith("no calibration")]
    assert not [told for told in summary["warnings"] if "killed" in told]
    assert compiled_of(desk) == first.compiled


def test_what_is_compiled_anew_gives_the_same_bytes(tracked: Path, clip: Path, desk: Path) -> None:
    """As what the checkout compiled before."""
    track_all([clip], desk / "before", Asked(), Console(quiet=True))
    before, anew = desk / "before" / clip.name / "poses.npz", tracked / "poses.npz"
    assert before.read_bytes() == anew.read_bytes()


def test_a_clip_is_made_tracked_and_exported_and_ones_own_files_stay_ones_own(
    tracked: Path, programs: Path, desk: Path, clip: Path
) -> None:
    tritrack, own = programs / "tritrack", desk / "own.py"
    assert "retouch" in said(desk, tritrack, "--help")
    said(desk, tritrack, "synth", "--out", "clips", "--posture", "squat", "--size", "160x120")
    assert next((desk / "clips").glob("*squat/cam1.avi")).stat().st_size > 10_000
    with np.load(tracked / "poses.npz", allow_pickle=False) as poses:
        posed = int(np.isfinite(poses["joints_m"]).all(axis=(1, 2)).sum())
    assert posed > 30
    said(desk, tritrack, "export", f"runs/{clip.name}", "--to", "bvh")
    assert (tracked / "body.bvh").stat().st_size > 10_000
    own.write_text(OWN.format(clip=clip))
    names, counted = said(desk, programs / "python", own).splitlines()
    assert names == " ".join(f"my {name}" for name in NAMES)
    assert int(counted) == posed
