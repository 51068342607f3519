"""What tells that a clip opens with the empty room, held against rooms drawn here and clips."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from test_background import HEIGHT, WIDTH, passer_by, room, shot, walker

from common.video.pictures import Image
from viewer.background import empty_opening
from viewer.background.background import overlaid_opening, slopes
from viewer.background.empty_opening import (
    _brightness,
    _contour,
    _steeper,
    is_empty_opening,
    is_still,
)
from viewer.background.image_stack import CHANGES, LUMA


def test_somebody_who_runs_through_the_opening_is_no_empty_room() -> None:
    """Their median is the empty room, and would leave them unseen in those frames."""
    assert is_still(overlaid_opening([shot(room(), 2.0, n) for n in range(8)]))
    assert not is_still(overlaid_opening([shot(passer_by(n), 2.0, n) for n in range(5, 13)]))


def test_opening_is_empty_until_somebody_stands_in_it() -> None:
    clip = [shot(room(), 2.0, n) for n in range(8)] + [shot(walker(n), 2.0, n) for n in range(40)]
    assert is_empty_opening(overlaid_opening(clip[:8]), clip[::4])
    assert not is_empty_opening(overlaid_opening(clip[8:16]), clip[8::4])


@pytest.mark.parametrize("name", ["r01_t1_12_squat", "r07_t1_08_raise_both_forward_up"])
@pytest.mark.parametrize("camera", [1, 2])
def test_opening_of_the_development_clips(data_dir: Path, name: str, camera: int) -> None:
    """Frames 0-8 show the empty room; from frame 9 on somebody is there."""
    video = cv2.VideoCapture(str(data_dir / "dev" / name / f"cam{camera}.avi"))
    clip: list[Image] = []
    while (read := video.read())[0]:
        clip.append(cv2.resize(read[1], (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA))
    assert is_empty_opening(overlaid_opening(clip[:8]), clip[::4])
    assert not is_empty_opening(overlaid_opening(clip[9:17]), clip[9::4])


def test_brightness_is_of_the_light_that_is_asked_for() -> None:
    """By numpy: blue, green and red in their shares of what each channel's light was."""
    rng = np.random.default_rng(3)
    frame = rng.integers(0, 256, (7, 9, 3), dtype=np.uint8)
    shares = (LUMA / (1.2, 0.9, 0.7)).astype(np.float32)
    background = rng.uniform(40, 200, (7, 9)).astype(np.float32)
    luma, differs = _brightness(frame, shares, background)
    assert luma == pytest.approx(frame @ shares, rel=1e-5)
    assert np.array_equal(differs, abs(frame @ shares - background) > CHANGES)


def test_the_window_of_a_contour_reaches_a_pixel_beyond_the_regions() -> None:
    regions = np.zeros((20, 30), np.uint8)
    regions[4:9, 6:10] = regions[7:12, 15:18] = 1
    contour, top, left = _contour(regions)
    whole = cv2.morphologyEx(regions, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8))
    assert (top, left) == (3, 5)
    assert np.array_equal(contour, whole[3:13, 5:19])
    regions[0, 0] = 1
    contour, top, left = _contour(regions)
    assert (top, left) == (0, 0)
    assert contour.shape == (14, 20)


def test_contours_are_steeper_and_flatter_by_sobels_slopes() -> None:
    """Against OpenCV's Sobel, whose border is mirrored too."""
    rng = np.random.default_rng(4)
    luma, background = rng.uniform(0, 200, (2, 8, 11)).astype(np.float32)
    contour = rng.integers(0, 2, (6, 7), dtype=np.uint8)
    for top, left in ((0, 0), (2, 4), (2, 0), (0, 4)):
        more = (slopes(luma) - slopes(background))[top : top + 6, left : left + 7][contour > 0]
        steeper, flatter = _steeper(contour, top, left, luma, background)
        assert steeper == pytest.approx(more.clip(min=0).sum(), rel=1e-4)
        assert flatter == pytest.approx(-more.clip(max=0).sum(), rel=1e-4)


@pytest.mark.parametrize(("flatter", "empty"), [(45.0, True), (46.0, False)])
def test_an_opening_is_judged_by_the_contours_of_all_frames(
    monkeypatch: pytest.MonkeyPatch, flatter: float, empty: bool
) -> None:
    """45 % of what the frames have, added up: 60 and 40 of these against 20 and the rest."""
    told = [(60.0, 20.0), (40.0, flatter - 20.0)]
    monkeypatch.setattr(empty_opening, "_steeper", lambda *_: told.pop(0))
    clip = [shot(room(), 2.0, n) for n in range(3)]
    assert (
        is_empty_opening(overlaid_opening(clip), [shot(walker(n), 2.0, n) for n in (0, 5)]) == empty
    )


@pytest.mark.parametrize("light", [(1.3, 1.3, 1.3), (0.7, 0.8, 0.9)])
def test_an_opening_is_judged_under_the_light_of_each_frame(
    light: tuple[float, float, float],
) -> None:
    """Who stays in a clip whose light changes: empty before, and not where they stood."""
    empty = [shot(room(), 2.0, n) for n in range(4)]
    later = [shot(walker(n) * light, 2.0, n) for n in range(0, 40, 8)]
    assert is_empty_opening(overlaid_opening(empty), later)
    begun = [shot(walker(0), 2.0, n) for n in range(4)]
    gone = [shot(room() * light, 2.0, n) for n in range(5)]
    assert not is_empty_opening(overlaid_opening(begun), gone)
