"""The networks that propose joints, as PyTorch trains them: their outputs, loss and rounds."""

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
    from torch import Tensor, nn

Parts: TypeAlias = "list[nn.Module]"
"""fc1, fc2, the recurrent unit, fc3, out: what `parts_of` gives."""
Shown: TypeAlias = "tuple[Tensor, ...]"
"""A performance: its inputs, what is due, ones, its stature; each (instants, ...)."""

CONFIDENCE_SHARE: Final = 0.01
"""Weight of what the network says of its sureness beside a distance in statures."""
MIDDLE_SHARE: Final = 0.3
"""Weight of where the hips' middle is, of a network that says it, beside a joint from there."""
NEAR_M: Final = 0.05
"""What it is sure of: a joint is no farther off."""
WARM_STEPS: Final = 150
DECAY: Final = 1e-4
STEEPEST: Final = 1.0
"""Size that a slope is cut to."""


class Round(NamedTuple):
    """How a round of training goes: the rate rises, and falls to nothing."""

    epochs: int
    rate: float
    """The highest."""
    batch: int
    """Performances that are shown at once."""


def torch_or_refuse() -> ModuleType:
    """PyTorch, which only learning needs.

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


def parts_of(torch: ModuleType, told: int, units: tuple[int, int, int], mean_due: Floats) -> Parts:
    """fc1, fc2, the recurrent unit, fc3, out: untrained layers that put out what is usually due.

    Args:
        torch: PyTorch, which is loaded where it is needed only.
        told: Inputs.
        units: Of fc1 and fc2, of the recurrent unit, and of fc3.
        mean_due: In statures.
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
    """Teach a network its examples, by Adam; what each round ends with is averaged.

    Args:
        torch: PyTorch.
        parts: Of the network: changed.
        examples: Performances, as `loss` takes them.
        rounds: One after the other.
        seed: Of the order of the performances.
        console: For progress.
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
            loss(torch, parts, [examples[row] for row in rows]).backward()
            torch.nn.utils.clip_grad_norm_(weights, STEEPEST)
            adam.step()
            pace.step()


def loss(torch: ModuleType, parts: Parts, examples: list[Shown]) -> "Tensor":
    """Mean distance of the joints in statures, and how wrong the sureness about it is.

    Args:
        torch: PyTorch.
        parts: Of the network.
        examples: Performances of any length: inputs, what is due (the joints, and the hips' middle
            where the network says that), ones, and the stature in metres, each a tensor of
            (instants, ...).
    """
    seen, due, real, stature_m = (
        torch.nn.utils.rnn.pad_sequence(part, batch_first=True)
        for part in zip(*examples, strict=True)
    )
    with torch.autocast("cpu", dtype=torch.bfloat16):
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
    """What the network says of performances, (performances, instants, outputs)."""
    fc1, fc2, gru, fc3, out = parts
    hidden = torch.relu(fc1(seen))
    hidden = torch.relu(fc2(hidden) + hidden)
    return out(torch.relu(fc3(torch.cat([hidden, _hidden_states(torch, gru, hidden)], -1))))


def _hidden_states(torch: ModuleType, unit: "nn.GRU", hidden: "Tensor") -> "Tensor":
    """What a gated recurrent unit remembers after each instant: in half precision, which the
    library's own loop has not."""
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
    """Weights and biases of a network as `integrator.proposal.network_weights` keeps them."""
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
