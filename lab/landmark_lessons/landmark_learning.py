"""How far the network of landmarks is taught: one batch more, kept on disk, and taken up again."""

import copy
from collections.abc import Callable, Iterator
from multiprocessing.pool import Pool
from pathlib import Path
from typing import Final, NamedTuple, TypeVar

import torch
from torch import nn

from lab.landmark_lessons import landmark_loss
from synth.picture.composites import Composite

RATE: Final = 2e-3
"""Of what learns fastest, at its height."""
DECAY: Final = 1e-4
STEEPEST: Final = 5.0
"""Size that a slope is cut to."""
AHEAD: Final = 4
"""Batches that are made before they are asked for."""


Wish = TypeVar("Wish")
"""What a batch is to be made of."""


class Paced(NamedTuple):
    """Weights that learn alike."""

    weights: list[nn.Parameter]
    pace: float
    """How fast, as a share of the rate."""
    pull: float = 0.0
    """Share of the way back to where they began by which a batch at the full rate pulls them."""


class Work(NamedTuple):
    """How far a training is."""

    network: nn.Module
    mean: nn.Module
    """A network whose weights are the running mean of those of `network`."""
    adam: "torch.optim.AdamW"
    batch: int
    """The next one."""


def begun(network: nn.Module, parts: list[Paced]) -> Work:
    """The start of teaching a network.

    Args:
        network: Is changed by what follows.
        parts: Of its weights, and how fast they learn; all others stay as they are.
    """
    network.requires_grad_(False)
    for part in parts:
        for weights in part.weights:
            weights.requires_grad_(True)
    groups = [
        {
            "params": part.weights,
            "pace": part.pace,
            "pull": part.pull,
            "began": [weights.detach().clone() for weights in part.weights],
        }
        for part in parts
    ]
    adam = torch.optim.AdamW(groups, weight_decay=DECAY)
    return Work(network, copy.deepcopy(network), adam, 0)


def resumed(work: Work, kept: Path) -> Work:
    """What was kept of a work, where that is."""
    if not kept.exists():
        return work
    held = torch.load(kept, weights_only=True)
    work.network.load_state_dict(held["network"])
    work.mean.load_state_dict(held["mean"])
    work.adam.load_state_dict(held["adam"])
    return work._replace(batch=int(held["batch"]))


def keep(work: Work, kept: Path) -> None:
    """Write it, then put it in the place of what was kept before."""
    parts = {name: getattr(work, name).state_dict() for name in ("network", "mean", "adam")}
    new = kept.with_name("new.pt")
    torch.save({**parts, "batch": work.batch}, new)
    new.rename(kept)


def learnt_from(work: Work, shown: list[Composite], rate: float, share: float) -> Work:
    """One batch more.

    Args:
        work: Its network is changed.
        shown: The batch.
        rate: How fast it learns, as a share of RATE.
        share: Of the running mean that this batch replaces.
    """
    network, mean, adam, at = work
    for group in adam.param_groups:
        group["lr"] = RATE * rate * group["pace"]
    adam.zero_grad()
    landmark_loss.loss(network, shown).backward()
    torch.nn.utils.clip_grad_norm_(network.parameters(), STEEPEST)
    adam.step()
    with torch.no_grad():
        for group in adam.param_groups:
            for weights, first in zip(group["params"], group["began"], strict=True):
                weights.lerp_(first, rate * group["pull"])
        own, running = network.state_dict(), mean.state_dict()
        for name, value in running.items():
            if value.is_floating_point():
                value.lerp_(own[name], share)
    return work._replace(batch=at + 1)


def ahead(
    pool: Pool, compose: Callable[[Wish], list[Composite]], wishes: Iterator[Wish]
) -> Iterator[list[Composite]]:
    """Batches in their order, a few made by a pool before they are asked for."""
    coming = []
    for wanted in wishes:
        coming.append(pool.apply_async(compose, (wanted,)))
        if len(coming) > AHEAD:
            yield coming.pop(0).get()
    for last in coming:
        yield last.get()
