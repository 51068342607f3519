"""Bootstrap intervals of accuracy figures over the choice of clips."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

DRAWN: Final = 1000
"""Number of bootstrap samples."""
BETWEEN: Final = (2.5, 97.5)
"""Percentiles of the results: 95 % intervals."""
SEED: Final = 0


def intervals(clips: Sequence[Vector]) -> dict[str, tuple[float, float]]:
    """95 % intervals of the mean, the median and the 95th percentile of values of many clips.

    Clips are drawn with replacement: errors within one clip are correlated, so drawing single
    values would make intervals far too narrow. Clips of one person are correlated too; with few
    people the intervals are too narrow for other people.

    Args:
        clips: For each clip all its values; an empty one counts as a clip without values.

    Returns:
        By the names of `accuracy.spread`; empty with less than two clips with values.
    """
    held = [clip.ravel() for clip in clips if clip.size]
    if len(held) < 2:
        return {}
    counts = np.array([len(clip) for clip in held], float)
    sums = np.array([clip.sum() for clip in held])
    values, clip_of = np.concatenate(held), np.repeat(np.arange(len(held)), counts.astype(int))
    order = values.argsort()
    values, clip_of = values[order], clip_of[order]
    rng = np.random.default_rng(SEED)
    drawn = rng.multinomial(len(held), np.full(len(held), 1 / len(held)), size=DRAWN)
    told = np.array([_figures(times, counts, sums, values, clip_of) for times in drawn])
    low, high = np.percentile(told, BETWEEN, axis=0).tolist()
    return dict(zip(("mean", "median", "p95"), zip(low, high, strict=True), strict=True))


def _figures(
    times: NDArray[np.int64],
    counts: Vector,
    sums: Vector,
    values: Vector,
    clip_of: NDArray[np.int64],
) -> tuple[float, float, float]:
    """Mean, median and 95th percentile with the given multiplicity of each clip."""
    below = times[clip_of].cumsum()
    median, p95 = values[below.searchsorted([0.5 * below[-1], 0.95 * below[-1]])].tolist()
    return float(times @ sums / (times @ counts)), median, p95
