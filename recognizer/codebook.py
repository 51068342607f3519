"""The vector quantiser: 64 symbols for all feature vectors."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from recognizer.features import FEATURE_NAMES, Features

Codebook = NDArray[np.float64]
"""The codewords: (SYMBOLS, 16); a symbol is the index of a row. They are in the space of feature
vectors times WEIGHTS."""

Symbols = NDArray[np.int64]

SYMBOLS: Final = 64
"""Size of the alphabet (section 5.1)."""

WEIGHTS: Final = np.array([3.0 if "_hip" in entry else 1.0 for entry in FEATURE_NAMES])
"""Weight of each entry in distances. Legs move less than arms: with equal weights too few of 64
symbols would distinguish their motions. With 1, 2, 3 and 4, and the best width of sharing for
each, 352, 363, 374 and 369 of 420 held-out synthetic performances were recognised correctly."""

STARTS: Final = 4
"""Number of k-means runs from different codewords; the tightest result is kept."""


class LearningError(ValueError):
    """Clips that no model can be trained or tested on; the text names the cause and the cure."""


def fit(seen: Features, seed: int = 0, count: int = SYMBOLS) -> Codebook:
    """Codewords for the feature vectors (n, 16) of the training people alone.

    k-means with a seed, in one thread: the same vectors give the same codewords, bit for bit. The
    paper does not say how its symbols were found (P57).

    Raises:
        LearningError: When there are fewer distinct vectors than symbols.
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
    """The nearest codeword of each feature vector, shape (n,); ties go to the lower index."""
    apart = np.square(codebook).sum(axis=1) - 2.0 * (seen * WEIGHTS) @ codebook.T
    return np.argmin(apart, axis=1)
