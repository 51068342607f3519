"""The network that proposes poses, learnt from outlines of made-up people."""

import multiprocessing
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import Progress

from integrator.propose import JOINTS, SAYS, SEES, Network, halves, save
from integrator.window import BESIDE, CELLS
from synth.outlines import AT_LARGE, ORDINARY
from tritrack.lessons import Example, example_of
from tritrack.terminal import bar
from tritrack.training import TrainingError

PERFORMANCES: Final = {ORDINARY: 12_000, AT_LARGE: 5_000}
"""How many of which manner are learnt from: some sixty instants each."""
COMPONENTS: Final = 192
"""Principal components of a window that are kept."""
SAMPLED: Final = 12
"""Instants of each performance that the components are computed from, at most."""
LIFTED: Final = 0.02
"""What is added to a component's spread before dividing by it, in those of the first."""
LAYERS: Final = (512, 512, 384)
"""Units that think (twice), remember and join."""
ROUNDS, BATCH, WARM_STEPS = ((24, 2e-3), (20, 1e-3)), 64, 150
"""Epochs and highest rate of each round, in which the rate rises, and falls to nothing."""
DECAY: Final = 1e-4
STEEPEST: Final = 1.0
"""Size that a slope is cut to."""
SURE_SHARE: Final = 0.01
"""Weight of what the network says of its sureness beside a distance in statures."""
NEAR_M: Final = 0.05
"""What it is sure of: a joint is no farther off."""
SHORTEST: Final = 8
"""Instants that a performance must have."""

Floats = NDArray[np.float32]


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
) -> Network:
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
    lessons = [_lesson(torch, mean, components, each) for each in shown]
    parts = _parts(torch, np.concatenate([each.due for each in shown]).mean(0))
    with bar(console) as progress:
        ends = []
        for epochs, rate in rounds:
            _round(torch, parts, lessons, rng, epochs, rate, batch, progress)
            ends.append([weight.detach().clone() for part in parts for weight in part.parameters()])
    _settle(torch, parts, ends)
    return _network(mean, components, parts)


def _round(
    torch: Any,
    parts: list[Any],
    lessons: list[tuple[Any, ...]],
    rng: np.random.Generator,
    epochs: int,
    rate: float,
    batch: int,
    progress: Progress,
) -> None:
    """Show all lessons so often, in other orders."""
    weights = [weight for part in parts for weight in part.parameters()]
    adam = torch.optim.AdamW(weights, lr=rate, weight_decay=DECAY)
    count = len(lessons) // batch
    warm = min(0.3, WARM_STEPS / epochs / count)
    pace = torch.optim.lr_scheduler.OneCycleLR(
        adam, rate, total_steps=epochs * count + 1, pct_start=warm
    )
    for _ in progress.track(range(epochs), description="learning"):
        for rows in np.array_split(rng.permutation(len(lessons)), count):
            adam.zero_grad()
            _missed(torch, parts, [lessons[row] for row in rows]).backward()
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


def _lesson(torch: Any, mean: Floats, components: Floats, shown: Example) -> tuple[Any, ...]:
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


def _parts(torch: Any, mean_pose: Floats) -> list[Any]:
    """Think, deepen, remember, join, say; it begins by saying the mean pose."""
    thinks, keeps, joins = LAYERS
    say = torch.nn.Linear(joins, SAYS)
    with torch.no_grad():
        say.weight *= 0.3
        say.bias[: len(mean_pose)] = torch.from_numpy(mean_pose)
    return [
        torch.nn.Linear(2 * COMPONENTS + BESIDE, thinks),
        torch.nn.Linear(thinks, thinks),
        torch.nn.GRU(thinks, keeps, batch_first=True),
        torch.nn.Linear(thinks + keeps, joins),
        say,
    ]


def _missed(torch: Any, parts: list[Any], lessons: list[tuple[Any, ...]]) -> Any:
    """Mean distance of the joints in statures, and how wrong the sureness about it is."""
    seen, due, real, stature_m = (
        torch.nn.utils.rnn.pad_sequence(part, batch_first=True)
        for part in zip(*lessons, strict=True)
    )
    with torch.autocast("cpu", dtype=torch.bfloat16):
        said = _said(torch, parts, seen).float()
    places, sure = said[..., : -len(JOINTS)], said[..., -len(JOINTS) :]
    off = (places - due).unflatten(-1, (-1, 3)).square().sum(-1).add(1e-5).sqrt()
    near = (off.detach() * stature_m[..., None] < NEAR_M).float()
    unsure = torch.nn.functional.binary_cross_entropy_with_logits(sure, near, reduction="none")
    return ((off + SURE_SHARE * unsure).mean(-1) * real).sum() / real.sum()


def _said(torch: Any, parts: list[Any], seen: Any) -> Any:
    """What the network says of performances, (performances, instants, SAYS)."""
    think, deepen, remember, join, say = parts
    thought = torch.relu(think(seen))
    thought = torch.relu(deepen(thought) + thought)
    return say(torch.relu(join(torch.cat([thought, _kept(torch, remember, thought)], -1))))


def _kept(torch: Any, unit: Any, thought: Any) -> Any:
    """What a gated recurrent unit remembers after each instant: in half precision, which the
    library's own loop has not."""
    linear, own = torch.nn.functional.linear, unit.hidden_size
    taken = linear(thought, unit.weight_ih_l0, unit.bias_ih_l0)
    memory, found = torch.zeros_like(taken[:, 0, :own]), []
    for take in taken.unbind(1):
        keep = linear(memory, unit.weight_hh_l0, unit.bias_hh_l0)
        reset, update = torch.sigmoid(take[:, : 2 * own] + keep[:, : 2 * own]).split(own, 1)
        new = torch.tanh(take[:, 2 * own :] + reset * keep[:, 2 * own :])
        memory = new + update * (memory - new)
        found.append(memory)
    return torch.stack(found, 1)


def _network(mean: Floats, components: Floats, parts: list[Any]) -> Network:
    def pair(weight: Any, bias: Any) -> Iterator[Any]:
        yield halves(weight.detach().numpy().T)
        yield bias.detach().numpy().copy()

    think, deepen, remember, join, say = parts
    return Network(
        halves(components),
        -mean @ components,
        *pair(think.weight, think.bias),
        *pair(deepen.weight, deepen.bias),
        *pair(remember.weight_ih_l0, remember.bias_ih_l0),
        *pair(remember.weight_hh_l0, remember.bias_hh_l0),
        *pair(join.weight, join.bias),
        *pair(say.weight, say.bias),
    )
