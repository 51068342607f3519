"""Training of the lifting network on synthetic motion, without rendering pictures."""

from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Final

import numpy as np
from rich.console import Console

from common.npz_file import Facts
from integrator.proposal.landmark_look import INPUTS
from integrator.proposal.network_weights import LiftingNetwork
from lab.training import torch_network
from lab.training.lifting_examples import LiftingExample, lifting_examples
from lab.training.network_training import Lesson, train_network
from lab.training.torch_network import Round, Shown, torch_or_refuse

PERFORMANCES: Final = 30_000
"""Number of performances, each before one camera and before two: some sixty instants each."""
UNITS: Final = (320, 320, 320)
"""Units of fc1 and fc2, of the recurrent unit, and of fc3."""
ROUNDS: Final = (Round(10, 2e-3, 64), Round(6, 1e-3, 64))


def train_lifting(out: Path, seed: int, console: Console) -> Facts:
    """Train the network from scratch and write it: three quarters of an hour on two cores, 4 GB.

    Args:
        out: The file to write.
        seed: Seed of the first performance and of the network's initialisation.
        console: Shows progress.

    Raises:
        TrainingError: When PyTorch is not installed, or the file cannot be written.
    """
    lesson = Lesson(range(seed, seed + PERFORMANCES), lifting_examples, learnt)
    return train_network(lesson, out, seed, console)


def learnt(
    shown: list[LiftingExample], seed: int, console: Console, rounds: Sequence[Round] = ROUNDS
) -> LiftingNetwork:
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
    usual = np.concatenate([one.due for one in shown]).mean(axis=0)
    parts = torch_network.parts_of(torch, INPUTS, UNITS, usual)
    examples = [_tensors(torch, one) for one in shown]
    torch_network.learn(torch, parts, examples, rounds, seed, console)
    return LiftingNetwork(*torch_network.layers_of(parts))


def _tensors(torch: ModuleType, shown: LiftingExample) -> Shown:
    """Inputs, targets, ones, and the stature: as tensors over an example's instants."""
    ones = np.ones(len(shown.due), np.float32)
    parts = (shown.inputs, shown.due, ones, ones * np.float32(shown.stature_m))
    return tuple(torch.from_numpy(part) for part in parts)
