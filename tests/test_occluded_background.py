"""The room of busy clips, held against rooms that are drawn here and rooms that are known (T7)."""

import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from spoiling import film_of
from test_background import HEIGHT, WIDTH, passer_by, room, shot, walker

from viewer.background.occluded_background import NoSegments, learn_around, learn_uncovered


def test_room_behind_somebody_who_never_leaves_is_guessed_and_says_so() -> None:
    """T7: a spot that is never seen is flagged, not silently taken for room."""
    learnt = learn_uncovered([shot(walker(n), 2.0, n) for n in range(40)])
    trunk = np.zeros((HEIGHT, WIDTH), np.bool_)
    trunk[38:60, 76:85] = True
    assert learnt.uncertain[trunk].mean() > 0.8
    around = np.zeros((HEIGHT, WIDTH), np.bool_)
    around[25:90, 64:97] = True
    assert learnt.uncertain[~around].mean() < 0.01
    off = np.abs(learnt.centre - room()).mean(axis=-1)
    assert np.median(off[trunk]) < 20
    assert np.median(off[~around]) < 2


def test_room_behind_somebody_who_passes_is_seen() -> None:
    """T7: where the person walks on, the background is right within 5 grey levels."""
    learnt = learn_uncovered([shot(passer_by(n), 2.0, n) for n in range(30)])
    assert np.abs(learnt.centre - room()).mean(axis=-1).max() < 5
    assert not learnt.uncertain.any()


def stander(frame: int) -> np.ndarray:
    """Somebody whose arms swing while trunk and legs only sway by a pixel."""
    picture, sway = room(), int(frame % 15 < 5)
    cv2.rectangle(picture, (72 + sway, 30), (88 + sway, 70), (25, 20, 20), -1)
    for side in (-1, 1):
        left = 77 + side * 5 + sway
        cv2.rectangle(picture, (left, 71), (left + 6, 108), (60, 40, 90), -1)
        swing = int(14 * np.sin(frame / 2))
        cv2.line(picture, (80 + side * 8, 36), (80 + side * (20 + swing), 60), (60, 80, 110), 5)
    return picture


def test_legs_that_only_sway_are_not_absorbed() -> None:
    """T7: who stands sways; what lies within such edges is flagged, not taken for room."""
    learnt = learn_uncovered([shot(stander(n), 2.0, n) for n in range(40)])
    legs = np.zeros((HEIGHT, WIDTH), np.bool_)
    legs[74:104, 74:77] = legs[74:104, 85:88] = True
    assert learnt.uncertain[legs].mean() > 0.8
    assert learnt.uncertain[:, :40].mean() < 0.01


def test_without_the_library_the_cure_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "skimage.segmentation", None)
    with pytest.raises(NoSegments, match=r"tritrack\[single\].*camera_1.background.*--background"):
        learn_uncovered([shot(walker(n), 2.0, n) for n in range(4)])


@pytest.mark.parametrize("name", ["r01_t1_04_walk_slow_bigswing", "r04_t1_07_raise_both_lateral"])
def test_background_of_clips_whose_empty_frames_are_withheld(data_dir: Path, name: str) -> None:
    """T7: within 5 grey levels of the true empty room where it was ever uncovered."""
    film = film_of(data_dir / "dev" / name / "cam1.avi")
    film = [cv2.resize(each, (160, 120), interpolation=cv2.INTER_AREA) for each in film]
    true = np.median(np.stack(film[:9]), axis=0)
    learnt = learn_uncovered(film[9::2])
    off = np.abs(learnt.centre - true).mean(axis=-1)
    assert off[~learnt.uncertain].mean() <= 5
    assert learnt.uncertain.any()


def test_a_pixel_that_two_frames_show_is_half_way_between_them() -> None:
    frames = [np.full((40, 60, 3), 128, np.uint8) for _ in range(3)]
    for frame, level in zip(frames, (100, 140, 30), strict=True):
        frame[10:14, 10:14] = level
    covered = [np.zeros((40, 60), np.uint8) for _ in frames]
    covered[2][10:14, 10:14] = 1
    room = learn_around(frames, covered)
    assert room.centre[12, 12] == pytest.approx([120.0] * 3, abs=0.5)
    assert not room.uncertain.any()
