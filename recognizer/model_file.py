"""A posture model on disk: one npz of numbers with a JSON header, and no pickle."""

from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Final, Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from common.npz_file import read_arrays, write_arrays
from recognizer.codebook import SYMBOLS
from recognizer.postures import (
    STATES,
    Card,
    DensityModel,
    PostureModel,
    Recognizer,
    SymbolModel,
)

VERSION: Final = 3
MAX_BYTES: Final = 10_000_000
"""Upper bound of an unpacked model, bytes: fifteen postures take 50 kB."""

KINDS: Final[dict[Recognizer, type[SymbolModel | DensityModel]]] = {
    "default": DensityModel,
    "paper": SymbolModel,
}
"""Model class of each recogniser."""

PROBABILITIES: Final = ("start", "transition", "emission")
"""Arrays whose rows sum to 1."""

CURE: Final = "make one with `tritrack train --what postures`"


class ModelError(ValueError):
    """A file without a usable model; the text names the file, the fault and the cure."""


class Kind(msgspec.Struct, frozen=True):
    """The part of a header that every version has."""

    format: Literal["tritrack postures"]
    version: int


class Header(Kind, frozen=True, forbid_unknown_fields=True):
    """The full header: the meaning of the numbers."""

    postures: tuple[str, ...]
    features: tuple[str, ...]
    card: Card


def save(model: PostureModel, path: Path) -> None:
    """Write a model completely or not at all; the same model gives the same bytes.

    Raises:
        ModelError: When the file cannot be written.
    """
    kind = KINDS[model.card.recognizer]
    header = Header("tritrack postures", VERSION, model.names, kind.FEATURES, model.card)
    arrays = {name: getattr(model, name) for name in _shapes(header)}
    arrays["header"] = np.frombuffer(msgspec.json.encode(header), np.uint8)
    try:
        write_arrays(path, arrays)
    except OSError as error:
        raise ModelError(f"cannot write the model {path}: {error.strerror}") from error


def load(path: Path, postures: Collection[str] | None = None) -> PostureModel:
    """Read a model that `save` wrote.

    Args:
        postures: The names that the model must have, exactly; None accepts any.

    Raises:
        ModelError: When the file cannot be read, is damaged, foreign, of another version or feature
            order, holds no probabilities, or has other postures.
    """
    try:
        model = _read(path)
        _refuse_unless(model, postures)
    except OSError as error:
        reason = error.strerror or str(error)
        raise ModelError(f"cannot read the model {path}: {reason}; {CURE}") from error
    except (ValueError, KeyError, RecursionError, msgspec.DecodeError) as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise ModelError(f"no usable posture model in {path}: {reason}; {CURE}") from error
    return model


def _read(path: Path) -> PostureModel:
    held = read_arrays(path, MAX_BYTES)
    header = _header(held["header"].tobytes())
    arrays = {name: held[name] for name in _shapes(header)}
    _refuse_false_arrays(arrays, _shapes(header))
    kind: Callable[..., PostureModel] = KINDS[header.card.recognizer]
    model = kind(names=header.postures, card=header.card, **arrays)
    return model


def _header(text: bytes) -> Header:
    version = msgspec.json.decode(text, type=Kind).version
    if version != VERSION:
        raise ValueError(f"it has version {version}, this tritrack reads {VERSION}")
    header = msgspec.json.decode(text, type=Header)
    if header.features != KINDS[header.card.recognizer].FEATURES:
        raise ValueError("it was made for other features than this tritrack computes")
    return header


def _shapes(header: Header) -> dict[str, tuple[int, ...]]:
    p, entries = len(header.postures), len(header.features)
    chain = {"start": (p, STATES), "transition": (p, STATES, STATES)}
    if header.card.recognizer == "paper":
        return chain | {"codebook": (SYMBOLS, entries), "emission": (p, STATES, SYMBOLS)}
    rest = {"rest_mean": (entries,), "rest_variance": (entries,), "fit": (p,)}
    return chain | rest | {"mean": (p, STATES, entries), "variance": (p, STATES, entries)}


def _refuse_false_arrays(
    arrays: Mapping[str, NDArray[np.float64]], shapes: Mapping[str, tuple[int, ...]]
) -> None:
    for name, array in arrays.items():
        if array.shape != shapes[name] or array.dtype != np.float64:
            raise ValueError(f"{name} is {array.dtype} {array.shape}, not float64 {shapes[name]}")
        if not np.isfinite(array).all():
            raise ValueError(f"{name} holds a number that is not finite")
        if name not in PROBABILITIES:
            continue
        if (array < 0).any() or not np.allclose(array.sum(axis=-1), 1.0, rtol=0, atol=1e-9):
            raise ValueError(f"the rows of {name} are no probabilities")
    if "emission" in arrays and (arrays["emission"] == 0).any():
        raise ValueError("emission calls a symbol impossible")
    variances = [array for name, array in arrays.items() if "variance" in name]
    if any((array <= 0).any() for array in variances):
        raise ValueError("variance holds a number that is not positive")


def _refuse_unless(model: PostureModel, postures: Collection[str] | None) -> None:
    if not model.names or len(set(model.names)) < len(model.names):
        raise ValueError(f"{len(model.names)} postures with {len(set(model.names))} names")
    if postures is not None and set(postures) != set(model.names):
        differing = ", ".join(sorted(set(postures) ^ set(model.names)))
        raise ValueError(f"its postures are not those asked for (differing: {differing})")
