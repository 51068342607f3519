"""Intervals hold what they are for: another draw of clips falls into them as often as they say."""

import numpy as np
import pytest

from lab.accuracy.intervals import intervals


def clips_of(rng: np.random.Generator, count: int) -> list[np.ndarray]:
    """Clips whose values go wrong together: each has a mean of its own."""
    return [rng.normal(20 + rng.normal(0, 5), 3, size=rng.integers(200, 400)) for _ in range(count)]


@pytest.mark.slow
def test_the_true_mean_lies_within_about_as_often_as_they_say() -> None:
    rng = np.random.default_rng(1)
    inside = 0
    for _ in range(100):
        low, high = intervals(clips_of(rng, 30))["mean"]
        inside += low <= 20 <= high
    assert inside >= 85, "95 % are promised; a bootstrap of 30 clips keeps a little less"


def test_values_alone_would_promise_far_too_much() -> None:
    clips = clips_of(np.random.default_rng(2), 30)
    low, high = intervals(clips)["mean"]
    values = np.concatenate(clips)
    alone = 2 * 1.96 * values.std() / np.sqrt(len(values))
    assert high - low > 8 * alone


def test_every_figure_lies_within_its_own() -> None:
    clips = clips_of(np.random.default_rng(3), 45)
    told, values = intervals(clips), np.concatenate(clips)
    figures = {"mean": values.mean(), "median": np.median(values), "p95": np.percentile(values, 95)}
    for name, figure in figures.items():
        low, high = told[name]
        assert low < figure < high


def test_clips_that_are_alike_leave_nothing_open() -> None:
    clip = np.arange(100.0)
    told = intervals([clip] * 5)
    assert list(told["mean"]) == pytest.approx([49.5, 49.5])
    assert list(told["p95"]) == pytest.approx([94.5, 94.5], abs=0.6)


@pytest.mark.parametrize("clips", [[], [np.arange(5.0)], [np.arange(5.0), np.empty(0)]])
def test_one_clip_tells_nothing_of_others(clips: list[np.ndarray]) -> None:
    assert intervals(clips) == {}
