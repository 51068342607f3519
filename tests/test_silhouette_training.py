"""Learning silhouettes: what is taught, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from tritrack.training import silhouette_training
from tritrack.training.silhouette_training import (
    Examples,
    examples_of,
    films,
    fitted,
    train_silhouettes,
)
from tritrack.training.training import TrainingError
from viewer.silhouette.boundary_features import FEATURES
from viewer.silhouette.pixel_classifier import load, log_odds, save, shipped


def test_a_network_learns_a_feature_that_tells() -> None:
    """The third feature says it; features that never change do no harm."""
    rng = np.random.default_rng(3)
    features = np.zeros((4000, FEATURES), np.float32)
    features[:, :6] = rng.normal(5, 3, (4000, 6))
    taught = Examples(features, features[:, 2] > 5)
    told = log_odds(fitted(taught, 0), features) > 0
    assert np.mean(told == taught.body) > 0.95


def test_where_no_file_can_be_written_is_said_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(TrainingError, match="there is no folder"):
        train_silhouettes(tmp_path / "no" / "file.npz", 0, Console(quiet=True))


@pytest.mark.slow
def test_films_show_the_empty_room_then_somebody() -> None:
    for film in films(4, np.random.default_rng(4)):
        present = np.array([mask.any() for mask in film.masks])
        assert (len(film.frames), film.frames[0].shape) == (len(present), (240, 320, 3))
        assert np.flatnonzero(present)[0] == len(present) - silhouette_training.MOMENTS >= 8


@pytest.mark.slow
def test_what_is_learnt_is_repeatable_and_can_be_loaded(tmp_path: Path) -> None:
    one, again = examples_of(1), examples_of(1)
    assert all(np.array_equal(a, b) for a, b in zip(one, again, strict=True))
    save(fitted(one, 0), tmp_path / "learnt.npz")
    told = log_odds(load(tmp_path / "learnt.npz"), one.features) > 0
    assert np.mean(told == one.body) > 0.9


@pytest.mark.slow
def test_the_shipped_network_tells_the_pixels_of_people_it_never_saw() -> None:
    """P3: nine in ten of the doubtful ones, clothes of the wall's colour among them."""
    first = silhouette_training.PERFORMANCES
    new = [examples_of(seed) for seed in range(first, first + 3)]
    right = [(log_odds(shipped(), each.features) > 0) == each.body for each in new]
    assert np.mean(right) > 0.9
