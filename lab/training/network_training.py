"""Training a network that proposes joints: examples are drawn, learnt from, and it is written."""

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
"""Fewest instants of a performance that is learnt from; shorter ones are dropped."""


class Example(Protocol):
    """A performance that is learnt from."""

    @property
    def due(self) -> Floats:
        """(instants, 3 j): what the network should put out."""
        ...


class Lesson(NamedTuple):
    """What is drawn, and how a network learns from it."""

    tasks: Sequence[Any]
    draw: Callable[[Any], Sequence[Example]]
    """The examples of one task; runs in processes of its own."""
    learnt: Callable[[list[Any], int, Console], PoseNetwork | LiftingNetwork]
    """The network, from examples, the seed of its start, and a console for progress."""


def train_network(lesson: Lesson, out: Path, seed: int, console: Console) -> Facts:
    """Draw the examples of a lesson, learn the network from them and write it.

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
