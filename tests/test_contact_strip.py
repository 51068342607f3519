"""Strips of a clip: both views, and limbs drawn where the person is."""

from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest

from tritrack.offline.lockstep import Decoders
from tritrack.postures.contact_strip import SHOWN, WIDTH_PX, contact_strip


@pytest.fixture(scope="module")
def strip(clip: Path) -> np.ndarray:
    with Decoders() as decoders:
        png = contact_strip(clip, None, decoders)
    picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR_RGB)
    assert picture is not None
    return np.asarray(picture)


def test_a_strip_has_a_row_a_view(strip: np.ndarray) -> None:
    assert strip.shape == (2 * WIDTH_PX * 3 // 4, SHOWN * WIDTH_PX, 3)


def test_frames_differ_and_limbs_are_drawn_in_each(strip: np.ndarray) -> None:
    """The left limbs' colour is in every frame; somebody who moves looks different in the next."""
    frames = np.split(strip[: WIDTH_PX * 3 // 4], SHOWN, axis=1)
    for frame, following in pairwise(frames):
        assert np.abs(frame.astype(int) - following).mean() > 0.1
    for frame in frames:
        red, _, blue = (frame[..., i].astype(int) for i in range(3))
        assert np.abs(red - blue).max() > 60
