"""A package in MediaPipe's place: it sees a figure whose place in the picture the picture tells."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest

from common.video.clip_facts import ClipView
from common.video.pictures import Decoded, Image, Size

POSE = """
import os, time
from types import SimpleNamespace as Made

class Pose:
    def __init__(self, **given):
        {born}

    def process(self, picture):
        shade = int(picture[0, 0, 2])  # RGB: the blue of our pictures
        {doing}
        if shade == 0:
            return Made(pose_landmarks=None)
        height, width = picture.shape[:2]
        at = [((shade + i / 4) / width, (5 + i) / height) for i in range(33)]
        points = [Made(x=x, y=y, z=0.0, visibility=0.9) for x, y in at]
        return Made(pose_landmarks=Made(landmark=points))
"""


def install_fake(
    monkeypatch: pytest.MonkeyPatch, folder: Path, born: str = "pass", doing: str = "pass"
) -> None:
    """Let this process and its children find it, with code of its own at birth and each frame."""
    place = folder / "mediapipe" / "python" / "solutions"
    place.mkdir(parents=True)
    for package in (place, place.parent, place.parent.parent):
        (package / "__init__.py").write_text("")
    (place / "pose.py").write_text(POSE.format(born=born, doing=doing))
    before = os.environ.get("PYTHONPATH", "")
    monkeypatch.setenv("PYTHONPATH", f"{folder}{os.pathsep}{before}")
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.delitem(sys.modules, "mediapipe", raising=False)


def view_of(source: Size = (64, 48), working: Size = (64, 48)) -> ClipView:
    """A view of a film of pictures of a size, looked at in another."""
    return ClipView(1, "cam1.avi", source, working, 15.0, 40)


def shaded(index: int, shade: int, size: Size = (64, 48)) -> Decoded:
    """A frame whose picture tells the column of the figure in it; 0: there is none."""
    picture: Image = np.full((size[1], size[0], 3), shade, np.uint8)
    return Decoded(index, 0.0, picture)
