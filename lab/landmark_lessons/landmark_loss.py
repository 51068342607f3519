"""How wrong the network of landmarks is."""

import math
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn
from torch.nn import functional

from lab.landmark_lessons.landmark_planes import masks_of, planes_of
from lab.training.torch_network import halved
from synth.picture.composites import Composite
from synth.picture.picture_examples import SIDE_PX
from viewer.landmarks.landmark_looks import BINS, CELLS
from viewer.landmarks.landmark_network import FARTHEST

SPREAD: Final = 3.0
"""Standard deviation of what a joint's map should show, pixels of a composite."""
NEAR: Final = 0.03
"""What the network is sure of: a joint is no farther off, in statures."""
SHARES: Final = {"facing": 0.3, "nobody": 0.2, "sure": 0.3, "mask": 0.5}
"""Weights of what is told beside the maps, and of the mask."""
UPRIGHT: Final = 0.35
"""A trunk whose front points less than this aside faces nowhere."""
FACING_SHARPNESS: Final = 6.0
GROUP: Final = 64
"""Pictures that are looked at together."""


def loss(network: nn.Module, shown: list[Composite]) -> torch.Tensor:
    """Cross entropies of maps, facing, whether a person is there, how sure the maps are, and of
    the person's mask."""
    with halved(torch):
        maps, told, mask = network(planes_of(shown))
    maps, told = maps.float().flatten(2), told.float()
    joints = torch.from_numpy(np.stack([one.joints_px for one in shown]))
    inside = torch.from_numpy(np.stack([one.inside for one in shown]))
    where = -(_maps_due(joints) * torch.log_softmax(maps, -1)).sum(-1)
    off = (peaks(maps.detach()) - joints).norm(dim=-1)
    near = near_enough(off, shown)
    nobody = torch.tensor([float(one.nobody) for one in shown])
    binary = functional.binary_cross_entropy_with_logits
    return (
        (where * inside).sum() / inside.sum()
        + SHARES["facing"] * _facing_loss(told[:, :BINS], shown)
        + SHARES["nobody"] * binary(told[:, BINS], nobody)
        + SHARES["sure"] * binary(told[:, BINS + 1 :], near)
        + SHARES["mask"] * _mask_loss(mask.float(), shown)
    )


def near_enough(off: torch.Tensor, shown: list[Composite]) -> torch.Tensor:
    """(n, 15) 1 where a joint is in the picture and found near where it is, of how many pixels it
    is off; else 0."""
    stature = torch.tensor([one.stature_px for one in shown])
    inside = torch.from_numpy(np.stack([one.inside for one in shown]))
    return ((off < NEAR * stature[:, None]) & inside).float()


def peaks(maps: torch.Tensor) -> torch.Tensor:
    """Joints (n, 15, 2) px of logits (n, 15, CELLS^2): as `landmark_network` reads them."""
    best, about = shares_about(maps)
    cells = torch.stack([best % CELLS, best // CELLS], -1) + 0.5
    between = torch.stack([_between(about.sum(-2)), _between(about.sum(-1))], -1)
    return (cells + between) * (SIDE_PX / CELLS)


def shares_about(maps: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """The highest cell of each map of logits (n, 15, CELLS^2), and the shares about it
    (n, 15, 3, 3)."""
    share = torch.softmax(maps, -1)
    best = share.argmax(-1)
    grid = functional.pad(share.unflatten(-1, (CELLS, CELLS)), (1, 1, 1, 1))
    about = grid.unfold(-2, 3, 1).unfold(-2, 3, 1).flatten(2, 3)
    return best, about.gather(2, best[..., None, None, None].expand(-1, -1, 1, 3, 3)).squeeze(2)


def _between(three: torch.Tensor) -> torch.Tensor:
    """Where bells through three neighbours (..., 3) have their peaks, from the middle, in cells."""
    low, middle, high = (three + 1e-9).log().unbind(-1)
    bent = (low - 2.0 * middle + high).clamp(max=-1e-3)
    return (0.5 * (low - high) / bent).clamp(-FARTHEST, FARTHEST)


def _places() -> torch.Tensor:
    """(CELLS,) middles of the cells, px."""
    return (torch.arange(CELLS) + 0.5) * (SIDE_PX / CELLS)


def _maps_due(joints: torch.Tensor) -> torch.Tensor:
    """Shares (n, 15, CELLS^2) about the joints."""
    places = _places()
    x = (places - joints[..., 0, None]) ** 2
    y = (places - joints[..., 1, None]) ** 2
    far = y[..., :, None] + x[..., None, :]
    return torch.softmax((-far / (2 * SPREAD**2)).flatten(2), -1)


def _facing_loss(bins: torch.Tensor, shown: list[Composite]) -> torch.Tensor:
    facing = torch.from_numpy(np.stack([one.facing for one in shown]))
    turn = torch.atan2(facing[:, 0], facing[:, 1])
    told = (facing.norm(dim=1) > UPRIGHT).float()
    middles = torch.arange(BINS) * (2 * math.pi / BINS)
    due = torch.softmax(FACING_SHARPNESS * torch.cos(turn[:, None] - middles), -1)
    wrong = -(due * torch.log_softmax(bins, -1)).sum(-1)
    return (wrong * told).sum() / told.sum().clamp(min=1.0)


def _mask_loss(mask: torch.Tensor, shown: list[Composite]) -> torch.Tensor:
    due, known = (torch.from_numpy(values) for values in masks_of(shown))
    binary = functional.binary_cross_entropy_with_logits
    wrong = binary(mask, due, reduction="none").mean((1, 2))
    return (wrong * known).sum() / known.sum().clamp(min=1.0)


def answers(network: nn.Module, shown: list[Composite]) -> list[torch.Tensor]:
    """What a network says of composites, as its `forward`: maps, what is told beside, masks."""
    groups = [shown[at : at + GROUP] for at in range(0, len(shown), GROUP)]
    with torch.no_grad():
        found = [network.eval()(planes_of(group)) for group in groups]
    return [torch.cat(parts) for parts in zip(*found, strict=True)]


def joints_off(network: nn.Module, shown: list[Composite]) -> NDArray[np.float64]:
    """(n, 15) how far off joints are, in statures; NaN for those that are not in the picture."""
    maps, *_ = answers(network, shown)
    found = peaks(maps.flatten(2)).numpy()
    off = np.linalg.norm(found - np.stack([one.joints_px for one in shown]), axis=-1)
    stature = np.array([one.stature_px for one in shown])
    inside = np.stack([one.inside for one in shown])
    return np.where(inside, off / stature[:, None], np.nan)
