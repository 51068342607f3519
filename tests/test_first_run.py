"""What is compiled beforehand: after it no command of every day compiles."""

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.slow
def test_after_the_first_run_tracking_compiles_nothing(clip: Path, tmp_path: Path) -> None:
    def run(*words: str) -> str:
        own = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        done = subprocess.run(
            [sys.executable, "-m", *words], env=own, check=True, text=True, capture_output=True
        )
        return done.stdout

    assert "compiled in" in run("tritrack.first_run")
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")}
    assert len(before) > 100
    assert run("tritrack.first_run") == ""
    run("tritrack", "track", str(clip), "--out", str(tmp_path / "runs"))
    run("tritrack", "track", str(clip), "--out", str(tmp_path / "runs"), "--views", "1")
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")} == before
    assert not [path for path in before if b"__mp_main__" in path.read_bytes()]
    assert not [path for path in before if b"__main__" in path.read_bytes()]
