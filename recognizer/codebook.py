"""The vector quantiser: 64 symbols that stand for all feature vectors."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from recognizer.features import FEATURE_NAMES, Features

Codebook = NDArray[np.float64]
"""The codewords: (SYMBOLS, 16); a symbol is the number of a row. Its space is that of
feature vectors times WEIGHTS."""

Symbols = NDArray[np.int64]

SYMBOLS: Final = 64
"""Size of the alphabet (section 5.1)."""

WEIGHTS: Final = np.array([3.0 if "_hip" in entry else 1.0 for entry in FEATURE_NAMES])
"""By how much an entry counts in distances. Legs move less than arms, and among 64 symbols too few
would distinguish their motions: with 1, 2, 3 and 4, and the best width of sharing for each, 352,
363, 374 and 369 of 420 held-out synthetic performances were named rightly."""

STARTS: Final = 4
"""Runs of k-means from different codewords; the tightest is kept."""


class LearningError(ValueError):
    """Clips that no model can be learnt from or tested on; the text says why and what to give."""


def fit(seen: Features, seed: int = 0, count: int = SYMBOLS) -> Codebook:
    """Codewords for the feature vectors (n, 16) of the people to learn from alone.

    k-means with a seed, in one thread: the same vectors give the same codewords, bit for bit. The
    paper does not say how its symbols were found (P57).

    Raises:
        LearningError: When fewer different vectors than symbols are given.
    """
    from sklearn.cluster import KMeans
    from threadpoolctl import threadpool_limits

    different = len(np.unique(seen, axis=0))
    if different < count:
        raise LearningError(
            f"{different} different poses are too few for {count} symbols: give more clips"
        )
    with threadpool_limits(1):
        found = KMeans(count, n_init=STARTS, random_state=seed).fit(seen * WEIGHTS)
    return np.asarray(found.cluster_centers_, np.float64)


def symbols(codebook: Codebook, seen: Features) -> Symbols:
    """The nearest codeword of each feature vector, shape (n,); the lower number where two tie."""
    apart = np.square(codebook).sum(axis=1) - 2.0 * (seen * WEIGHTS) @ codebook.T
    return np.argmin(apart, axis=1)
