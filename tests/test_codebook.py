"""The quantiser, held against the paper's size of it and a plain search for the nearest word."""

import numpy as np
import pytest
from acting import performances

from recognizer.codebook import SYMBOLS, WEIGHTS, LearningError, fit, symbols
from recognizer.features import FEATURE_NAMES, features


@pytest.fixture(scope="module")
def seen() -> np.ndarray:
    sequences = performances(range(2))
    return features(np.concatenate([one for given in sequences.values() for one in given]))


def test_there_are_64_symbols_and_all_are_used(seen: np.ndarray) -> None:
    """P57."""
    codebook = fit(seen)
    assert codebook.shape == (64, 16)
    assert SYMBOLS == 64
    assert set(symbols(codebook, seen).tolist()) == set(range(64))


def test_a_symbol_is_the_nearest_codeword(seen: np.ndarray) -> None:
    codebook = fit(seen)
    distances = np.linalg.norm((seen * WEIGHTS)[:, np.newaxis] - codebook, axis=2)
    chosen = distances[np.arange(len(seen)), symbols(codebook, seen)]
    assert chosen == pytest.approx(distances.min(axis=1), abs=1e-7)


def test_each_codeword_is_the_mean_of_what_it_stands_for(seen: np.ndarray) -> None:
    """The condition of Lloyd for a codebook that no small change makes better."""
    codebook = fit(seen)
    given = symbols(codebook, seen)
    means = np.stack([(seen * WEIGHTS)[given == symbol].mean(axis=0) for symbol in range(SYMBOLS)])
    assert np.abs(means - codebook).max() < 0.02


def test_the_same_vectors_give_the_same_codewords_bit_for_bit(seen: np.ndarray) -> None:
    assert fit(seen, seed=3).tobytes() == fit(seen, seed=3).tobytes()
    assert fit(seen, seed=3).tobytes() != fit(seen, seed=4).tobytes()


def test_too_few_poses_are_refused_with_the_cure(seen: np.ndarray) -> None:
    few = np.repeat(seen[:63], 10, axis=0)
    with pytest.raises(ValueError, match=r"63 different poses are too few for 64 .* more clips"):
        fit(few)


def test_no_feature_gives_no_symbol(seen: np.ndarray) -> None:
    assert symbols(fit(seen), seen[:0]).shape == (0,)


def test_a_hip_counts_three_times_an_arm_and_ties_go_to_the_lower_number() -> None:
    words = np.zeros((3, 16))
    hip, elbow = FEATURE_NAMES.index("r_hip_up"), FEATURE_NAMES.index("l_elbow_sin")
    words[1, hip], words[2, elbow] = 3.0, 1.0
    vectors = np.zeros((4, 16))
    vectors[1, hip] = 0.51
    vectors[2, hip], vectors[2, elbow] = 0.5, 0.4
    vectors[3, elbow] = 0.51
    assert symbols(words, vectors).tolist() == [0, 1, 0, 2]


def test_fewer_poses_than_symbols_are_counted() -> None:
    vectors = np.tile(np.eye(16)[:5], (20, 1))
    with pytest.raises(LearningError, match="5 different poses are too few for 6 symbols: give"):
        fit(vectors, count=6)
    assert fit(vectors, count=5).shape == (5, 16)
