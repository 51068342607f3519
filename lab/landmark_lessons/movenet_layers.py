"""MoveNet's layers: a trunk and a head of heat maps that photographs of people taught.

Source: Votel & Li 2021, "Next-Generation Pose Detection with MoveNet and TensorFlow.js"; the trunk
is that of Sandler et al. 2018, the way up that of Lin et al. 2017, the head that of Zhou et al.
2019. Normalisations are folded into weights, as published.
"""

from typing import Any, Final, NamedTuple

from torch import nn
from torch.nn import functional

POINTS: Final = 17
"""Heat maps: COCO's points, in the order of `keypoint_layouts.BODY_POINTS`."""
STRIDES: Final = (1, 2, 1, 2, 1, 1, 2, 1, 1, 1, 1, 1, 1, 2, 1, 1, 1)
"""Of the trunk's blocks."""
BLOCK_WIDTHS: Final = (16, 24, 24, 32, 32, 32, 64, 64, 64, 64, 96, 96, 96, 160, 160, 160, 320)
"""Channels that the blocks of a trunk of width 1 give."""
ASIDES: Final = (9, 5, 2)
"""Blocks whose channels join the way up, coarsest first."""
EXPANDED, DEEP, HEAD_UNITS = 6, 1280, 96
"""How many times wider a block is inside; channels of the coarsest stage and of the head."""
JOINED: Final = (64, 64, 32, 24)
"""Channels on the way up: at the coarsest, and of what joins after each doubling."""
RISEN: Final = (32, 24, 24)
"""Channels after each joining."""
LEVELS: Final = 255.0
"""Of a byte; the network takes -1 to 1, red first."""


class Seen(NamedTuple):
    """What the network makes of windows of S by S pixels."""

    fine: Any
    """(n, 24, S/4, S/4) features at the finest of the way up."""
    deep: Any
    """(n, DEEP, S/32, S/32) features at the coarsest."""
    heat: Any
    """(n, POINTS, S/4, S/4) logits of how probably a point is in a cell."""
    early: Any
    """(n, 24, S/4, S/4) features of the finest block that joins the way up, of colours alone."""


class Step(nn.Module):
    """A convolution that pads as TensorFlow does, bent or not."""

    def __init__(
        self, inputs: int, outputs: int, size: int, stride: int = 1, bent: str = ""
    ) -> None:
        """Untrained; of 3 cells across each channel stands by itself, but in the first of all.

        Args:
            inputs: Channels.
            outputs: Channels.
            size: Cells across.
            stride: 1, or 2 for half as many cells: an even side is padded at its end alone.
            bent: "" straight, "6" cut to 0 and 6, "0" cut at 0.
        """
        super().__init__()
        groups = inputs if size > 1 and inputs == outputs else 1
        self.pads = (0, 1, 0, 1) if stride == 2 else (size // 2,) * 4
        self.convolution = nn.Conv2d(inputs, outputs, size, stride, groups=groups)
        self.bent = bent

    def forward(self, x: Any) -> Any:
        """Planes in, planes out."""
        found = self.convolution(functional.pad(x, self.pads))
        if self.bent == "6":
            return functional.relu6(found)
        return functional.relu(found) if self.bent else found


class Block(nn.Module):
    """Few channels to many, each of these by itself, and to few again."""

    def __init__(self, inputs: int, outputs: int, stride: int, expanded: int) -> None:
        """Untrained; one that is not expanded has no first step."""
        super().__init__()
        wide = inputs * expanded
        self.expand = Step(inputs, wide, 1, bent="6") if expanded > 1 else nn.Identity()
        self.depthwise = Step(wide, wide, 3, stride, "6")
        self.project = Step(wide, outputs, 1)
        self.adds = stride == 1 and inputs == outputs

    def forward(self, x: Any) -> Any:
        """Planes in, planes out."""
        found = self.project(self.depthwise(self.expand(x)))
        return x + found if self.adds else found


class MoveNet(nn.Module):
    """Five halvings, and back up to a quarter of the size; windows of any multiple of 32 pixels."""

    def __init__(self, width: float = 1.0) -> None:
        """Untrained; Lightning's trunk has width 1, Thunder's 1.75."""
        super().__init__()
        first, *widths = (_whole(width * each) for each in (32, *BLOCK_WIDTHS))
        self.stem = Step(3, first, 3, 2, "6")
        self.blocks = nn.ModuleList(
            Block(inputs, outputs, stride, EXPANDED if at else 1)
            for at, (inputs, outputs, stride) in enumerate(
                zip((first, *widths), widths, STRIDES, strict=False)
            )
        )
        self.last = Step(widths[-1], DEEP, 1, bent="6")
        sides = (DEEP, *(widths[at] for at in ASIDES))
        self.asides = nn.ModuleList(
            Step(inputs, outputs, 1) for inputs, outputs in zip(sides, JOINED, strict=True)
        )
        self.up = nn.ModuleList(
            nn.Sequential(Step(wide, wide, 3), Step(wide, narrow, 1, bent="0"))
            for wide, narrow in zip(JOINED[1:], RISEN, strict=True)
        )
        fine = RISEN[-1]
        self.heat = nn.Sequential(
            Step(fine, fine, 3), Step(fine, HEAD_UNITS, 1, bent="0"), Step(HEAD_UNITS, POINTS, 1)
        )

    def forward(self, windows: Any) -> Seen:
        """Windows (n, 3, S, S) of red, green and blue levels, 0 to 255, in."""
        x, kept = self.stem(windows * (2.0 / LEVELS) - 1.0), []
        for block in self.blocks:
            x = block(x)
            kept.append(x)
        deep = self.last(x)
        coarse, *finer = self.asides
        fine = coarse(deep)
        for aside, at, up in zip(finer, ASIDES, self.up, strict=True):
            larger = functional.interpolate(fine, scale_factor=2, mode="bilinear")
            fine = up(larger + aside(kept[at]))
        return Seen(fine, deep, self.heat(fine), kept[ASIDES[-1]])


def _whole(channels: float) -> int:
    """So many channels in eights, as the trunks were made."""
    return int(channels + 4) // 8 * 8
