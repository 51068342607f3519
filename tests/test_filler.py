"""How people stand, and how well a frame must fit, worked by hand."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from recognizer.filler import NORMAL_MAD, OPENING_POSES, VARIANCE_FLOOR, fit_of, standing


def test_standing_is_the_median_of_how_all_sequences_open() -> None:
    """Of two postures; one of three sequences was cut in its midst."""
    opening = [[[0.0], [1.0], [2.0]], [[1.0], [2.0], [3.0]], [[90.0], [90.0], [90.0]]]
    shown = [[np.array([*one, [500.0]]) for one in opening[:2]], [np.array(opening[2])]]
    mean, variance = standing(shown)
    assert len(opening[0]) == OPENING_POSES
    assert mean.tolist() == [2.0]
    assert variance == pytest.approx([(NORMAL_MAD * 1.0) ** 2])


def test_nobody_stands_more_exactly_than_is_tracked() -> None:
    _, variance = standing([[np.zeros((3, 2))]])
    assert variance.tolist() == [VARIANCE_FLOOR] * 2


def test_fit_is_the_median_of_sequences_means_at_the_likeliest_states() -> None:
    rng = np.random.default_rng(0)
    mean, variance = rng.normal(size=(2, 3)), rng.uniform(0.5, 2.0, (2, 3))
    shown = [rng.normal(size=(n, 3)) for n in (4, 5, 6)]
    logs = [
        np.stack([multivariate_normal(m, np.diag(v)).logpdf(one)
                  for m, v in zip(mean, variance, strict=True)])
        for one in shown
    ]  # fmt: skip
    expected = np.median([each.max(axis=0).mean() for each in logs])
    assert fit_of(shown, mean, variance) == pytest.approx(expected)
