"""Waves over a surface."""

import numpy as np

from synth.anny_people.folds import RATE, folds


def test_waves_are_as_high_and_as_steep_as_said() -> None:
    line = np.zeros((4001, 3))
    line[:, 0] = np.linspace(0.0, 4.0, len(line))
    for seed in range(10):
        height = folds(line, np.random.default_rng(seed))
        assert np.abs(height).max() <= 2.0
        assert np.abs(np.diff(height) / 0.001).max() < 2.0 * RATE[1]


def test_waves_of_another_cloth_differ() -> None:
    places = np.random.default_rng(0).normal(size=(200, 3))
    one, other = (folds(places, np.random.default_rng(seed)) for seed in (1, 2))
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.3
