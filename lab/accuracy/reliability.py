"""Reliability of the confidence: how often joints of a given confidence are near the truth."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.npz_file import Facts
from lab.accuracy.accuracy import JOINTS, Compared

NEAR_MM: Final = 50.0
"""Distance, mm, within which a joint lies with probability c, if its confidence is c."""
BINS: Final = 10
"""Number of bins of equal width, from 0 to 1."""
COUNTS: Final = 0.01
"""Share of all joints that a bin needs to count."""


def trust(clips: Sequence[Compared]) -> Facts:
    """Reliability of all joints together and area under the ROC curve of each, for NEAR_MM."""
    confidence = np.concatenate([clip.confidence for clip in clips])
    near = np.concatenate([clip.off_mm for clip in clips]) < NEAR_MM
    bins = reliability(confidence, near)
    return {
        "near_mm": NEAR_MM,
        "near": float(near.mean()) if near.size else np.nan,
        "bins": bins,
        "gap": gap(bins, near.size),
        "auc": {
            **{name: auc(confidence[:, i], near[:, i]) for i, name in enumerate(JOINTS)},
            "all": auc(confidence, near),
        },
    }


def reliability(confidence: Vector, near: NDArray[np.bool_]) -> list[dict[str, float]]:
    """For each bin of confidence: from, to, count, mean confidence, share of near joints."""
    edges = np.linspace(0.0, 1.0, BINS + 1)
    place = np.clip((confidence.ravel() * BINS).astype(int), 0, BINS - 1)
    counts = np.bincount(place, minlength=BINS)
    said = np.bincount(place, confidence.ravel(), BINS)
    came = np.bincount(place, near.ravel(), BINS)
    return [
        {
            "from": float(edges[i]),
            "to": float(edges[i + 1]),
            "count": int(counts[i]),
            "confidence": float(said[i] / counts[i]) if counts[i] else np.nan,
            "near": float(came[i] / counts[i]) if counts[i] else np.nan,
        }
        for i in range(BINS)
    ]


def gap(bins: Sequence[dict[str, float]], joints: int) -> float:
    """Largest difference between share and confidence of a bin that counts; NaN without any."""
    gaps = [abs(one["confidence"] - one["near"]) for one in bins if one["count"] > COUNTS * joints]
    return max(gaps, default=np.nan)


def auc(confidence: Vector, near: NDArray[np.bool_]) -> float:
    """Probability that a near joint has more confidence than a far one.

    Ties count half: a constant has 0.5. NaN where all are near, or none.

    Source: Mann & Whitney 1947: the statistic U over its greatest value.
    """
    hits, all_of_them = int(near.sum()), near.size
    if hits in (0, all_of_them):
        return np.nan
    _, place, ties = np.unique(confidence.ravel(), return_inverse=True, return_counts=True)
    ranks = (np.cumsum(ties) - (ties - 1) / 2)[place][near.ravel()]
    return float((ranks.sum() - hits * (hits + 1) / 2) / (hits * (all_of_them - hits)))


def roc(confidence: Vector, near: NDArray[np.bool_]) -> tuple[Vector, Vector]:
    """The ROC curve from (0, 0) to (1, 1): shares of the far and of the near at each threshold.

    Equal confidences are one point, so the area below is the value of `auc`.
    """
    order = np.argsort(-confidence.ravel(), kind="stable")
    said, came = confidence.ravel()[order], near.ravel()[order]
    last = np.append(np.flatnonzero(np.diff(said)), said.size - 1)
    hits, misses = np.cumsum(came)[last], np.cumsum(~came)[last]
    start = np.zeros(1)
    return (
        np.concatenate([start, misses / max(int(misses[-1]), 1)]),
        np.concatenate([start, hits / max(int(hits[-1]), 1)]),
    )
