"""The proposing networks in PyTorch: layers, loss and training rounds."""

from collections.abc import Iterator, Sequence
from types import ModuleType
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import Progress

from integrator.proposal.network_weights import JOINTS, to_bfloat16
from integrator.proposal.silhouette_window import Floats
from lab.training.training import TrainingError
from runtime.terminal import bar

if TYPE_CHECKING:
    from torch import Tensor, autocast, nn

Parts: TypeAlias = "list[nn.Module]"
"""fc1, fc2, the recurrent unit, fc3, out: the result of `parts_of`."""
Shown: TypeAlias = "tuple[Tensor, ...]"
"""A performance: its inputs, targets, ones, its stature; each (instants, ...)."""

CONFIDENCE_SHARE: Final = 0.01
"""Weight of the confidence's loss, relative to a distance in statures."""
MIDDLE_SHARE: Final = 0.3
"""Weight of the hips' middle, for a network that outputs it, relative to a joint's place from
there."""
NEAR_M: Final = 0.05
"""Distance to which confidence refers: a joint is within it."""
WARM_STEPS: Final = 150
DECAY: Final = 1e-4
STEEPEST: Final = 1.0
"""Bound of a gradient's norm."""


class Round(NamedTuple):
    """Learning-rate schedule of a round: the rate rises, then falls to zero."""

    epochs: int
    rate: float
    """Highest learning rate."""
    batch: int
    """Number of performances per batch."""


def torch_or_refuse() -> ModuleType:
    """PyTorch, which only training needs.

    Raises:
        TrainingError: When it is not installed.
    """
    try:
        import torch
    except ImportError as error:
        raise TrainingError(
            "learning proposals needs PyTorch: pip install 'tritrack[train]'"
        ) from error
    return torch


def halved(torch: ModuleType) -> "autocast":
    """Numbers of half the length, where the processor reckons with them: without its instructions
    they take nine to fifteen times as long as whole ones.

    Args:
        torch: The PyTorch module.
    """
    able = torch.cpu._is_avx512_bf16_supported()
    return torch.autocast("cpu", dtype=torch.bfloat16, enabled=able)


def parts_of(torch: ModuleType, told: int, units: tuple[int, int, int], mean_due: Floats) -> Parts:
    """fc1, fc2, the recurrent unit, fc3, out: untrained layers whose output is the mean target.

    Args:
        torch: The PyTorch module, loaded only where needed.
        told: Number of inputs.
        units: Units of fc1 and fc2, of the recurrent unit, and of fc3.
        mean_due: Mean target, statures.
    """
    hidden, memory, joined = units
    out = torch.nn.Linear(joined, len(mean_due) + len(JOINTS))
    with torch.no_grad():
        out.weight *= 0.3
        out.bias[: len(mean_due)] = torch.from_numpy(mean_due)
    return [
        torch.nn.Linear(told, hidden),
        torch.nn.Linear(hidden, hidden),
        torch.nn.GRU(hidden, memory, batch_first=True),
        torch.nn.Linear(hidden + memory, joined),
        out,
    ]


def learn(
    torch: ModuleType,
    parts: Parts,
    examples: list[Shown],
    rounds: Sequence[Round],
    seed: int,
    console: Console,
) -> None:
    """Train a network on examples by Adam; the results of all rounds are averaged.

    Args:
        torch: The PyTorch module.
        parts: The network's layers, changed in place.
        examples: Performances, in the form of `loss`.
        rounds: Number of epochs of each round, one after the other.
        seed: Seed of the order of the performances.
        console: Shows progress.
    """
    rng, ends = np.random.default_rng(seed), []
    weights = [weight for part in parts for weight in part.parameters()]
    with bar(console) as progress:
        for one in rounds:
            _round(torch, parts, examples, rng, one, progress)
            ends.append([weight.detach().clone() for weight in weights])
    with torch.no_grad():  # better than either end (Izmailov et al. 2018)
        for weight, *reached in zip(weights, *ends, strict=True):
            weight.copy_(torch.stack(reached).mean(0))


