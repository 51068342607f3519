"""Training of the proposal network on silhouettes of synthetic people."""

from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Final

import numpy as np
import scipy.linalg
from rich.console import Console

from common.npz_file import Facts
from integrator.proposal.network_weights import PoseNetwork, to_bfloat16
from integrator.proposal.pose_network import SEES
from integrator.proposal.silhouette_window import BESIDE, CELLS, Floats
from lab.training import torch_network
from lab.training.network_training import Lesson, train_network
from lab.training.proposal_examples import Example, example_of
from lab.training.torch_network import Round, Shown, torch_or_refuse
from synth.picture.silhouette_examples import AT_LARGE, ORDINARY, Manner

PERFORMANCES: Final = {ORDINARY: 12_000, AT_LARGE: 5_000}
"""Number of performances of each manner: some sixty instants each."""
COMPONENTS: Final = 192
"""Number of principal components of a window."""
SAMPLED: Final = 12
"""Largest number of instants of each performance for computing the components."""
LIFTED: Final = 0.02
"""Added to a component's spread before dividing by it, in spreads of the first."""
UNITS: Final = (512, 512, 384)
"""Units of fc1 and fc2, of the recurrent unit, and of fc3."""
ROUNDS: Final = (Round(24, 2e-3, 64), Round(20, 1e-3, 64))


def train_proposals(out: Path, seed: int, console: Console) -> Facts:
    """Train the network from scratch and write it: an hour and a half on two cores, 9 GB.

    Args:
        out: The file to write.
        seed: Seed of the first performance and of the network's initialisation.
        console: Shows progress.

    Raises:
        TrainingError: When PyTorch is not installed, or the file cannot be written.
    """
    manners = [manner for manner, count in PERFORMANCES.items() for _ in range(count)]
    lesson = Lesson([*enumerate(manners, seed)], _drawn, learnt)
    return train_network(lesson, out, seed, console)


def _drawn(task: tuple[int, Manner]) -> tuple[Example, ...]:
    """The one example of a seed and a manner."""
    return (example_of(task),)


def learnt(
    shown: list[Example], seed: int, console: Console, rounds: Sequence[Round] = ROUNDS
) -> PoseNetwork:
    """The network with the smallest mean distance of the joints.

    Args:
        shown: The performances.
        seed: Seed of the network's initialisation and the order of the performances.
        console: Shows progress.
        rounds: Number of training rounds.

    Raises:
        TrainingError: When PyTorch is not installed.
    """
    torch = torch_or_refuse()
    torch.manual_seed(seed)
    mean, components = _components(shown)
    examples = [_tensors(torch, mean, components, each) for each in shown]
    usual = np.concatenate([each.due for each in shown]).mean(axis=0)
    parts = torch_network.parts_of(torch, 2 * COMPONENTS + BESIDE, UNITS, usual)
    torch_network.learn(torch, parts, examples, rounds, seed, console)
    return PoseNetwork(to_bfloat16(components), -mean @ components, *torch_network.layers_of(parts))


def _components(shown: list[Example]) -> tuple[Floats, Floats]:
    """Mean (CELLS,) and components (CELLS, COMPONENTS) of windows, scaled to spreads of about 1."""
    sampled = [
        each.cells[:: 1 + len(each.cells) // SAMPLED][
            each.beside[:: 1 + len(each.cells) // SAMPLED][:, SEES] > 0
        ]
        for each in shown
    ]
    windows = np.concatenate(sampled).astype(np.float32) / 255
    mean = windows.mean(axis=0)
    windows -= mean
    kept = [CELLS - COMPONENTS, CELLS - 1]
    values, vectors = scipy.linalg.eigh(windows.T @ windows / len(windows), subset_by_index=kept)
    spreads = np.sqrt(np.maximum(values, 0.0))
    return mean, (vectors / (spreads + LIFTED * spreads[-1])).astype(np.float32)


def _tensors(torch: ModuleType, mean: Floats, components: Floats, shown: Example) -> Shown:
    """Inputs, targets, ones, and the stature: as tensors over an example's instants."""
    windows = shown.cells.astype(np.float32) / np.float32(255)
    seen = (windows - mean) @ components * shown.beside[:, SEES, None]
    seen = np.concatenate([seen.reshape(len(seen), -1), shown.beside], axis=1)
    ones = np.ones(len(seen), np.float32)
    parts = (seen, shown.due, ones, ones * np.float32(shown.stature_m))
    return tuple(torch.from_numpy(part) for part in parts)
