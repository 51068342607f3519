"""The wheel, installed where somebody's own files are called as our folders are."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Final

import numpy as np
import pytest
from installing import pip, refuse_without_network
from source_map import packages

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
    folder = tmp_path_factory.mktemp("wheel")
    refuse_without_network(folder)
    done = pip("wheel", "--quiet", "--no-deps", "--wheel-dir", str(folder), str(ROOT))
    assert done.returncode == 0, done.stderr
    return next(folder.glob("tritrack-*.whl"))


@pytest.fixture(scope="module")
def programs(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the programs of an environment of its own, which has the wheel for one camera."""
    folder = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    before = set(site(folder).iterdir())
    done = pip(
        *("--python", str(folder / "bin" / "python"), "install", "--quiet", "--no-compile"),
        *("--constraint", str(ROOT / "constraints.txt"), f"{wheel}[single]"),
    )
    assert done.returncode == 0, done.stderr
    added = {path.name for path in set(site(folder).iterdir()) - before}
    assert added.isdisjoint(NAMES)
    assert {"hmmlearn", "filterpy"} <= added
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


def test_nothing_but_tritrack_is_added(wheel: Path, programs: Path) -> None:
    record = next(site(programs.parent).glob("tritrack-*/RECORD")).read_text()
    folders = {line.split("/", maxsplit=1)[0] for line in record.splitlines()}
    assert folders == {"..", "tritrack", f"{'-'.join(wheel.name.split('-')[:2])}.dist-info"}


def test_a_clip_is_tracked_and_exported_and_ones_own_files_stay_ones_own(
    programs: Path, desk: Path
) -> None:
    tritrack, own = programs / "tritrack", desk / "own.py"
    assert "retouch" in said(desk, tritrack, "--help")
    said(desk, tritrack, "synth", "--out", "clips", "--posture", "squat", "--size", "160x120")
    (clip,) = (desk / "clips").glob("*squat")
    said(desk, programs / "python", "-m", "tritrack", "track", clip, "--out", "runs")
    with np.load(desk / "runs" / clip.name / "poses.npz", allow_pickle=False) as poses:
        posed = int(np.isfinite(poses["joints_m"]).all(axis=(1, 2)).sum())
    assert posed > 30
    said(desk, tritrack, "export", f"runs/{clip.name}", "--to", "bvh")
    assert (desk / "runs" / clip.name / "body.bvh").stat().st_size > 10_000
    said(desk, tritrack, "single", clip / "cam1.avi", "--out", "single")
    assert (desk / "single" / "cam1" / "body.bvh").is_file()
    assert (desk / "single" / "cam1" / "angles.png").is_file()
    own.write_text(OWN.format(clip=clip))
    names, counted = said(desk, programs / "python", own).splitlines()
    assert names == " ".join(f"my {name}" for name in NAMES)
    assert int(counted) == posed


def test_the_demo_runs_with_all_its_processes(programs: Path, desk: Path) -> None:
    said(desk, programs / "tritrack", "demo", "--no-page", "--out", "demo")
    assert (desk / "demo" / "summary.json").is_file()
