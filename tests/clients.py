"""Programs that open our files, called as their users call them, in a process of their own."""

import importlib.util
import json
import subprocess
import sys
from typing import Any

import pytest


def answer_of(library: str, code: str, *arguments: str) -> Any:
    """What a short program says in its last line, as JSON; the test skips without the library."""
    if importlib.util.find_spec(library) is None:
        pytest.skip(f"{library} is not installed: pip install {library}")
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        capture_output=True,
        check=False,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])
