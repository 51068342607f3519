"""Installing as a user does, with the package index of this machine where it has one."""

import subprocess
import sys
from pathlib import Path

import pytest


def pip(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pip", *words], capture_output=True, text=True, check=False
    )


def refuse_without_network(folder: Path) -> None:
    tried = pip("download", "--quiet", "--no-deps", "--dest", str(folder / "tried"), "iniconfig")
    if tried.returncode:
        pytest.skip(f"no package can be installed here: {tried.stderr.strip()[-200:]}")
