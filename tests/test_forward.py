"""The forward algorithm, held against the sum over all paths."""

from itertools import pairwise, product

import numpy as np
import pytest

from recognizer.forward import forward


def models(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two models of three states, and logs of what five observations are worth in each state."""
    rng = np.random.default_rng(seed)
    logs = rng.normal(0.0, 3.0, (5, 2, 3))
    return rng.dirichlet(np.ones(3), 2), rng.dirichlet(np.ones(3), (2, 3)), logs


def by_all_paths(start: np.ndarray, transition: np.ndarray, logs: np.ndarray) -> np.ndarray:
    total = np.zeros(len(start))
    for path in product(range(start.shape[1]), repeat=len(logs)):
        seen = np.exp(sum(logs[at, :, state] for at, state in enumerate(path)))
        way = start[:, path[0]]
        for i, j in pairwise(path):
            way = way * transition[:, i, j]
        total += way * seen
    return np.asarray(np.log(total))


@pytest.mark.parametrize("seed", range(3))
def test_forward_is_the_sum_over_all_paths(seed: int) -> None:
    """Rabiner 1989, eq. (13)."""
    given = models(seed)
    assert forward(*given) == pytest.approx(by_all_paths(*given), abs=1e-10)


def test_a_state_that_cannot_be_reached_says_nothing_however_likely() -> None:
    start, transition, logs = models(3)
    start[:], transition[:, :, 1] = [1.0, 0.0, 0.0], 0.0
    logs[:, :, 1] = 800.0
    transition /= transition.sum(axis=2, keepdims=True)
    without = logs.copy()
    without[:, :, 1] = -800.0
    assert forward(start, transition, logs) == pytest.approx(forward(start, transition, without))


def test_a_long_sequence_stays_within_floating_point() -> None:
    start, transition, _ = models(4)
    logs = np.full((2000, 2, 3), -50.0)
    assert forward(start, transition, logs) == pytest.approx([-100_000.0] * 2)


def test_of_nothing_the_logarithm_is_nought() -> None:
    start, transition, logs = models(5)
    assert forward(start, transition, logs[:0]).tolist() == [0.0, 0.0]
