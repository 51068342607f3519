"""The network that proposes poses, as PyTorch learns it: what it says, and how far that is off."""

from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from integrator.proposal.network_weights import JOINTS, SAYS, Network, halves
from integrator.proposal.silhouette_window import BESIDE

LAYERS: Final = (512, 512, 384)
"""Units that think (twice), remember and join."""
SURE_SHARE: Final = 0.01
"""Weight of what the network says of its sureness beside a distance in statures."""
NEAR_M: Final = 0.05
"""What it is sure of: a joint is no farther off."""

Floats = NDArray[np.float32]


def parts_of(torch: Any, components: int, mean_pose: Floats) -> list[Any]:
    """Think, deepen, remember, join, say: untaught layers that say the mean pose.

    Args:
        torch: PyTorch, which is loaded where it is needed only.
        components: Of each of both views' windows.
        mean_pose: (SAYS - joints,) in statures.
    """
    thinks, keeps, joins = LAYERS
    say = torch.nn.Linear(joins, SAYS)
    with torch.no_grad():
        say.weight *= 0.3
        say.bias[: len(mean_pose)] = torch.from_numpy(mean_pose)
    return [
        torch.nn.Linear(2 * components + BESIDE, thinks),
        torch.nn.Linear(thinks, thinks),
        torch.nn.GRU(thinks, keeps, batch_first=True),
        torch.nn.Linear(thinks + keeps, joins),
        say,
    ]


def missed(torch: Any, parts: list[Any], lessons: list[tuple[Any, ...]]) -> Any:
    """Mean distance of the joints in statures, and how wrong the sureness about it is.

    Args:
        torch: PyTorch.
        parts: Of the network.
        lessons: Performances of any length: inputs, what is due, ones, and the stature in metres,
            each a tensor of (instants, ...).
    """
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


def network_of(mean: Floats, components: Floats, parts: list[Any]) -> Network:
    """The weights as `integrator.proposal.network_weights` keeps them.

    Args:
        mean: (CELLS,) window.
        components: (CELLS, components).
        parts: Of the network.
    """

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
