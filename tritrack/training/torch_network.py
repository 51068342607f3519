"""The network that proposes poses, as PyTorch trains it: its outputs and its loss."""

from collections.abc import Iterator
from typing import Any, Final

from integrator.proposal.network_weights import JOINTS, OUTPUTS, PoseNetwork, to_bfloat16
from integrator.proposal.silhouette_window import BESIDE, Floats

UNITS: Final = (512, 512, 384)
"""Units of fc1 and fc2, of the recurrent unit, and of fc3."""
CONFIDENCE_SHARE: Final = 0.01
"""Weight of what the network says of its sureness beside a distance in statures."""
NEAR_M: Final = 0.05
"""What it is sure of: a joint is no farther off."""


def parts_of(torch: Any, components: int, mean_pose: Floats) -> list[Any]:
    """fc1, fc2, the recurrent unit, fc3, out: untrained layers that put out the mean pose.

    Args:
        torch: PyTorch, which is loaded where it is needed only.
        components: Of each of both views' windows.
        mean_pose: (SAYS - joints,) in statures.
    """
    hidden, memory, joined = UNITS
    out = torch.nn.Linear(joined, OUTPUTS)
    with torch.no_grad():
        out.weight *= 0.3
        out.bias[: len(mean_pose)] = torch.from_numpy(mean_pose)
    return [
        torch.nn.Linear(2 * components + BESIDE, hidden),
        torch.nn.Linear(hidden, hidden),
        torch.nn.GRU(hidden, memory, batch_first=True),
        torch.nn.Linear(hidden + memory, joined),
        out,
    ]


def loss(torch: Any, parts: list[Any], examples: list[tuple[Any, ...]]) -> Any:
    """Mean distance of the joints in statures, and how wrong the sureness about it is.

    Args:
        torch: PyTorch.
        parts: Of the network.
        lessons: Performances of any length: inputs, what is due, ones, and the stature in metres,
            each a tensor of (instants, ...).
    """
    seen, due, real, stature_m = (
        torch.nn.utils.rnn.pad_sequence(part, batch_first=True)
        for part in zip(*examples, strict=True)
    )
    with torch.autocast("cpu", dtype=torch.bfloat16):
        outputs = _outputs(torch, parts, seen).float()
    places, confidence = outputs[..., : -len(JOINTS)], outputs[..., -len(JOINTS) :]
    off = (places - due).unflatten(-1, (-1, 3)).square().sum(-1).add(1e-5).sqrt()
    near = (off.detach() * stature_m[..., None] < NEAR_M).float()
    confidence_loss = torch.nn.functional.binary_cross_entropy_with_logits(
        confidence, near, reduction="none"
    )
    return ((off + CONFIDENCE_SHARE * confidence_loss).mean(-1) * real).sum() / real.sum()


def _outputs(torch: Any, parts: list[Any], seen: Any) -> Any:
    """What the network says of performances, (performances, instants, SAYS)."""
    fc1, fc2, gru, fc3, out = parts
    hidden = torch.relu(fc1(seen))
    hidden = torch.relu(fc2(hidden) + hidden)
    return out(torch.relu(fc3(torch.cat([hidden, _hidden_states(torch, gru, hidden)], -1))))


def _hidden_states(torch: Any, unit: Any, hidden: Any) -> Any:
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


def network_of(mean: Floats, components: Floats, parts: list[Any]) -> PoseNetwork:
    """The weights as `integrator.proposal.network_weights` keeps them.

    Args:
        mean: (CELLS,) window.
        components: (CELLS, components).
        parts: Of the network.
    """

    def pair(weight: Any, bias: Any) -> Iterator[Any]:
        yield to_bfloat16(weight.detach().numpy().T)
        yield bias.detach().numpy().copy()

    fc1, fc2, gru, fc3, out = parts
    return PoseNetwork(
        to_bfloat16(components),
        -mean @ components,
        *pair(fc1.weight, fc1.bias),
        *pair(fc2.weight, fc2.bias),
        *pair(gru.weight_ih_l0, gru.bias_ih_l0),
        *pair(gru.weight_hh_l0, gru.bias_hh_l0),
        *pair(fc3.weight, fc3.bias),
        *pair(out.weight, out.bias),
    )
