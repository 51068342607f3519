"""A network of landmarks on MoveNet's trunk: what photographs taught stays, our heads are added."""

from typing import Any, Final

import torch
from torch import nn
from torch.nn import functional

from common.body.body import JOINT_NAMES
from lab.landmark_lessons.landmark_layers import COLOURS, JOINTS, Paced
from lab.landmark_lessons.landmark_planes import STEP
from lab.landmark_lessons.movenet_layers import DEEP, POINTS, RISEN, MoveNet
from viewer.landmarks.keypoint_layouts import POINT
from viewer.landmarks.landmark_looks import BINS, CELLS
from viewer.landmarks.landmark_window import GREY

FINE: Final = RISEN[-1]
MIXED, SUMMED, TOLD = 64, 96, 96
"""Units: of what corrects the maps, of what is summed of the coarsest stage, of what is told."""
SEEN_AS: Final = {"pelvis": ("l_hip", "r_hip"), "neck": ("l_shoulder", "r_shoulder")} | {
    "head_top": ("l_ear", "r_ear")
}
"""Which points lie about joints of ours that are none of COCO's."""
FAINT: Final = 0.15
"""So strong are those joints' maps at first: their points lie beside them."""
PER_PLACE: Final = 3
"""What is told of each point's map: where its middle is, across and down, and its peak."""
PEAK_SCALE: Final = 0.3
SIDE_OF_CELL: Final = 4
"""Pixels of a window across a cell."""


class MovenetLandmarks(nn.Module):
    """Windows of 192 pixels in; maps and what is told beside them out, as `LandmarkNetwork`.

    The trunk and its heat maps stay as photographs taught them. Our maps are theirs, of the points
    that are nearest to each joint, and a correction learnt from what the trunk sees and from the
    outline.
    """

    def __init__(self, photographed: MoveNet) -> None:
        """Our heads untrained: the maps are those of the photographs' points."""
        super().__init__()
        self.photographed = photographed.requires_grad_(False)
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
        self._begin()

    def forward(self, x: Any) -> tuple[Any, Any]:
        """Planes (n, PLANES, SIDE, SIDE) in; maps (n, 15, CELLS, CELLS), and what is told beside
        them (n, BINS + 1 + 15), out: all of it logits."""
        with torch.no_grad():
            fine, deep, heat = self.photographed(x[:, [2, 1, 0]] * STEP + GREY)
        outline = functional.avg_pool2d(x[:, COLOURS:], SIDE_OF_CELL) * (STEP / GREY)
        is_known = (outline.abs() > 0.02).float().amax((2, 3), keepdim=True)
        correction = self.correction(torch.cat([fine, outline, is_known.expand_as(outline)], 1))
        summed = self.summed(deep)
        means = [summed.mean((2, 3)), summed.amax((2, 3)), *_places(heat)]
        return self.nearest(heat) + correction, self.told(torch.cat(means, 1))

    def train(self, mode: bool = True) -> "MovenetLandmarks":
        """Learn, or do not; what photographs taught stays."""
        super().train(mode)
        self.photographed.eval()
        return self

    def paces(self) -> list[Paced]:
        """What learns: our heads alone."""
        parts = (self.correction, self.nearest, self.summed, self.told)
        return [Paced([weights for part in parts for weights in part.parameters()], 1.0)]

    def _begin(self) -> None:
        for values in (self.correction[-1].weight, self.correction[-1].bias, self.nearest.bias):
            nn.init.zeros_(values)
        nn.init.zeros_(self.nearest.weight)
        for joint, name in enumerate(JOINT_NAMES):
            points, strength = SEEN_AS.get(name, (name,)), FAINT if name in SEEN_AS else 1.0
            for point in points:
                self.nearest.weight.data[joint, POINT[point]] = strength / len(points)


def _places(heat: Any) -> tuple[Any, Any, Any]:
    """Where the middle of each point's map is, across and down, and its peak, each (n, POINTS)."""
    cells = heat.flatten(2)
    share = torch.softmax(cells, -1)
    middles = (torch.arange(CELLS, device=heat.device) + 0.5) / CELLS * 4.0 - 2.0
    across, down = middles.repeat(CELLS), middles.repeat_interleave(CELLS)
    return (share * across).sum(-1), (share * down).sum(-1), cells.amax(-1) * PEAK_SCALE