def _round(
    torch: ModuleType,
    parts: Parts,
    examples: list[Shown],
    rng: np.random.Generator,
    how: Round,
    progress: Progress,
) -> None:
    """Train on all examples that many times, in random orders."""
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
            loss(torch, parts, [examples[row] for row in rows]).backward()
            torch.nn.utils.clip_grad_norm_(weights, STEEPEST)
            adam.step()
            pace.step()


def loss(torch: ModuleType, parts: Parts, examples: list[Shown]) -> "Tensor":
    """Mean distance of the joints in statures, plus the loss of the confidence.

    Args:
        torch: The PyTorch module.
        parts: The network's layers.
        examples: Performances of any length: inputs, targets (the joints, and the hips' middle
            where the network outputs it), ones, and the stature in metres, each a tensor of
            (instants, ...).
    """
    seen, due, real, stature_m = (
        torch.nn.utils.rnn.pad_sequence(part, batch_first=True)
        for part in zip(*examples, strict=True)
    )
    with halved(torch):
        outputs = _outputs(torch, parts, seen).float()
    places, confidence = outputs[..., : -len(JOINTS)], outputs[..., -len(JOINTS) :]
    off = (places - due).unflatten(-1, (-1, 3)).square().sum(-1).add(1e-5).sqrt()
    off, middle = off[..., : len(JOINTS)], off[..., len(JOINTS) :].sum(-1)
    near = (off.detach() * stature_m[..., None] < NEAR_M).float()
    confidence_loss = torch.nn.functional.binary_cross_entropy_with_logits(
        confidence, near, reduction="none"
    )
    wrong = (off + CONFIDENCE_SHARE * confidence_loss).mean(-1) + MIDDLE_SHARE * middle
    return (wrong * real).sum() / real.sum()


def _outputs(torch: ModuleType, parts: Parts, seen: "Tensor") -> "Tensor":
    """The network's output for performances, (performances, instants, outputs)."""
    fc1, fc2, gru, fc3, out = parts
    hidden = torch.relu(fc1(seen))
    hidden = torch.relu(fc2(hidden) + hidden)
    return out(torch.relu(fc3(torch.cat([hidden, _hidden_states(torch, gru, hidden)], -1))))


def _hidden_states(torch: ModuleType, unit: "nn.GRU", hidden: "Tensor") -> "Tensor":
    """The state of a gated recurrent unit after each instant, in half precision, which the
    library's own loop lacks."""
    linear, own = torch.nn.functional.linear, unit.hidden_size
    taken = linear(hidden, unit.weight_ih_l0, unit.bias_ih_l0)
    memory, found = torch.zeros_like(taken[:, 0, :own]), []
    for take in taken.unbind(1):
        keep = linear(memory, unit.weight_hh_l0, unit.bias_hh_l0)
        reset, update = torch.sigmoid(take[:, : 2 * own] + keep[:, : 2 * own]).split(own, 1)
        new = torch.tanh(take[:, 2 * own :] + reset * keep[:, 2 * own :])
        memory = new + update * (memory - new)
        found.append(memory)
    return torch.stack(found, 1)


def layers_of(parts: Parts) -> Iterator[NDArray[Any]]:
    """Weights and biases of a network in the form of `integrator.proposal.network_weights`."""
    fc1, fc2, gru, fc3, out = parts
    for weight, bias in (
        (fc1.weight, fc1.bias),
        (fc2.weight, fc2.bias),
        (gru.weight_ih_l0, gru.bias_ih_l0),
        (gru.weight_hh_l0, gru.bias_hh_l0),
        (fc3.weight, fc3.bias),
        (out.weight, out.bias),
    ):
        yield to_bfloat16(weight.detach().numpy().T)
        yield bias.detach().numpy().copy()
