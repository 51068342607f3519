"""From a clip to its posture's name: the made-up person of the demo, and the same in a mirror."""

import shutil
from pathlib import Path

import cv2
import pytest

from common.config.settings import Settings
from recognizer.__main__ import SHIPPED, init, step
from recognizer.model_file import load
from tritrack.live.recorded import SoFar
from tritrack.offline.lockstep import Decoders, track_clip


def named(clip: Path) -> str:
    """What a live run of the clip would say at its end."""
    with Decoders() as decoders:
        bodies = track_clip(Settings(clip=str(clip)), decoders).bodies
    state, postures = init(load(SHIPPED), 40), []
    for body in bodies:
        state, posture = step(state, body)
        postures.append(posture)
    return SoFar(postures=postures).posture


@pytest.fixture(scope="module")
def mirrored(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The clip with camera 1's pictures turned left to right: the other arm is raised."""
    folder = tmp_path_factory.mktemp("mirrored") / clip.name
    shutil.copytree(clip, folder)
    shutil.copy(clip.parent / "calibration.json", folder)
    film = cv2.VideoCapture(str(clip / "cam1.avi"))
    size = (int(film.get(cv2.CAP_PROP_FRAME_WIDTH)), int(film.get(cv2.CAP_PROP_FRAME_HEIGHT)))
    code = cv2.VideoWriter.fourcc(*"MJPG")
    out = cv2.VideoWriter(str(folder / "cam1.avi"), code, 15.0, size)
    while True:
        more, picture = film.read()
        if not more:
            break
        out.write(cv2.flip(picture, 1))
    out.release()
    return folder


def test_the_posture_is_named_of_a_person_that_no_model_was_trained_on(clip: Path) -> None:
    """P58: the demo's own answer."""
    assert named(clip) == "raise_right_lateral"


def test_a_mirror_changes_the_answer(mirrored: Path) -> None:
    """The name comes from the pictures: it is not known beforehand."""
    assert named(mirrored) == "raise_left_lateral"
