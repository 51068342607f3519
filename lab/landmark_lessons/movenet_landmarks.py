"""The network of landmarks: MoveNet's trunk, which photographs taught, and our heads on it."""

import copy
from typing import Any, Final

import torch
from torch import nn
from torch.nn import functional

from common.body.body import JOINT_NAMES
from lab.landmark_lessons.landmark_learning import Paced
from lab.landmark_lessons.movenet_layers import (
    ASIDES,
    BLOCK_WIDTHS,
    DEEP,
    POINTS,
    RISEN,
    MoveNet,
)
from viewer.landmarks.keypoint_layouts import POINT
from viewer.landmarks.landmark_looks import BINS, CELLS
from viewer.landmarks.landmark_window import GREY, PLANES

JOINTS: Final = 15
COLOURS: Final = PLANES - 1
FINE, EARLY = RISEN[-1], BLOCK_WIDTHS[ASIDES[-1]]
"""Channels at the finest of the way up, and of the block from which they come."""
MIXED, SUMMED, TOLD = 64, 96, 96
"""Units: of what corrects the maps, of what is summed of the coarsest stage, of what is told."""
MASK_WIDE, MASK_NARROW, MASK_CELLS = 48, 32, 5
"""Units of the mask's head, and how many cells across each of its two looks around is."""
SEEN_AS: Final = {"pelvis": ("l_hip", "r_hip"), "neck": ("l_shoulder", "r_shoulder")} | {
    "head_top": ("l_ear", "r_ear")
}
"""Which points lie about joints of ours that are none of COCO's."""
FAINT: Final = 0.15
"""So strong are those joints' maps at first: their points lie beside them."""
PER_PLACE: Final = 3
"""What is told of each point's map: where its middle is, across and down, and its peak."""
SCALE: Final = 0.3
"""By which logits and early features are made as large as the other features."""
SIDE_OF_CELL: Final = 4
"""Pixels of a window across a cell."""
STAYS: Final = ASIDES[-1] + 1
"""Blocks of the trunk that stay, with what is before them, as photographs taught them."""
TRUNK_PACE: Final = 0.05
"""How fast the rest of the trunk learns, as a share of the heads' rate: at 1e-4."""
PULL: Final = 0.002
"""Share of the way back to where it began by which a batch at the full rate pulls that rest."""


class MovenetLandmarks(nn.Module):
    """Windows of 192 pixels in; maps, what is told beside them, and the person's mask out.

    Our maps are the trunk's, of the points that are nearest to each joint, and a correction learnt
    from what the trunk sees and from the silhouette.
    """

    def __init__(self, photographed: MoveNet) -> None:
        """Our heads untrained: the maps are those of the photographs' points."""
        super().__init__()
        self.photographed = photographed
        seen = FINE + 2
        self.correction = nn.Sequential(
            nn.Conv2d(seen, seen, 3, padding=1, groups=seen),
            nn.Conv2d(seen, MIXED, 1),
            nn.ReLU(),
            nn.Conv2d(MIXED, JOINTS, 1),
        )
        self.nearest = nn.Conv2d(POINTS, JOINTS, 1)
        self.summed = nn.Sequential(nn.Conv2d(DEEP, SUMMED, 1), nn.ReLU())
        self.told = nn.Sequential(
            nn.Linear(2 * SUMMED + PER_PLACE * POINTS, TOLD),
            nn.ReLU(),
            nn.Linear(TOLD, BINS + 1 + JOINTS),
        )
        self.mask = nn.Sequential(
            nn.Conv2d(FINE + EARLY + JOINTS, MASK_WIDE, 1),
            nn.ReLU(),
            _around(MASK_WIDE),
            nn.Conv2d(MASK_WIDE, MASK_WIDE, 1),
            nn.ReLU(),
            _around(MASK_WIDE),
            nn.Conv2d(MASK_WIDE, MASK_NARROW, 1),
            nn.ReLU(),
            nn.Conv2d(MASK_NARROW, 1, 1),
        )
        self._begin()

    def forward(self, x: Any) -> tuple[Any, Any, Any]:
        """Levels of planes (n, PLANES, SIDE, SIDE), 0 to 255, in; out, all of it logits, maps
        (n, 15, CELLS, CELLS), what is told beside them (n, BINS + 1 + 15), and how probably a cell
        is the person's (n, CELLS, CELLS)."""
        fine, deep, heat, early = self.photographed(x[:, [2, 1, 0]])
        silhouette = (functional.avg_pool2d(x[:, COLOURS:], SIDE_OF_CELL) - GREY) / GREY
        is_known = (silhouette.abs() > 0.02).float().amax((2, 3), keepdim=True)
        correction = self.correction(
            torch.cat([fine, silhouette, is_known.expand_as(silhouette)], 1)
        )
        maps = self.nearest(heat) + correction
        summed = self.summed(deep)
        means = [summed.mean((2, 3)), summed.amax((2, 3)), *_places(heat)]
        mask = self.mask(torch.cat([fine, SCALE * early, SCALE * maps.detach()], 1))
        return maps, self.told(torch.cat(means, 1)), mask[:, 0]

    def heads(self) -> Paced:
        """What is ours, and learns at the full rate."""
        return Paced(
            _weights(self.correction, self.nearest, self.summed, self.told, self.mask), 1.0
        )

    def trunk(self) -> Paced:
        """What photographs taught, but for what is finest: it learns slowly, and is pulled back."""
        seen = self.photographed
        parts = (*seen.blocks[STAYS:], seen.last, seen.asides, seen.up, seen.heat)
        return Paced(_weights(*parts), TRUNK_PACE, PULL)

    def _begin(self) -> None:
        for values in (self.correction[-1].weight, self.correction[-1].bias, self.nearest.bias):
            nn.init.zeros_(values)
        nn.init.zeros_(self.nearest.weight)
        for joint, name in enumerate(JOINT_NAMES):
            points, strength = SEEN_AS.get(name, (name,)), FAINT if name in SEEN_AS else 1.0
            for point in points:
                self.nearest.weight.data[joint, POINT[point]] = strength / len(points)


def between(learnt: MovenetLandmarks, published: MoveNet, share: float) -> MovenetLandmarks:
    """A network with the heads of one, and a trunk between the published one and its own.

    Args:
        learnt: Is not changed.
        published: Its trunk as photographs taught it.
        share: 0 for the published trunk, 1 for the learnt one.
    """
    found = copy.deepcopy(learnt)
    start = published.state_dict()
    with torch.no_grad():
        for name, values in found.photographed.state_dict().items():
            values.copy_(start[name].lerp(values, share))
    return found


def _around(channels: int) -> nn.Conv2d:
    """A look around in each channel by itself."""
    return nn.Conv2d(channels, channels, MASK_CELLS, padding=MASK_CELLS // 2, groups=channels)


def _weights(*parts: nn.Module) -> list[nn.Parameter]:
    return [weights for part in parts for weights in part.parameters()]


def _places(heat: Any) -> tuple[Any, Any, Any]:
    """Where the middle of each point's map is, across and down, and its peak, each (n, POINTS)."""
    cells = heat.flatten(2)
    share = torch.softmax(cells, -1)
    middles = (torch.arange(CELLS, device=heat.device) + 0.5) / CELLS * 4.0 - 2.0
    across, down = middles.repeat(CELLS), middles.repeat_interleave(CELLS)
    return (share * across).sum(-1), (share * down).sum(-1), cells.amax(-1) * SCALE
