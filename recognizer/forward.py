"""The forward algorithm for all postures at once, compiled: it runs at every live frame."""

import math

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats
from common.compiled import compiled


@compiled
def forward(
    start: NDArray[np.float64], transition: NDArray[np.float64], log_emission: NDArray[np.float64]
) -> Floats:
    """log P(observations | posture), shape (p,); 0 without observations.

    Each step is divided by its sum, and the densities by their maximum; the logarithms are summed,
    so that a sequence of any length stays within floating point.

    Args:
        start: (p, s) probabilities.
        transition: (p, s, s) probabilities: from, to.
        log_emission: (n, p, s) log of probability or density of each observation.

    Source: Rabiner 1989, section III A and V A (P57).
    """
    n, postures, states = log_emission.shape
    total = np.zeros(postures)
    state, arrived = np.empty(states), np.empty(states)
    for p in range(postures):
        for at in range(n):
            for j in range(states):
                arrived[j] = start[p, j] if at == 0 else 0.0
            if at > 0:
                for i in range(states):
                    for j in range(states):
                        arrived[j] += state[i] * transition[p, i, j]
            largest = -math.inf
            for j in range(states):
                if arrived[j] > 0.0:
                    largest = max(largest, log_emission[at, p, j])
            norm = 0.0
            for j in range(states):
                if arrived[j] > 0.0:
                    arrived[j] *= math.exp(log_emission[at, p, j] - largest)
                norm += arrived[j]
            for j in range(states):
                state[j] = arrived[j] / norm
            total[p] += math.log(norm) + largest
    return total
