"""The network that proposes poses, trained on silhouettes of synthetic people."""

import multiprocessing
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import scipy.linalg
from rich.console import Console
from rich.progress import Progress

from integrator.proposal.network_weights import PoseNetwork, save
from integrator.proposal.pose_network import SEES
from integrator.proposal.silhouette_window import CELLS, Floats
from synth.picture.silhouette_examples import AT_LARGE, ORDINARY
from tritrack.terminal import bar
from tritrack.training import torch_network
from tritrack.training.proposal_examples import Example, example_of
from tritrack.training.training import TrainingError

PERFORMANCES: Final = {ORDINARY: 12_000, AT_LARGE: 5_000}
"""How many of which manner are learnt from: some sixty instants each."""
COMPONENTS: Final = 192
"""Principal components of a window that are kept."""
SAMPLED: Final = 12
"""Instants of each performance that the components are computed from, at most."""
LIFTED: Final = 0.02
"""What is added to a component's spread before dividing by it, in those of the first."""
ROUNDS, BATCH, WARM_STEPS = ((24, 2e-3), (20, 1e-3)), 64, 150
"""Epochs and highest rate of each round, in which the rate rises, and falls to nothing."""
DECAY: Final = 1e-4
STEEPEST: Final = 1.0
"""Size that a slope is cut to."""
SHORTEST: Final = 8
"""Instants that a performance must have."""


class Round(NamedTuple):
    """How a round of training goes."""

    epochs: int
    rate: float
    """The highest."""
    batch: int
    """Performances that are shown at once."""


def train_proposals(out: Path, seed: int, console: Console) -> dict[str, Any]:
    """Learn the network afresh and write it: an hour and a half on two cores, 9 GB.

    Args:
        out: The file to write.
        seed: The first performance's; also of the network's start.
        console: For progress.

    Raises:
        TrainingError: When PyTorch is not installed, or the file cannot be written.
    """
    _torch()
    if not out.parent.is_dir():
        raise TrainingError(f"cannot write {out}: there is no folder {out.parent}")
    with multiprocessing.get_context("spawn").Pool() as pool, bar(console) as progress:
        manners = [manner for manner, count in PERFORMANCES.items() for _ in range(count)]
        drawn = progress.track(
            pool.imap(example_of, enumerate(manners, seed), chunksize=8),
            total=len(manners),
            description="drawing",
        )
        shown = [each for each in drawn if len(each.due) >= SHORTEST]
    network = learnt(shown, seed, console)
    try:
        save(network, out)
    except OSError as error:
        raise TrainingError(f"cannot write {out}: {error.strerror}") from error
    return {"model": str(out), "instants": sum(len(each.due) for each in shown)}


def learnt(
    shown: list[Example],
    seed: int,
    console: Console,
    rounds: Sequence[tuple[int, float]] = ROUNDS,
    batch: int = BATCH,
) -> PoseNetwork:
    """The network that misses least: mean distance of the joints, by Adam.

    Args:
        shown: Performances.
        seed: Of the network's start and the order of the performances.
        console: For progress.
        rounds: How often each is shown, and the highest rate, round by round.
        batch: How many are shown at once.

    Raises:
        TrainingError: When PyTorch is not installed.
    """
    torch = _torch()
    torch.manual_seed(seed)
    rng, (mean, components) = np.random.default_rng(seed), _components(shown)
    examples = [_tensors(torch, mean, components, each) for each in shown]
    parts = torch_network.parts_of(
        torch, COMPONENTS, np.concatenate([each.due for each in shown]).mean(0)
    )
    with bar(console) as progress:
        ends = []
        for epochs, rate in rounds:
            _round(torch, parts, examples, rng, Round(epochs, rate, batch), progress)
            ends.append([weight.detach().clone() for part in parts for weight in part.parameters()])
    _settle(torch, parts, ends)
    return torch_network.network_of(mean, components, parts)


def _round(
    torch: Any,
    parts: list[Any],
    examples: list[tuple[Any, ...]],
    rng: np.random.Generator,
    how: Round,
    progress: Progress,
) -> None:
    """Show all examples so often, in other orders."""
    epochs, rate, batch = how
    weights = [weight for part in parts for weight in part.parameters()]
    adam = torch.optim.AdamW(weights, lr=rate, weight_decay=DECAY)
    count = len(examples) // batch
    warm = min(0.3, WARM_STEPS / epochs / count)
    pace = torch.optim.lr_scheduler.OneCycleLR(
        adam, rate, total_steps=epochs * count + 1, pct_start=warm
    )
    for _ in progress.track(range(epochs), description="learning"):
        for rows in np.array_split(rng.permutation(len(examples)), count):
            adam.zero_grad()
            torch_network.loss(torch, parts, [examples[row] for row in rows]).backward()
            torch.nn.utils.clip_grad_norm_(weights, STEEPEST)
            adam.step()
            pace.step()


def _settle(torch: Any, parts: list[Any], ends: list[list[Any]]) -> None:
    """The mean of what each round ended with: better than either (Izmailov et al. 2018)."""
    weights = [weight for part in parts for weight in part.parameters()]
    with torch.no_grad():
        for weight, *reached in zip(weights, *ends, strict=True):
            weight.copy_(torch.stack(reached).mean(0))


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


def _tensors(torch: Any, mean: Floats, components: Floats, shown: Example) -> tuple[Any, ...]:
    """Inputs, what is due, ones, and the stature: as tensors of an example's instants."""
    windows = shown.cells.astype(np.float32) / np.float32(255)
    seen = (windows - mean) @ components * shown.beside[:, SEES, None]
    seen = np.concatenate([seen.reshape(len(seen), -1), shown.beside], axis=1)
    ones = np.ones(len(seen), np.float32)
    parts = (seen, shown.due, ones, ones * np.float32(shown.stature_m))
    return tuple(torch.from_numpy(part) for part in parts)


def _torch() -> Any:
    """PyTorch, which only this needs."""
    try:
        import torch
    except ImportError as error:
        raise TrainingError(
            "learning proposals needs PyTorch: pip install 'tritrack[train]'"
        ) from error
    return torch
