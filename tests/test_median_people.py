"""Where in the median picture of a clip somebody may stand: scenes painted by hand."""

from collections.abc import Sequence

import numpy as np
import pytest

from viewer.background.background import large_regions, slopes
from viewer.background.median_people import _hulls, _in_median, _travelled, occupied

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


def test_what_flickers_all_the_time_has_to_change_by_more() -> None:
    """A screen 20 levels off in every frame is no change, somebody who is 50 off in half is."""
    frames = np.full((N, HIGH, WIDE, 3), GREY, np.float32)
    frames[:, 10:40, 50:70] += np.where(np.arange(N) % 2, 20.0, -20.0)[:, None, None, None]
    frames[::2, 10:40, 10:25] += 50.0
    centre = np.full((HIGH, WIDE, 3), GREY, np.float32)
    away = np.abs(frames[..., 0] - GREY)
    mask = occupied(frames, centre, away, True)
    assert mask[12:38, 12:23].all()
    assert not mask[:, 30:].any()
    mask = occupied(frames, centre, np.where(away == 20.0, 37.0, away), True)
    assert mask[12:38, 52:68].all()


def test_contours_are_in_the_median_where_it_is_steeper_there() -> None:
    """Against plain numpy: sums over the rims of what changes, and over half a person around."""
    rng = np.random.default_rng(3)
    even = rng.uniform(0, 200, (4, 30, 41, 3)).astype(np.float32)
    even[:, :, :20] *= 0.3
    centre = np.median(even, axis=0).astype(np.float32)
    centre[:, 22:] *= 0.4
    changed = np.zeros((4, 30, 41), np.uint8)
    for n, (top, left) in enumerate(((4, 3), (10, 25), (2, 20), (15, 9))):
        changed[n, top : top + 9, left : left + 7] = 1
    luma = np.array([0.114, 0.587, 0.299], np.float32)
    steep = slopes((centre @ luma).astype(np.float32))
    held, due = np.zeros((30, 41)), np.zeros((30, 41))
    for frame, own in zip(even, changed, strict=True):
        around = np.pad(own, 1, mode="edge")
        shifts = [around[i : i + 30, j : j + 41] for i in range(3) for j in range(3)]
        rim = np.max(shifts, axis=0) > np.min(shifts, axis=0)
        more = np.where(rim, slopes((frame @ luma).astype(np.float32)) - steep, 0.0)
        due += more.clip(min=0)
        held -= more.clip(max=0)
    sums = []
    for each in (held, due):  # windows of 9, a quarter of 30 rows, mirrored at the border
        wide = np.pad(each, 4, mode="reflect")
        shifted = [wide[i : i + 30, j : j + 41] for i in range(9) for j in range(9)]
        sums.append(np.sum(shifted, axis=0))
    found = _in_median(even, centre, changed)
    clear = abs(sums[0] - 0.45 * sums[1]) > 1.0
    assert np.array_equal(found[clear], (sums[0] > 0.45 * sums[1])[clear])
    assert found.any()
    assert not found.all()


def test_how_far_somebody_travels_is_told_by_the_middles_of_what_changes() -> None:
    """By hand: middles from 5.5 to 45.5 px, less a twentieth at either end; a speck of a fifth of
    the largest change does not count, and no other place does."""
    changed, own = np.zeros((21, 30, 60), np.uint8), np.zeros((30, 60), np.bool_)
    own[5:25] = True
    for n in range(21):
        changed[n, 10:20, 2 * n + 1 : 2 * n + 11] = 1
    assert _travelled(changed, own) == pytest.approx(36.0)
    specks = changed.copy()
    specks[0] = 0
    specks[0, 10:12, 50:60] = 1
    assert _travelled(specks, own) == pytest.approx(
        np.diff(np.quantile(2 * np.arange(1, 21), (0.05, 0.95)))[0]
    )
    changed[:, 26:30, :] = 1
    assert _travelled(changed, own) == pytest.approx(36.0)


def test_hulls_fill_what_a_region_encloses_and_join_what_all_but_touches() -> None:
    """One pixel in sixty rows is reached beyond."""
    regions = np.zeros((60, 80), np.uint8)
    regions[10:30, 10] = regions[29, 10:30] = 1
    regions[10:20, 50] = regions[10:20, 53] = 1
    found = _hulls(regions)
    assert found[28, 12]
    assert not found[12, 28]
    assert found[9:21, 49:55].all()
    assert (found.sum(axis=0) > 0).tolist() == [9 <= x <= 30 or 49 <= x <= 54 for x in range(80)]
