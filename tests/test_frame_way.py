"""The way of a frame, followed: docs/architecture.md tells all of it."""

from pathlib import Path

import pytest
from frame_way import way

ROOT = Path(__file__).parents[1]
TOLD = {"viewer", "integrator", "recognizer"}
"""Packages whose every file the page names; common/ is what these share."""


@pytest.mark.slow
def test_the_page_names_every_file_that_a_frame_passes() -> None:
    page = (ROOT / "docs/architecture.md").read_text()
    passed = {path for path in way(ROOT).all if path.parts[0] in TOLD}
    assert len(passed) > 20
    assert sorted(path.as_posix() for path in passed if f"`{path.as_posix()}" not in page) == []
