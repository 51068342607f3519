"""What the tests share: where the clips lie."""

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """The folder of development clips, or a skip that says how to name it."""
    default = Path(__file__).parents[2] / "shared" / "data"
    folder = Path(os.environ.get("TRITRACK_DATA", default))
    if not folder.is_dir():
        pytest.skip("no development clips: set TRITRACK_DATA to their folder")
    return folder
