"""A small network that classifies pixels as body or background, trained on clips of known masks."""

from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.compiled import KERNEL
from common.npz_file import DamagedFile, read_arrays, write_arrays
from viewer.background.image_stack import Bytes, Floats
from viewer.silhouette.boundary_features import FEATURES

SHIPPED: Final = Path(__file__).with_name("silhouettes.npz")
"""Trained on synthetic people; docs/models.md says of whom."""
MOST_BYTES: Final = 100_000
"""No network is larger unpacked: it takes 3 kB."""
HIDDEN: Final = 16
"""Units between the features and the answer."""


LIKELY: Final = np.float32(-0.4)
"""Log odds from which a pixel is body: chosen on two performers (docs/measurements.md)."""


class PixelClassifier(NamedTuple):
    """One hidden layer of rectified units, and the log odds that a pixel is body."""

    fc1: Floats
    """(FEATURES, HIDDEN)."""
    fc1_bias: Floats
    """(HIDDEN,)."""
    out: Floats
    """(HIDDEN,)."""
    out_bias: Floats
    """(1,)."""


SHAPES: Final = ((FEATURES, HIDDEN), (HIDDEN,), (HIDDEN,), (1,))


class NetworkError(ValueError):
    """A file that holds no network of silhouettes."""


@cache
def shipped() -> PixelClassifier:
    """The network that came with tritrack."""
    return load(SHIPPED)


def load(path: Path) -> PixelClassifier:
    """The network in a file that `save` wrote.

    Raises:
        NetworkError: When the file is missing, damaged or holds something else.
    """
    cure = "install tritrack again, or tritrack train --what silhouettes"
    try:
        held = read_arrays(path, MOST_BYTES)
        network = PixelClassifier(*(held[field] for field in PixelClassifier._fields))
    except (OSError, DamagedFile, KeyError) as error:
        raise NetworkError(f"{path} holds no network of silhouettes: {cure}") from error
    sound = all(
        values.shape == shape and values.dtype == np.float32 and np.isfinite(values).all()
        for values, shape in zip(network, SHAPES, strict=True)
    )
    if not sound:
        raise NetworkError(f"{path} holds another network than silhouettes ask for: {cure}")
    return network


def save(network: PixelClassifier, path: Path) -> None:
    """Write a network."""
    write_arrays(path, network._asdict())


def log_odds(network: PixelClassifier, features: Floats) -> Floats:
    """Log odds (n,) that each of n pixels is body, by its features (n, FEATURES)."""
    seen = features @ network.fc1
    seen += network.fc1_bias
    return np.asarray(np.maximum(seen, 0, out=seen) @ network.out + network.out_bias)


@KERNEL
def redraw(mask: Bytes, places: NDArray[np.int32], odds: Floats) -> None:
    """Set the mask at row and column (n, 2), where the odds say so."""
    for n in range(len(odds)):
        mask[places[n, 0], places[n, 1]] = odds[n] > LIKELY
