"""What is compiled beforehand: after it no command of every day compiles."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow


def said(cache: Path | None, *words: str) -> str:
    """What a module's command says, whose compiled code is in a folder, or where it always is."""
    own = {} if cache is None else {"NUMBA_CACHE_DIR": str(cache)}
    done = subprocess.run(
        [sys.executable, "-m", *words],
        env={**os.environ, **own},
        check=True,
        text=True,
        capture_output=True,
    )
    return done.stdout


@pytest.fixture(scope="module")
def anew(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a first run: the one place of the slow tests where a checkout compiles anew."""
    folder = tmp_path_factory.mktemp("cache")
    assert "compiled in" in said(folder, "tritrack.first_run")
    return folder


def test_after_the_first_run_tracking_compiles_nothing(
    anew: Path, clip: Path, tmp_path: Path
) -> None:
    before = {path: path.stat().st_mtime_ns for path in anew.rglob("*.nbc")}
    assert len(before) > 100
    assert said(anew, "tritrack.first_run") == ""
    said(anew, "tritrack", "track", str(clip), "--out", str(tmp_path))
    said(anew, "tritrack", "track", str(clip), "--out", str(tmp_path), "--views", "1")
    assert {path: path.stat().st_mtime_ns for path in anew.rglob("*.nbc")} == before
    assert not [path for path in before if b"__mp_main__" in path.read_bytes()]
    assert not [path for path in before if b"__main__" in path.read_bytes()]


def test_what_is_compiled_anew_gives_the_same_bytes(anew: Path, clip: Path, tmp_path: Path) -> None:
    """As what another process compiled before."""
    for cache, out in ((anew, "anew"), (None, "before")):
        said(cache, "tritrack", "track", str(clip), "--out", str(tmp_path / out))
    first, second = (tmp_path / out / clip.name / "poses.npz" for out in ("anew", "before"))
    assert first.read_bytes() == second.read_bytes()
