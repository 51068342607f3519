"""The weights of the network that proposes joints, and the file that holds them."""

import zipfile
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from integrator.proposal.silhouette_window import BESIDE, CELLS, Floats

JOINTS: Final = tuple(
    f"{side}_{name}"
    for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
    for side in "lr"
)
"""What is proposed."""
Halves = NDArray[np.uint16]
"""Upper halves of float32 numbers."""

LINE_BYTES, PAGE_BYTES = 64, 1 << 21
"""What memory is fetched in, and what a large page of it holds."""

SHIPPED: Final = Path(__file__).with_name("proposals.npz")
VERSION: Final = 3
SAYS: Final = 4 * len(JOINTS)
"""What the network says: three coordinates of each joint, and how sure it is of each."""


class Network(NamedTuple):
    """Principal components of a window; then two layers, a gated recurrent unit, and two layers.

    The second layer adds to what the first found. Weights are (inputs, outputs), and halves: a
    product waits for its weights to come from memory. The unit is that of Cho et al. 2014 with the
    reset gate on the hidden product; its gates are in the order reset, update, new.
    """

    see: Halves
    """(CELLS, n) components."""
    see_bias: Floats
    """(n,) less those of the mean window."""
    think: Halves
    think_bias: Floats
    deepen: Halves
    deepen_bias: Floats
    take: Halves
    take_bias: Floats
    keep: Halves
    keep_bias: Floats
    join: Halves
    join_bias: Floats
    say: Halves
    say_bias: Floats


PARTS: Final = ("see", "think", "deepen", "take", "keep", "join", "say")


@lru_cache(maxsize=1)
def shipped() -> Network:
    """The network that is installed with the program."""
    return load(SHIPPED)


def load(path: Path) -> Network:
    """Read a network that `save` wrote.

    Raises:
        ValueError: When the file is none, is damaged or of another version.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            if int(file["version"]) != VERSION:
                raise ValueError(f"it has version {int(file['version'])}, not {VERSION}")
            found = Network(*(file[name] for name in Network._fields))
    except (OSError, KeyError, EOFError, ValueError, zipfile.BadZipFile) as error:
        raise ValueError(
            f"no usable proposals in {path}: {error}; install tritrack again"
        ) from error
    _refuse_misfits(found, path)
    return _in_one_piece(found)


def _in_one_piece(network: Network) -> Network:
    """The same, side by side in memory: a few large pages are found sooner than many small ones.

    NumPy asks the system for large pages for an array of this size.
    """
    given: tuple[NDArray[Any], ...] = network
    sizes = [-(-part.nbytes // LINE_BYTES) * LINE_BYTES for part in given]
    whole = np.empty(sum(sizes) + PAGE_BYTES, np.uint8)
    parts, at = [], -whole.ctypes.data % PAGE_BYTES
    for part, size in zip(given, sizes, strict=True):
        own = whole[at : at + part.nbytes].view(part.dtype).reshape(part.shape)
        own[...] = part
        parts.append(own)
        at += size
    return Network(*parts)


def _refuse_misfits(network: Network, path: Path) -> None:
    n = network
    sees, thinks, keeps, joins = (part.shape[-1] for part in (n.see, n.think, n.keep, n.join))
    keeps //= 3
    due = {
        "see": (CELLS, sees),
        "think": (2 * sees + BESIDE, thinks),
        "deepen": (thinks, thinks),
        "take": (thinks, 3 * keeps),
        "keep": (keeps, 3 * keeps),
        "join": (thinks + keeps, joins),
        "say": (joins, SAYS),
    }
    for name in PARTS:
        weights, bias = getattr(n, name), getattr(n, f"{name}_bias")
        if weights.shape != due[name] or bias.shape != due[name][1:]:
            raise ValueError(f"{path}: {name} is {weights.shape}, not {due[name]}")
        if weights.dtype != np.uint16 or bias.dtype != np.float32:
            raise ValueError(f"{path}: {name} is not of halves and single floats")
        if not (np.isfinite(wholes(weights)).all() and np.isfinite(bias).all()):
            raise ValueError(f"{path}: {name} holds a number that is not finite")


def save(network: Network, path: Path) -> None:
    """Write a network."""
    parts: dict[str, Any] = network._asdict()
    with path.open("wb") as file:
        np.savez(file, version=np.array(VERSION), **parts)


def halves(values: Floats) -> Halves:
    """The upper halves of numbers (bfloat16), to the nearest: three digits, whole range."""
    bits = np.ascontiguousarray(values, np.float32).view(np.uint32).astype(np.uint64)
    return ((bits + 0x7FFF + (bits >> 16 & 1)) >> 16).astype(np.uint16)


def wholes(values: Halves) -> Floats:
    """The numbers that halves stand for."""
    return (values.astype(np.uint32) << 16).view(np.float32)
