"""Pictures made smaller: as JPEG, for the page."""

import cv2
import numpy as np

from common.video.reduction import jpeg_of


def test_a_picture_comes_back_as_it_was_within_jpegs_loss() -> None:
    """Blue, green, red stay in their order; a smooth picture keeps its grey levels."""
    picture = np.zeros((120, 160, 3), np.uint8)
    picture[..., 0] = np.linspace(0, 255, 160, dtype=np.uint8)
    picture[..., 2] = np.linspace(0, 255, 120, dtype=np.uint8)[:, None]
    back = cv2.imdecode(np.frombuffer(jpeg_of(picture), np.uint8), cv2.IMREAD_COLOR)
    assert back is not None
    assert back.shape == picture.shape
    assert np.abs(back.astype(int) - picture).mean() < 4


def test_a_picture_is_small_enough_to_publish_beside_the_reports() -> None:
    """Noise is the worst case; 160x120 raw are 57.6 kB, a message may have 1 MB."""
    noise = np.random.default_rng(0).integers(0, 256, (120, 160, 3), np.uint8)
    assert len(jpeg_of(noise)) < 57_600
