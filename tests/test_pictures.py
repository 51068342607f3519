"""What a source is: a camera of this host or a recorded file, and who asks which."""

import re
from pathlib import Path

import pytest

from common.video.pictures import Source, cure, is_camera, is_recorded, named

ROOMS = ("animator", "calibration", "common", "integrator", "lab", "runtime", "tritrack", "viewer")
STILL = {"viewer/room/background_source.py", "viewer/landmarks/keypoint_files.py"}
"""These ask still: others are at work in them."""


@pytest.mark.parametrize("source", [0, 3, "cam1.avi", "0"])
def test_a_source_is_a_camera_or_recorded_and_never_both(source: Source) -> None:
    """A number is a camera of this host; text is a file, though it looks like a number."""
    assert is_camera(source) is (source in (0, 3))
    assert is_recorded(source) is not is_camera(source)


def test_a_source_that_cannot_be_read_is_named_with_its_own_cure() -> None:
    assert (named(2), named("a/cam1.avi")) == ("camera 2", "a/cam1.avi")
    assert "plugged in" in cure(2)
    assert "PNG" in cure("a/plate.PNG")
    assert "ffmpeg" in cure("a/cam1.avi")


def test_one_file_alone_knows_how_a_camera_is_told_from_a_file() -> None:
    asks = re.compile(r"isinstance\([\w.]*source, (int|str)\)")
    root = Path(__file__).parents[1]
    found = {
        str(path.relative_to(root))
        for room in ROOMS
        for path in (root / room).rglob("*.py")
        if asks.search(path.read_text(encoding="utf-8"))
    }
    assert found - STILL == {"common/video/pictures.py"}
