"""The small network, held against plain sums and against files that hold none."""

from pathlib import Path

import numpy as np
import pytest

from viewer.silhouette.boundary_features import FEATURES
from viewer.silhouette.pixel_classifier import (
    SHAPES,
    SHIPPED,
    NetworkError,
    PixelClassifier,
    load,
    log_odds,
    redraw,
    save,
    shipped,
)


def network(seed: int) -> PixelClassifier:
    rng = np.random.default_rng(seed)
    return PixelClassifier(*(rng.normal(size=shape).astype(np.float32) for shape in SHAPES))


def test_a_network_is_two_sums_with_a_bend_between() -> None:
    """P3: a unit that adds the first two features and takes off 1, and an answer of its double."""
    enter, enter_bias, leave, leave_bias = (np.zeros(shape, np.float32) for shape in SHAPES)
    enter[:2, 0], enter_bias[0], leave[0], leave_bias[0] = 1, -1, 2, -3
    features = np.zeros((3, FEATURES), np.float32)
    features[:, :2] = (0.25, 0.25), (2, 1), (5, -1)
    own = PixelClassifier(enter, enter_bias, leave, leave_bias)
    assert log_odds(own, features).tolist() == [-3, 1, 3]


def test_the_features_of_nobody_say_nothing() -> None:
    assert log_odds(shipped(), np.empty((0, FEATURES), np.float32)).shape == (0,)


def test_what_is_saved_is_loaded(tmp_path: Path) -> None:
    own = network(1)
    save(own, tmp_path / "network.npz")
    for given, got in zip(own, load(tmp_path / "network.npz"), strict=True):
        assert np.array_equal(given, got)


@pytest.mark.parametrize("kept", [0, 10, 1000])
def test_a_damaged_file_is_refused_by_name(tmp_path: Path, kept: int) -> None:
    damaged = tmp_path / "network.npz"
    damaged.write_bytes(SHIPPED.read_bytes()[:kept])
    with pytest.raises(
        NetworkError, match=r"network\.npz holds no network of silhouettes: install"
    ):
        load(damaged)


def test_a_missing_file_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(NetworkError, match=r"gone\.npz holds no network"):
        load(tmp_path / "gone.npz")


@pytest.mark.parametrize("field", PixelClassifier._fields)
def test_another_network_is_refused(tmp_path: Path, field: str) -> None:
    own = network(2)
    for strange in (getattr(own, field)[:-1], getattr(own, field) * np.float32(np.nan)):
        save(own._replace(**{field: strange}), tmp_path / "network.npz")
        with pytest.raises(NetworkError, match="another network than silhouettes ask for"):
            load(tmp_path / "network.npz")


def test_a_pickle_is_not_read(tmp_path: Path) -> None:
    objects = {name: np.array([None], object) for name in PixelClassifier._fields}
    np.savez(tmp_path / "network.npz", allow_pickle=True, **objects)
    with pytest.raises(NetworkError):
        load(tmp_path / "network.npz")


def test_a_pixel_is_drawn_where_the_odds_are_likely() -> None:
    """Beyond -0.4, in places and out of them; what is not asked for stays."""
    mask = np.zeros((3, 4), np.uint8)
    mask[0] = 1
    places = np.array([[0, 1], [0, 2], [2, 3], [1, 0]], np.int32)
    redraw(mask, places, np.array([-0.41, -0.39, 0.5, -2.0], np.float32))
    assert mask.tolist() == [[1, 0, 1, 1], [0, 0, 0, 0], [0, 0, 0, 1]]
