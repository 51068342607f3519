"""Where in the median picture of a clip somebody may stand: scenes painted by hand."""

from collections.abc import Sequence

import numpy as np
import pytest

from viewer.background.background import large_regions
from viewer.background.median_people import occupied

HIGH, WIDE, N = 60, 80, 20
GREY, BODY = 90.0, 180.0


def clip(places: Sequence[int | None]) -> np.ndarray:
    """A grey room; somebody 10 px wide and 36 high stands at these columns, one a frame."""
    frames = np.full((len(places), HIGH, WIDE, 3), GREY, np.float32)
    for frame, left in zip(frames, places, strict=True):
        if left is not None:
            frame[15:51, left : left + 10] = BODY
    return frames


def found(frames: np.ndarray, stays: bool = False) -> np.ndarray:
    centre = np.median(frames, axis=0).astype(np.float32)
    away = np.abs((frames - centre) @ np.array([0.114, 0.587, 0.299], np.float32))
    return occupied(frames, centre, away.astype(np.float32), stays)


def test_who_stands_in_the_median_and_leaves_is_where_they_stood() -> None:
    """Twelve of twenty frames at one place, then across the picture."""
    mask = found(clip([20] * 12 + [34, 40, 46, 52, 58, 62, 66, 70]))
    assert mask[15:51, 20:30].all()
    assert not mask[:, 45:].any()
    rows, columns = np.nonzero(mask)
    assert (rows.min(), rows.max()) == pytest.approx((14, 51), abs=1)
    assert columns.min() == pytest.approx(19, abs=1)


def test_who_walks_through_is_nowhere_in_the_median() -> None:
    assert not found(clip([*range(2, 62, 3)])).any()


def test_who_sways_on_the_spot_counts_only_where_that_is_asked() -> None:
    """Their place shows the room half of the time: contours alone do not tell."""
    frames = clip([30, 31, 32, 31] * 5)
    assert found(frames, stays=True)[20:45, 31:40].any()
    assert found(clip([None] * N), stays=True).sum() == 0


def test_what_is_lower_than_a_tenth_of_the_picture_is_no_region() -> None:
    mask = np.zeros((HIGH, WIDE), bool)
    mask[4:9, 5:25] = True
    mask[20:26, 5:9] = True
    mask[22:24, 6:8] = False
    mask[30:32, 60:62] = True
    kept = large_regions(mask)
    assert not kept[:12].any()
    assert kept[20:26, 5:9].all(), "six rows, its hole closed"
    assert not kept[28:].any()
