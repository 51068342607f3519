"""Joints proposed from the silhouettes of an instant and a memory of those before it."""

import zipfile
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from common.body import Vector
from integrator.window import BESIDE, CELLS, Floats, Look

JOINTS: Final = tuple(
    f"{side}_{name}"
    for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
    for side in "lr"
)
"""What is proposed."""
SHOULDERS, HIPS = slice(0, 2), slice(6, 8)

SHIPPED: Final = Path(__file__).with_name("proposals.npz")
VERSION: Final = 3
SAYS: Final = 4 * len(JOINTS)
"""What the network says: three coordinates of each joint, and how sure it is of each."""


class Network(NamedTuple):
    """Principal components of a window; then two layers, a gated recurrent unit, and two layers.

    The second layer adds to what the first found.
    Weights are (inputs, outputs). The unit is that of Cho et al. 2014 with the reset gate on the
    hidden product; its gates are in the order reset, update, new.
    """

    mean: Floats
    """(CELLS,)"""
    components: Floats
    """(CELLS, n)"""
    think: Floats
    think_bias: Floats
    deepen: Floats
    deepen_bias: Floats
    take: Floats
    take_bias: Floats
    keep: Floats
    keep_bias: Floats
    join: Floats
    join_bias: Floats
    say: Floats
    say_bias: Floats


class Proposal(NamedTuple):
    """The joints of an instant."""

    joints_m: NDArray[np.float64]
    """(12, 3) world."""
    sure: Vector
    """(12,) how probably each is less than 50 mm off."""


def step(
    network: Network, memory: Floats | None, seen: Look, stature_m: float
) -> tuple[Floats, Proposal]:
    """One more instant: what is remembered of all, and the joints of this one.

    Args:
        network: The weights.
        memory: What was remembered after the instant before; None at the first.
        seen: The views of this instant.
        stature_m: Of the person.
    """
    n = network
    memory = np.zeros(len(n.keep), np.float32) if memory is None else memory
    shown = inputs(n.mean, n.components, seen.windows, seen.beside)
    memory, said = _remembered(*n[2:], memory, shown)
    said = said.astype(np.float64)
    places = said[: 3 * len(JOINTS)].reshape(-1, 3)
    joints_m = seen.middle_m + stature_m * places @ seen.turn
    return memory, Proposal(joints_m, _gate(said[3 * len(JOINTS) :]))


@numba.njit(cache=True)
def _remembered(
    think: Any, think_bias: Any, deepen: Any, deepen_bias: Any, take: Any, take_bias: Any,
    keep: Any, keep_bias: Any, join: Any, join_bias: Any, say: Any, say_bias: Any,
    memory: Any, shown: Any,
) -> tuple[Any, Any]:  # fmt: skip
    """What is remembered now, and what is said."""
    own, one = len(memory), np.float32(1.0)
    thought = _positive(_product(shown, think, think_bias))
    thought = _positive(_product(thought, deepen, deepen_bias) + thought)
    taken, kept = _product(thought, take, take_bias), _product(memory, keep, keep_bias)
    gates = one / (one + np.exp(-(taken[: 2 * own] + kept[: 2 * own])))
    new = np.tanh(taken[2 * own :] + gates[:own] * kept[2 * own :])
    memory = (one - gates[own:]) * new + gates[own:] * memory
    joined = _positive(_product(np.concatenate((thought, memory)), join, join_bias))
    return memory, _product(joined, say, say_bias)


@numba.njit(cache=True)
def _product(values: Any, weights: Any, bias: Any) -> Any:
    """values (n,) @ weights (n, m) + bias (m,).

    Such a product waits for its weights to come from memory: those that meet a zero, as half of
    what is thought is, are left there. Four rows at a time halve what is left of the work.
    """
    total = bias.copy()
    rows = np.flatnonzero(values)
    fours = len(rows) - len(rows) % 4
    for k in range(0, fours, 4):
        a, b, c, d = rows[k], rows[k + 1], rows[k + 2], rows[k + 3]
        at_a, at_b, at_c, at_d = weights[a], weights[b], weights[c], weights[d]
        for j in range(len(total)):
            total[j] += (
                values[a] * at_a[j]
                + values[b] * at_b[j]
                + values[c] * at_c[j]
                + values[d] * at_d[j]
            )
    for row in rows[fours:]:
        for j in range(len(total)):
            total[j] += values[row] * weights[row, j]
    return total


@numba.njit(cache=True)
def _positive(values: Any) -> Any:
    return np.maximum(values, np.float32(0.0))


def inputs(mean: Floats, components: Floats, windows: Floats, beside: Floats) -> Floats:
    """The components of both windows, and what is said beside them.

    Args:
        mean: Of the windows, (CELLS,).
        components: (CELLS, n).
        windows: (..., 2, CELLS).
        beside: (..., BESIDE).
    """
    sees = beside[..., [0, 5]][..., None]
    parts = ((windows - mean) @ components) * sees
    return np.concatenate([parts.reshape(*parts.shape[:-2], -1), beside], axis=-1)


def _gate(values: Any) -> Any:
    return 1.0 / (1.0 + np.exp(-values.clip(-60.0, 60.0)))


def aimed(joints_m: NDArray[np.float64], seen: Look, stature_m: float) -> NDArray[np.float64]:
    """Where the network should say that joints are, (n, 3) statures from the middle."""
    found: NDArray[np.float64] = (joints_m - seen.middle_m) @ seen.turn.T / stature_m
    return found


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
            found = Network(*(file[name].astype(np.float32) for name in Network._fields))
    except (OSError, KeyError, EOFError, ValueError, zipfile.BadZipFile) as error:
        raise ValueError(
            f"no usable proposals in {path}: {error}; install tritrack again"
        ) from error
    _refuse_misfits(found, path)
    return found


def _refuse_misfits(network: Network, path: Path) -> None:
    n = network
    sees, thinks, keeps, joins = (
        part.shape[-1] for part in (n.components, n.think, n.keep, n.join)
    )
    keeps //= 3
    due = {
        "mean": (CELLS,),
        "components": (CELLS, sees),
        "think": (2 * sees + BESIDE, thinks),
        "deepen": (thinks, thinks),
        "take": (thinks, 3 * keeps),
        "keep": (keeps, 3 * keeps),
        "join": (thinks + keeps, joins),
        "say": (joins, SAYS),
    }
    due |= {
        f"{name}_bias": due[name][1:] for name in ("think", "deepen", "take", "keep", "join", "say")
    }
    for name, shape in due.items():
        part = getattr(n, name)
        if part.shape != shape:
            raise ValueError(f"{path}: {name} is {part.shape}, not {shape}")
        if not np.isfinite(part).all():
            raise ValueError(f"{path}: {name} holds a number that is not finite")


def save(network: Network, path: Path) -> None:
    """Write a network, in half precision: finer than it was learnt."""
    halves: dict[str, Any] = {
        name: part.astype(np.float16) for name, part in network._asdict().items()
    }
    with path.open("wb") as file:
        np.savez(file, version=np.array(VERSION), **halves)
