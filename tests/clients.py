"""Programs that open our files, called as their users call them, in a process of their own."""

import importlib.util
import json
import subprocess
import sys
from tempfile import TemporaryDirectory
from typing import Any

import pytest


def answer_of(library: str, code: str, *arguments: str) -> Any:
    """What a short program says in its last line, as JSON; the test skips without the library."""
    if importlib.util.find_spec(library) is None:
        pytest.skip(f"{library} is not installed: pip install 'tritrack[clients]'")
    with TemporaryDirectory() as folder:  # OpenSim writes a log where it is called
        done = subprocess.run(
            [sys.executable, "-c", code, *arguments],
            cwd=folder,
            capture_output=True,
            check=False,
            text=True,
            timeout=120,
        )
    if "cannot open shared object file" in done.stderr:
        pytest.skip(f"{library} does not load on this machine: {done.stderr.splitlines()[-1]}")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])
