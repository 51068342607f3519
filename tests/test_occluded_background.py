"""The room of busy clips, held against rooms that are drawn here and rooms that are known (T7)."""

import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from spoiling import film_of
from test_background import HEIGHT, WIDTH, passer_by, room, shot, walker

from viewer.background.occluded_background import (
    NoSegments,
    _alike,
    _filled,
    _held,
    _shown_median,
    bridged,
    estimated_of,
    learn_around,
    learn_uncovered,
)


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
    with pytest.raises(
        NoSegments, match=r"tritrack\[single\].*cameras.cam1.background.*--background"
    ):
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


def test_a_held_stretch_is_drawn_from_its_two_ends() -> None:
    """By hand: 10 to 40 in thirds; at the border the known end goes on; a row that is all held
    stays."""
    picture = np.zeros((4, 6, 3), np.float32)
    picture[:, :2], picture[:, 4:] = 10.0, 40.0
    held = np.zeros((4, 6), np.bool_)
    held[0, 2:4] = held[1, :3] = held[2] = True
    found = bridged(picture, held)[..., 1]
    assert found[0].tolist() == pytest.approx([10.0, 10.0, 20.0, 30.0, 40.0, 40.0])
    assert found[1].tolist() == [0.0, 0.0, 0.0, 0.0, 40.0, 40.0]
    assert found[2].tolist() == found[3].tolist() == [10.0, 10.0, 0.0, 0.0, 40.0, 40.0]


def test_the_median_is_of_the_frames_that_show_a_pixel() -> None:
    """Levels 10, 20, 40, 80: all, then three, two, one and none of them."""
    even = np.ones((4, 1, 5, 3), np.float32) * np.array([10, 20, 40, 80])[:, None, None, None]
    hidden = np.zeros((4, 1, 5), np.bool_)
    hidden[0, 0, 1] = hidden[:2, 0, 2] = hidden[[0, 1, 3], 0, 3] = hidden[:, 0, 4] = True
    found = _shown_median(even.astype(np.float32), hidden, np.count_nonzero(~hidden, axis=0))
    assert found[0, :, 0].tolist() == [30.0, 40.0, 60.0, 40.0, 30.0]


def test_what_a_tenth_of_the_frames_show_near_the_guess_is_believed() -> None:
    """Of 20 frames two show 106 where 100 is guessed: their mean; where one does, the guess is."""
    even = np.full((20, 1, 9, 3), 200.0, np.float32)
    even[:, 0, [0, 1, 2, 6, 7, 8]] = 100.0
    even[:2, 0, 3], even[:1, 0, 4], even[:5, 0, 5] = 106.0, 106.0, 113.0
    centre = np.median(even, axis=0).astype(np.float32)
    held = np.zeros((1, 9), np.bool_)
    held[0, 3:6] = True
    background, uncertain = _filled(even, centre, held)
    assert background[0, :, 2].tolist() == pytest.approx(
        [100.0] * 3 + [106.0, 100.0, 100.0] + [100.0] * 3
    )
    assert uncertain[0].tolist() == [False] * 4 + [True] * 2 + [False] * 3


def test_the_spread_of_what_is_held_is_that_of_the_rest_and_of_a_guess_four() -> None:
    """How far frames are off counts while they are calm, by less than twelve grey levels."""
    off = np.zeros((5, 20, 30, 3), np.float32)
    off[:, ::2] = 3.0
    off[::2] *= -1.0
    off[:, :, 20:] = 50.0
    away = np.abs(off).max(axis=3)
    held = np.zeros((20, 30), np.bool_)
    held[:, :10] = True
    uncertain = held.copy()
    uncertain[:, 5:] = False
    background = np.full((20, 30, 3), 90.0, np.float32)
    found = estimated_of(off, away, background, held, uncertain)
    plain = estimated_of(off, away, background, np.zeros_like(held), np.zeros_like(held))
    assert found.centre is background
    rest = np.median(plain.spread[~held], axis=0)
    assert found.spread[4, 7] == pytest.approx(rest)
    assert found.spread[4, 2] == pytest.approx(np.maximum(rest, 4.0))
    assert found.spread[~held] == pytest.approx(plain.spread[~held])
    assert plain.spread[10, 27] == pytest.approx([1.0, 2.5])  # not calm: it says nothing
    assert np.array_equal(found.uncertain, uncertain)


def test_segments_that_reach_out_of_a_place_are_background_in_their_colour_alone() -> None:
    """A wall that half lies outside, a trunk inside with the legs below it, and a stain on the
    wall's part of the place."""
    labels = np.zeros((40, 50), np.int64)
    labels[8:30, 20:28] = 1
    labels[12:32, 40:44] = 2
    centre = np.full((40, 50, 3), 100.0, np.float32)
    centre[labels == 1] = 60.0
    centre[5:8, 20:28] = 160.0
    hull = np.zeros((40, 50), np.bool_)
    hull[5:22, 16:32] = True
    held = _held(centre, labels, hull)
    assert held[labels == 1].all()
    assert held[5:8, 20:28].all()
    assert not held[8:22, 16:20].any()
    assert not held[labels == 2].any()
    assert held.sum() == (labels == 1).sum() + 24


def test_a_pixel_is_alike_within_the_spread_of_its_segments_colour_where_that_is_known() -> None:
    """By hand: levels 90 and 110 by halves, a spread of 10: 2.5 of it and twelve more are 37."""
    labels = np.zeros((1, 8), np.int64)
    centre = np.full((1, 8, 3), 100.0, np.float32)
    centre[0, :, 1] = [90, 110, 90, 110, 136.5, 137.5, 63.5, 62.5]
    where = np.zeros((1, 8), np.bool_)
    where[0, :4] = True
    assert _alike(centre, labels, where)[0].tolist() == [True] * 5 + [False, True, False]
