"""The network that proposes poses, learnt from outlines of made-up people."""

from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from rich.console import Console

from integrator.propose import JOINTS, Network, aimed, look, save
from synth.outlines import Outline, outlines
from synth.skeleton import JOINTS as ALL_JOINTS
from tritrack.terminal import bar

PERFORMANCES: Final = 6000
"""How many are learnt from: some twenty instants each."""
COMPONENTS: Final = 256
"""Principal components of both windows that are kept."""
PCA_FROM: Final = 24_000
"""Instants that the components are computed from."""
LIFTED: Final = 0.02
"""What is added to a component's spread before dividing by it, in those of the first."""
HIDDEN: Final = (512, 256)
EPOCHS, BATCH, RATE, WARM_STEPS = 15, 256, 2e-3, 200
STATURE_ERROR: Final = 0.012
"""How wrong a measured stature is, standard deviation as a share."""
MEANS, SQUARES, SMALL = 0.9, 0.999, 1e-8
"""Constants of Adam (Kingma & Ba 2015)."""
PICK: Final = [ALL_JOINTS.index(name) for name in JOINTS]

Floats = NDArray[np.float32]


def train_proposals(out: Path, seed: int, console: Console) -> dict[str, Any]:
    """Learn the network afresh and write it: some ten minutes and 2 GB.

    Args:
        out: The file to write.
        seed: The first performance's; also of the network's start.
        console: For progress.
    """
    inputs, targets = _taught(range(seed, seed + PERFORMANCES), console)
    network = learnt(inputs, targets, seed, console)
    save(network, out)
    return {"model": str(out), "instants": len(inputs), "performances": PERFORMANCES}


def _taught(seeds: range, console: Console) -> tuple[NDArray[np.float16], Floats]:
    inputs, targets = [], []
    with bar(console) as progress:
        for seed in progress.track(seeds, description="drawing"):
            own = examples(outlines(seed), np.random.default_rng([seed, 78]))
            inputs.append(own[0])
            targets.append(own[1])
    return np.concatenate(inputs), np.concatenate(targets)


def examples(
    shown: Iterable[Outline], rng: np.random.Generator
) -> tuple[NDArray[np.float16], Floats]:
    """What the network sees of instants, (n, INPUTS), and what it should say, (n, 36)."""
    inputs, targets = [], []
    for masks, joints_m, rig, stature_m in shown:
        if min(mask.sum() for mask in masks) == 0:
            continue
        believed_m = stature_m * (1.0 + STATURE_ERROR * rng.normal())
        window = look(masks, rig, believed_m, 0)
        assert window is not None
        inputs.append(window.cells.astype(np.float16))
        targets.append(aimed(joints_m[PICK], window, believed_m).ravel().astype(np.float32))
    return np.array(inputs), np.array(targets)


def learnt(
    inputs: NDArray[np.float16],
    targets: Floats,
    seed: int,
    console: Console,
    epochs: int = EPOCHS,
) -> Network:
    """The network that misses the targets least: mean distance of the joints, by Adam."""
    rng = np.random.default_rng(seed)
    mean, components = _components(inputs[rng.permutation(len(inputs))[:PCA_FROM]])
    seen = np.concatenate(
        [(part.astype(np.float32) - mean) @ components for part in _parts(inputs)]
    )
    middle = targets.mean(axis=0)
    sizes = (components.shape[1], *HIDDEN, targets.shape[1])
    shapes = list(pairwise(sizes))
    params = [
        (rng.normal(0.0, np.sqrt(2.0 / above), (above, below))).astype(np.float32)
        for above, below in shapes
    ] + [np.zeros(below, np.float32) for _, below in shapes]
    params[len(shapes) - 1] *= 0.1  # it begins near the mean pose
    _descend(params, seen, targets - middle, rng, epochs, console)
    weights, biases = params[: len(shapes)], params[len(shapes) :]
    biases[-1] = biases[-1] + middle
    return Network(mean, components, tuple(weights), tuple(biases))


def _parts(inputs: NDArray[np.float16]) -> Iterable[NDArray[np.float16]]:
    return (inputs[i : i + 4096] for i in range(0, len(inputs), 4096))


def _components(inputs: NDArray[np.float16]) -> tuple[Floats, Floats]:
    """Mean (n,) and components (n, COMPONENTS) of inputs, scaled to spreads of about one."""
    mean = inputs.mean(axis=0, dtype=np.float32)
    squares = np.zeros((len(mean), len(mean)), np.float32)
    for part in _parts(inputs):
        away = part.astype(np.float32) - mean
        squares += away.T @ away
    last = len(mean) - 1
    kept = min(COMPONENTS, last + 1)
    values, vectors = scipy.linalg.eigh(squares, subset_by_index=[last + 1 - kept, last])
    spreads = np.sqrt(np.maximum(values, 0.0) / len(inputs))
    return mean, (vectors / (spreads + LIFTED * spreads[-1])).astype(np.float32)


def _descend(
    params: list[Floats],
    seen: Floats,
    due: Floats,
    rng: np.random.Generator,
    epochs: int,
    console: Console,
) -> None:
    """Adam with a short warm-up and a cosine's end; `params` are changed in place."""
    state = [(np.zeros_like(param), np.zeros_like(param)) for param in params]
    steps, step = epochs * (len(seen) // BATCH), 0
    with bar(console) as progress:
        for _ in progress.track(range(epochs), description="learning"):
            order = rng.permutation(len(seen))
            for i in range(0, len(seen) - BATCH + 1, BATCH):
                rows = order[i : i + BATCH]
                step += 1
                rate = RATE * min(1.0, step / WARM_STEPS) * (1 + np.cos(np.pi * step / steps)) / 2
                rate *= np.sqrt(1.0 - SQUARES**step) / (1.0 - MEANS**step)
                slopes = _slopes(params, seen[rows], due[rows])
                for j, slope in enumerate(slopes):
                    _move(params[j], slope, *state[j], np.float32(rate))


def _move(param: Floats, slope: Floats, mean: Floats, square: Floats, rate: np.float32) -> None:
    """One step of Adam, in place."""
    mean += np.float32(1.0 - MEANS) * (slope - mean)
    square += np.float32(1.0 - SQUARES) * (slope * slope - square)
    param -= rate * mean / (np.sqrt(square) + np.float32(SMALL))


def _slopes(params: list[Floats], seen: Floats, due: Floats) -> list[Floats]:
    """Derivatives of the mean distance of the joints."""
    layers = len(params) // 2
    values = [seen]
    for weights, bias in zip(params[: layers - 1], params[layers:-1], strict=True):
        values.append(np.maximum(values[-1] @ weights + bias, 0.0))
    missed = (values[-1] @ params[layers - 1] + params[-1] - due).reshape(len(due), -1, 3)
    far = np.sqrt((missed * missed).sum(axis=-1, keepdims=True) + 1e-4)
    slope = (missed / far / (missed.shape[1] * len(due))).reshape(len(due), -1)
    slopes: list[Floats] = [slope] * len(params)
    for i in range(layers - 1, -1, -1):
        slopes[i], slopes[layers + i] = values[i].T @ slope, slope.sum(axis=0)
        slope = (slope @ params[i].T) * (values[i] > 0)
    return slopes
