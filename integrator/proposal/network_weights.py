"""The weights of the two networks that propose joints, and the files that hold them."""

from functools import lru_cache
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from common.npz_file import read_arrays, write_arrays
from integrator.proposal.landmark_look import INPUTS
from integrator.proposal.silhouette_window import BESIDE, CELLS, Floats

JOINTS: Final = tuple(
    f"{side}_{name}"
    for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
    for side in "lr"
)
"""The proposed joints."""
Bfloat16 = NDArray[np.uint16]
"""Upper halves of float32 numbers, as bits."""

LINE_BYTES, PAGE_BYTES = 64, 1 << 21
"""Bytes of a cache line, and of a large memory page."""

SHIPPED: Final = Path(__file__).with_name("proposals.npz")
SHIPPED_LIFTING: Final = Path(__file__).with_name("lifting.npz")
VERSION: Final = 4
MOST_BYTES: Final = 100_000_000
"""Upper bound of an unpacked network, bytes: the packaged one takes 6 MB."""
OUTPUTS: Final = 4 * len(JOINTS)
"""Outputs: three coordinates of each joint, and the confidence in each, as a logit."""
LIFTED_OUTPUTS: Final = 3 + OUTPUTS
"""Outputs: the hips' middle, the joints relative to it, and the confidence in each."""


class PoseNetwork(NamedTuple):
    """Principal components of a window; then two layers, a gated recurrent unit, and two layers.

    The second layer adds to the first layer's result. Weights are (inputs, outputs), in bfloat16:
    memory bandwidth limits a product's speed. The unit is that of Cho et al. 2014 with the reset
    gate on the hidden product; its gates are in the order reset, update, new.
    """

    pca: Bfloat16
    """(CELLS, n) components."""
    pca_bias: Floats
    """(n,) components of the mean window, which are subtracted."""
    fc1: Bfloat16
    fc1_bias: Floats
    fc2: Bfloat16
    fc2_bias: Floats
    gru_ih: Bfloat16
    gru_ih_bias: Floats
    gru_hh: Bfloat16
    gru_hh_bias: Floats
    fc3: Bfloat16
    fc3_bias: Floats
    out: Bfloat16
    out_bias: Floats


class LiftingNetwork(NamedTuple):
    """The layers of a `PoseNetwork` after its components, of another size."""

    fc1: Bfloat16
    fc1_bias: Floats
    fc2: Bfloat16
    fc2_bias: Floats
    gru_ih: Bfloat16
    gru_ih_bias: Floats
    gru_hh: Bfloat16
    gru_hh_bias: Floats
    fc3: Bfloat16
    fc3_bias: Floats
    out: Bfloat16
    out_bias: Floats


Network = TypeVar("Network", PoseNetwork, LiftingNetwork)


@lru_cache(maxsize=1)
def shipped() -> PoseNetwork:
    """The silhouette network in the package."""
    return load(SHIPPED, PoseNetwork)


@lru_cache(maxsize=1)
def shipped_lifting() -> LiftingNetwork:
    """The landmark network in the package."""
    return load(SHIPPED_LIFTING, LiftingNetwork)


def load(path: Path, kind: type[Network]) -> Network:
    """Read a network that `save` wrote.

    Raises:
        ValueError: When the file is no network, damaged or of another version.
    """
    try:
        held = read_arrays(path, MOST_BYTES)
        if int(held["version"]) != VERSION:
            raise ValueError(f"it has version {int(held['version'])}, not {VERSION}")
        found = kind(*(held[name] for name in kind._fields))
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise ValueError(
            f"no usable proposals in {path}: {error}; install tritrack again"
        ) from error
    _refuse_misfits(found, path)
    return _in_one_piece(found)


def _in_one_piece(network: Network) -> Network:
    """The same array in contiguous memory on large pages: few pages are translated faster than
    many.

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
    return type(network)(*parts)


def _refuse_misfits(n: PoseNetwork | LiftingNetwork, path: Path) -> None:
    hidden, gates, joined = (part.shape[-1] for part in (n.fc1, n.gru_hh, n.fc3))
    memory = gates // 3
    due: dict[str, tuple[int, ...]] = {}
    told, says = INPUTS, LIFTED_OUTPUTS
    if isinstance(n, PoseNetwork):
        due["pca"] = CELLS, n.pca.shape[-1]
        told, says = 2 * n.pca.shape[-1] + BESIDE, OUTPUTS
    due |= {
        "fc1": (told, hidden),
        "fc2": (hidden, hidden),
        "gru_ih": (hidden, gates),
        "gru_hh": (memory, gates),
        "fc3": (hidden + memory, joined),
        "out": (joined, says),
    }
    for name, shape in due.items():
        weights, bias = getattr(n, name), getattr(n, f"{name}_bias")
        if weights.shape != shape or bias.shape != shape[1:]:
            raise ValueError(f"{path}: {name} is {weights.shape}, not {shape}")
        if weights.dtype != np.uint16 or bias.dtype != np.float32:
            raise ValueError(f"{path}: {name} is not of bfloat16 and single floats")
        if not (np.isfinite(from_bfloat16(weights)).all() and np.isfinite(bias).all()):
            raise ValueError(f"{path}: {name} holds a number that is not finite")


def save(network: PoseNetwork | LiftingNetwork, path: Path) -> None:
    """Write a network."""
    write_arrays(path, {"version": np.array(VERSION), **network._asdict()})


def to_bfloat16(values: Floats) -> Bfloat16:
    """Numbers as bfloat16, to the nearest: three digits, whole range."""
    bits = np.ascontiguousarray(values, np.float32).view(np.uint32).astype(np.uint64)
    return ((bits + 0x7FFF + (bits >> 16 & 1)) >> 16).astype(np.uint16)


def from_bfloat16(values: Bfloat16) -> Floats:
    """The numbers that bfloat16 bits stand for."""
    return (values.astype(np.uint32) << 16).view(np.float32)
