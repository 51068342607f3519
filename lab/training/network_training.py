"""Training of a network that proposes joints: make examples, train, write."""

import multiprocessing
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple, Protocol

from rich.console import Console

from common.npz_file import Facts
from integrator.proposal.network_weights import LiftingNetwork, PoseNetwork, save
from integrator.proposal.silhouette_window import Floats
from lab.training.torch_network import torch_or_refuse
from lab.training.training import TrainingError
from runtime.terminal import bar

SHORTEST: Final = 8
"""Fewest instants of a training performance; shorter ones are dropped."""


class Example(Protocol):
    """A training performance."""

    @property
    def due(self) -> Floats:
        """(instants, 3 j): target output."""
        ...


class Lesson(NamedTuple):
    """The examples of a task, and its training function."""

    tasks: Sequence[Any]
    draw: Callable[[Any], Sequence[Example]]
    """Makes the examples of one seed; runs in separate processes."""
    learnt: Callable[[list[Any], int, Console], PoseNetwork | LiftingNetwork]
    """Trains the network: from examples, a seed for its initialisation, and a console for
    progress."""


def train_network(lesson: Lesson, out: Path, seed: int, console: Console) -> Facts:
    """Make the examples of a task, train the network on them and write it.

    Raises:
        TrainingError: When PyTorch is not installed, or the file cannot be written.
    """
    torch_or_refuse()
    if not out.parent.is_dir():
        raise TrainingError(f"cannot write {out}: there is no folder {out.parent}")
    with multiprocessing.get_context("spawn").Pool() as pool, bar(console) as progress:
        drawn = progress.track(
            pool.imap(lesson.draw, lesson.tasks, chunksize=8),
            total=len(lesson.tasks),
            description="drawing",
        )
        shown = [one for of_task in drawn for one in of_task if len(one.due) >= SHORTEST]
    network = lesson.learnt(shown, seed, console)
    try:
        save(network, out)
    except OSError as error:
        raise TrainingError(f"cannot write {out}: {error.strerror}") from error
    return {"model": str(out), "instants": sum(len(one.due) for one in shown)}
