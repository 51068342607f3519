"""Silhouettes by the paper's own model, held against drawn people (P3, P4)."""

import numpy as np
import pytest
from test_silhouette import HEIGHT, WIDTH, body, dressed, room, shot

from common.config.part_settings import SilhouetteSettings
from common.method import PAPER
from common.raster.similarity import Mask
from viewer.background.background import Background, learn
from viewer.silhouette.printed_silhouette import printed
from viewer.silhouette.silhouette import State, init, step


def begun(sigma: float) -> State:
    empty = [shot(room(), sigma, seed) for seed in range(8)]
    return init(learn(empty), SilhouetteSettings(), PAPER)


def iou(one: Mask, other: Mask) -> float:
    return float((one & other).sum() / (one | other).sum())


@pytest.mark.parametrize("sigma", [1.0, 2.0, 4.0])
def test_noise_of_up_to_4_grey_levels_leaves_the_silhouette_as_printed(sigma: float) -> None:
    """P3: IoU of at least 0.95."""
    _, seen = step(begun(sigma), shot(dressed(room(), body()), sigma, 99), None)
    assert iou(seen.mask, body()) >= 0.95


@pytest.mark.parametrize("sigma", [0.0, 4.0])
def test_an_empty_scene_shows_nobody(sigma: float) -> None:
    state = begun(max(sigma, 0.1))
    for seed in range(20, 30):
        state, seen = step(state, shot(room(), sigma, seed), None)
        assert seen.box is None
        assert not seen.mask.any()


def test_of_two_regions_the_expected_one_is_taken_else_the_larger() -> None:
    """P4: both are counted."""
    small = np.zeros((HEIGHT, WIDTH), np.bool_)
    small[70:112, 15:25] = True
    picture = dressed(room(), body() | small)
    _, larger = step(begun(1.0), shot(picture, 1.0, 50), None)
    _, expected = step(begun(1.0), shot(picture, 1.0, 50), (20.0, 85.0))
    assert larger.blobs == expected.blobs == 2
    assert iou(larger.mask, body()) > 0.9
    assert iou(expected.mask, small) > 0.8


def test_a_brighter_picture_is_foreground_as_printed() -> None:
    """What our own silhouettes forgive, W4's range does not: why the departure is there."""
    brighter = np.clip(1.25 * shot(room(), 1.0, 60).astype(np.float32), 0, 255).astype(np.uint8)
    _, seen = step(begun(1.0), brighter, None)
    assert seen.mask.mean() > 0.3


EVEN = np.ones(3, np.float32)


def ranged(step: float = 2.0) -> Background:
    """An even wall of 90 to 110 grey levels, 60 by 100 pixels."""
    learnt = learn([np.full((60, 100, 3), 100, np.uint8)])
    return learnt._replace(
        low=learnt.centre - 10, high=learnt.centre + 10, step=np.full_like(learnt.step, step)
    )


def found_at(level: float, step: float = 2.0, gain: np.ndarray = EVEN) -> int:
    """How much of a square of 20 by 30 pixels, of a level, is foreground."""
    frame = np.full((60, 100, 3), 100, np.uint8) * 1
    frame[10:40, 20:40, 1] = level
    return int(printed(ranged(step), frame, gain, 5.0, None).mask[10:40, 20:40].sum())


@pytest.mark.parametrize(
    ("level", "step", "count"),
    [
        (131.0, 2.0, 600),
        (130.0, 2.0, 0),
        (69.0, 2.0, 600),
        (70.0, 2.0, 0),
        (136.0, 13.0, 0),
        (137.0, 13.0, 600),
    ],
)
def test_a_pixel_is_foreground_beyond_its_range_by_twenty_levels_or_twice_the_step(
    level: float, step: float, count: int
) -> None:
    """W4: brighter or darker, in one channel, both sides of the limit."""
    assert found_at(level, step) == count


def test_the_range_is_that_of_the_frames_light() -> None:
    assert found_at(131.0, gain=np.array([1.0, 1.05, 1.0], np.float32)) == 0


def test_regions_are_whole_but_for_what_shows_between_arm_and_trunk() -> None:
    """Holes of less than a thousandth of 6000 pixels are filled; a lower region is nobody."""
    frame = np.full((60, 100, 3), 100, np.uint8)
    frame[10:40, 20:50] = 200
    frame[15, 25] = 100  # closed
    frame[18:25, 30:40] = 100  # a hole of 70 pixels, 66 between its pixels' middles
    frame[50:54, 70:90] = 200
    wanted = np.zeros((60, 100), np.uint8)
    wanted[10:40, 20:50] = 1
    wanted[18:25, 30:40] = 0
    found = printed(ranged(), frame, EVEN, 5.0, None)
    assert found.blobs == 1
    assert np.array_equal(found.mask, wanted)
    assert printed(ranged(), frame, EVEN, 4.0, None).blobs == 2
    there = printed(ranged(), frame, EVEN, 4.0, (80.0, 52.0)).mask
    assert np.flatnonzero(there.any(axis=1)).tolist() == [50, 51, 52, 53]
    nobody = printed(ranged(), frame, EVEN, 31.0, None)
    assert (nobody.blobs, int(nobody.mask.sum())) == (0, 0)


@pytest.mark.parametrize(("side", "filled"), [(3, True), (7, False)])
def test_a_hole_is_filled_below_a_thousandth_of_the_picture(side: int, filled: bool) -> None:
    """Of 19200 pixels 19: between the pixels around a hole of three lie 16, of seven 64."""
    learnt = learn([np.full((120, 160, 3), 100, np.uint8)])
    frame = np.full((120, 160, 3), 100, np.uint8)
    frame[20:80, 30:90] = 200
    frame[40 : 40 + side, 50 : 50 + side] = 100
    found = printed(learnt, frame, EVEN, 5.0, None).mask
    assert found[41, 51] == int(filled)
    assert found[45, 49] == 1
