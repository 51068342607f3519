"""The network of landmarks, as PyTorch trains it: its layers, its loss, its file."""

import math
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn
from torch.nn import functional

from synth.picture.composites import Composite
from viewer.landmarks.landmark_looks import BINS, CELLS
from viewer.landmarks.landmark_network import FARTHEST
from viewer.landmarks.landmark_window import GREY, PLANES, SIDE

WIDTHS: Final = (16, 32, 64, 96)
"""Channels after each halving of the picture."""
JOINTS: Final = 15
STEP: Final = 64
"""Levels of a byte, from GREY on, that are 1 for the network."""
SPREAD: Final = 4.0
"""Standard deviation of what a joint's map should show, pixels."""
NEAR: Final = 0.03
"""What the network is sure of: a joint is no farther off, in statures."""
SHARES: Final = {"facing": 0.3, "nobody": 0.2, "sure": 0.3}
"""Weights of what is told beside the maps."""
UPRIGHT: Final = 0.35
"""A trunk whose front points less than this aside faces nowhere."""
FACING_SHARPNESS: Final = 6.0


class _Residual(nn.Module):
    """Two layers that add to what they are given."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.first, self.second = _layer(width, width), _layer(width, width, bent=False)

    def forward(self, x: Any) -> Any:
        return torch.relu(x + self.second(self.first(x)))


class LandmarkNetwork(nn.Module):
    """Four halvings, of which the last sees everything, and back up to a quarter of the size."""

    def __init__(self) -> None:
        """Untrained."""
        super().__init__()
        one, two, three, four = WIDTHS
        self.fine = nn.Sequential(_layer(PLANES, one, 2), _layer(one, two, 2), _Residual(two))
        self.middle = nn.Sequential(_layer(two, three, 2), _Residual(three), _Residual(three))
        self.coarse = nn.Sequential(_layer(three, four, 2), _Residual(four), _Residual(four))
        self.all = nn.Sequential(
            nn.AdaptiveAvgPool2d(1), nn.Flatten(), nn.Linear(four, four), nn.ReLU()
        )
        self.back = nn.Linear(four, four)
        self.to_middle, self.to_fine = nn.Conv2d(four, three, 1), nn.Conv2d(three, two, 1)
        self.mix_middle, self.mix_fine = _layer(three, three), _layer(two, two)
        self.maps, self.told = nn.Conv2d(two, JOINTS, 1), nn.Linear(four, BINS + 1 + JOINTS)
        self.up = nn.Upsample(scale_factor=2, mode="nearest")

    def forward(self, x: Any) -> tuple[Any, Any]:
        """Planes (n, PLANES, SIDE, SIDE) in; maps (n, 15, CELLS, CELLS), and what is told beside
        them (n, BINS + 1 + 15), out: all of it logits."""
        fine = self.fine(x)
        middle = self.middle(fine)
        coarse = self.coarse(middle)
        everything = self.all(coarse)
        coarse = torch.relu(coarse + self.back(everything)[:, :, None, None])
        middle = self.mix_middle(torch.relu(middle + self.up(self.to_middle(coarse))))
        fine = self.mix_fine(torch.relu(fine + self.up(self.to_fine(middle))))
        return self.maps(fine), self.told(everything)


def fill(
    network: LandmarkNetwork, weights: list[tuple[NDArray[np.float32], NDArray[np.float32]]]
) -> None:
    """Give a network the weights and offsets of a file, whose normalisations are folded into them:
    its own then change nothing, as long as it is not told to learn them (`eval`).

    Args:
        network: Is changed.
        weights: Of all layers; of those of one shape in their order.
    """
    left, offset = list(weights), None
    with torch.no_grad():
        for part in network.modules():
            if isinstance(part, nn.Conv2d | nn.Linear):
                shape = tuple(part.weight.shape)
                at = next(i for i, (weight, _) in enumerate(left) if weight.shape == shape)
                weight, offset = (torch.from_numpy(np.array(values)) for values in left.pop(at))
                part.weight.copy_(weight)
                if part.bias is not None:
                    part.bias.copy_(offset)
            elif isinstance(part, nn.BatchNorm2d):
                part.weight.fill_(1.0)
                part.bias.copy_(offset)
                part.running_mean.zero_()
                part.running_var.fill_(1.0 - part.eps)


def _layer(inputs: int, outputs: int, stride: int = 1, bent: bool = True) -> Any:
    parts = [
        nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False),
        nn.BatchNorm2d(outputs),
        *([nn.ReLU()] if bent else []),
    ]
    return nn.Sequential(*parts)


def _halved() -> Any:
    """Numbers of half the length, where the processor reckons with them: without its instructions
    they take fifteen times as long as whole ones."""
    able = torch.cpu._is_avx512_bf16_supported()
    return torch.autocast("cpu", dtype=torch.bfloat16, enabled=able)


def planes_of(shown: list[Composite]) -> Any:
    """What the network sees of composites."""
    pictures = np.stack([np.dstack([one.picture, one.outline]) for one in shown])
    planes = (torch.from_numpy(pictures).permute(0, 3, 1, 2).float() - GREY) / STEP
    return planes.contiguous(memory_format=torch.channels_last)


def loss(network: Any, shown: list[Composite]) -> Any:
    """Cross entropies of maps, facing, whether somebody is there, and how sure the maps are."""
    with _halved():
        maps, told = network(planes_of(shown))
    maps, told = maps.float().flatten(2), told.float()
    joints = torch.from_numpy(np.stack([one.joints_px for one in shown]))
    inside = torch.from_numpy(np.stack([one.inside for one in shown]))
    due = _maps_due(joints)
    where = -(due * torch.log_softmax(maps, -1)).sum(-1)
    stature = torch.tensor([one.stature_px for one in shown])
    off = (peaks(maps.detach()) - joints).norm(dim=-1)
    near = ((off < NEAR * stature[:, None]) & inside).float()
    nobody = torch.tensor([float(one.nobody) for one in shown])
    binary = functional.binary_cross_entropy_with_logits
    return (
        (where * inside).sum() / inside.sum()
        + SHARES["facing"] * _facing_loss(told[:, :BINS], shown)
        + SHARES["nobody"] * binary(told[:, BINS], nobody)
        + SHARES["sure"] * binary(told[:, BINS + 1 :], near)
    )


def peaks(maps: Any) -> Any:
    """Joints (n, 15, 2) px of logits (n, 15, CELLS^2): as `landmark_network` reads them."""
    share = torch.softmax(maps, -1)
    best = share.argmax(-1)
    grid = functional.pad(share.unflatten(-1, (CELLS, CELLS)), (1, 1, 1, 1))
    about = grid.unfold(-2, 3, 1).unfold(-2, 3, 1).flatten(2, 3)
    about = about.gather(2, best[..., None, None, None].expand(-1, -1, 1, 3, 3)).squeeze(2)
    cells = torch.stack([best % CELLS, best // CELLS], -1) + 0.5
    between = torch.stack([_between(about.sum(-2)), _between(about.sum(-1))], -1)
    return (cells + between) * (SIDE / CELLS)


def _between(three: Any) -> Any:
    """Where bells through three neighbours (..., 3) have their peaks, from the middle, in cells."""
    low, middle, high = (three + 1e-9).log().unbind(-1)
    bent = (low - 2.0 * middle + high).clamp(max=-1e-3)
    return (0.5 * (low - high) / bent).clamp(-FARTHEST, FARTHEST)


def _places() -> Any:
    """(CELLS,) middles of the cells, px."""
    return (torch.arange(CELLS) + 0.5) * (SIDE / CELLS)


def _maps_due(joints: Any) -> Any:
    """Shares (n, 15, CELLS^2) about the joints."""
    places = _places()
    x = (places - joints[..., 0, None]) ** 2
    y = (places - joints[..., 1, None]) ** 2
    far = y[..., :, None] + x[..., None, :]
    return torch.softmax((-far / (2 * SPREAD**2)).flatten(2), -1)


def _facing_loss(bins: Any, shown: list[Composite]) -> Any:
    facing = torch.from_numpy(np.stack([one.facing for one in shown]))
    turn = torch.atan2(facing[:, 0], facing[:, 1])
    told = (facing.norm(dim=1) > UPRIGHT).float()
    middles = torch.arange(BINS) * (2 * math.pi / BINS)
    due = torch.softmax(FACING_SHARPNESS * torch.cos(turn[:, None] - middles), -1)
    wrong = -(due * torch.log_softmax(bins, -1)).sum(-1)
    return (wrong * told).sum() / told.sum().clamp(min=1.0)


def export(network: Any, out: Path) -> None:
    """Write a trained network as ONNX, its normalisations folded into its layers."""
    seen = torch.zeros(1, PLANES, SIDE, SIDE)
    torch.onnx.export(
        network.eval(),
        (seen,),
        str(out),
        input_names=["planes"],
        output_names=["maps", "told"],
        external_data=False,
        verbose=False,
    )


def joints_off(network: Any, shown: list[Composite]) -> NDArray[np.float64]:
    """(n, 15) how far off joints are, in statures; NaN for those that are not in the picture."""
    with torch.no_grad(), _halved():
        maps, _ = network.eval()(planes_of(shown))
    found = peaks(maps.float().flatten(2)).numpy()
    off = np.linalg.norm(found - np.stack([one.joints_px for one in shown]), axis=-1)
    stature = np.array([one.stature_px for one in shown])
    inside = np.stack([one.inside for one in shown])
    return np.where(inside, off / stature[:, None], np.nan)
