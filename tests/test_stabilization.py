"""A trembling camera held still, against shifts and light that were put in (T2)."""

import cv2
import numpy as np
import pytest
from test_background import room, shot, walker

from viewer.background.image_stack import LUMA, Floats
from viewer.background.stabilization import Anchor, aligned, alignment_of, anchored, unaligned


def trembled(picture: np.ndarray, right: float, down: float, offset: float = 0.0) -> np.ndarray:
    """The picture as a camera sees it that points elsewhere, in another light."""
    turn = np.array([[1.0, 0.0, right], [0.0, 1.0, down]])
    size = (picture.shape[1], picture.shape[0])
    moved = cv2.warpAffine(picture, turn, size, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(np.clip(moved.astype(np.float64) + offset, 0, 255), np.uint8)


def film() -> list[np.ndarray]:
    return [
        trembled(shot(walker(n), 2.0, n), 1.5 * np.sin(n), 2.0 * np.cos(1.7 * n)) for n in range(24)
    ]


def luma_of(picture: np.ndarray) -> Floats:
    return np.asarray(picture @ LUMA, np.float32)


@pytest.fixture(scope="module")
def anchor() -> Anchor:
    found = anchored(film())
    assert found is not None
    return found


def test_a_camera_that_stands_still_is_left_alone() -> None:
    assert anchored([shot(walker(n), 2.0, n) for n in range(24)]) is None


@pytest.mark.parametrize(("right", "down"), [(1.0, 0.0), (-1.5, 1.5), (0.4, -2.5)])
def test_a_shift_is_found_whoever_stands_in_the_picture(
    anchor: Anchor, right: float, down: float
) -> None:
    """Within a quarter of a pixel, light of its own beside it."""
    at = alignment_of(anchor, luma_of(shot(walker(3), 2.0, 1)))
    off = alignment_of(anchor, luma_of(trembled(shot(walker(3), 2.0, 1), right, down, 12.0)))
    assert at.right_px - off.right_px == pytest.approx(right, abs=0.25)
    assert at.down_px - off.down_px == pytest.approx(down, abs=0.25)
    assert off.offset + 128 * off.gain - at.offset - 128 * at.gain == pytest.approx(12.0, abs=2.0)


def test_a_frame_is_laid_where_the_room_is_and_its_silhouette_back(anchor: Anchor) -> None:
    empty = trembled(room(), 2.0, -1.0, 15.0)
    place = alignment_of(anchor, luma_of(empty))
    flat = aligned(empty, place)[5:-5, 5:-5].astype(float)
    due = aligned(trembled(room(), 0.0, 0.0), alignment_of(anchor, luma_of(room())))[5:-5, 5:-5]
    assert np.abs(flat - due).mean() < 3.0
    assert np.abs(empty[5:-5, 5:-5].astype(float) - due).mean() > 10.0
    mask = np.zeros(empty.shape[:2], np.bool_)
    mask[40:60, 70:90] = True
    rows, columns = np.nonzero(unaligned(mask, place._replace(right_px=-2.0, down_px=1.0)))
    assert (rows.min(), columns.min()) == (39, 72)
