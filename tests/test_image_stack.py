"""What a stack of pictures says, held against numpy's own median and sums (P3, T7)."""

import numpy as np
import pytest

from viewer.background.image_stack import CHANGES, LUMA, median, overlaid, squares


@pytest.mark.parametrize("count", [1, 2, 3, 8, 9])
@pytest.mark.parametrize("kind", [np.uint8, np.float32])
def test_the_median_is_numpys(count: int, kind: type) -> None:
    pictures: np.ndarray = (
        np.random.default_rng(count).uniform(0, 255, (count, 5, 7, 3)).astype(kind)
    )
    given = pictures.copy()
    np.testing.assert_array_equal(median(pictures), np.median(pictures, axis=0).astype(np.float32))
    np.testing.assert_array_equal(pictures, given)


def test_brightness_and_colour_share_the_squares_of_a_deviation() -> None:
    deviations = np.random.default_rng(1).normal(0, 9, (6, 4, 5, 3)).astype(np.float32)
    luma = deviations @ LUMA
    colour = deviations - luma[..., None]
    found = squares(deviations)
    np.testing.assert_allclose(found[..., 0], (luma**2).sum(axis=0), rtol=1e-5)
    np.testing.assert_allclose(found[..., 1], (colour**2).sum(axis=(0, 3)) / 2, rtol=1e-5)


@pytest.mark.parametrize("count", [1, 2, 7, 8])
def test_pictures_laid_over_each_other_are_numpys_mean_and_median(count: int) -> None:
    rng = np.random.default_rng(count)
    frames = rng.integers(0, 256, (count, 5, 7, 3), np.uint8)
    lights = rng.uniform(0.8, 1.2, (count, 3)).astype(np.float32)
    even = np.asarray(frames / lights[:, None, None], np.float32)
    found = overlaid(frames, lights)
    np.testing.assert_array_equal(found.mean, even.mean(axis=0))
    np.testing.assert_array_equal(found.median, np.median(even, axis=0).astype(np.float32))
    np.testing.assert_allclose(found.squares, squares(even - found.mean), rtol=1e-5, atol=1e-6)
    off = np.abs((even - found.median) @ LUMA)
    assert np.array_equal(found.moving, off > CHANGES)
