"""The layers of the network of landmarks: a trunk that saw photographs, and what we read of it."""

from typing import Final, NamedTuple

from torch import Tensor, nn

from viewer.landmarks.landmark_looks import BINS
from viewer.landmarks.landmark_window import PLANES

JOINTS: Final = 15
COLOURS: Final = PLANES - 1
OUTLINED: Final = 16
"""Channels of the finest stage, to which as many of the silhouette are added."""
MIXED, DEEP, SUMMED, TOLD = 32, 576, 192, 96
"""Units: of the maps' way up, of the coarsest stage, of what is summed of it, of what is told."""

TRUNK_PACE: Final = 0.1
"""How fast what photographs have taught learns: so much of it stays."""


class Paced(NamedTuple):
    """Weights that learn alike."""

    weights: list[nn.Parameter]
    pace: float
    """How fast, as a share of the rate."""


class Layer(nn.Sequential):
    """A convolution, normalised, bent."""

    def __init__(
        self, inputs: int, outputs: int, size: int, stride: int = 1, apart: bool = False
    ) -> None:
        """Untrained; `apart`: each channel by itself."""
        groups = inputs if apart else 1
        super().__init__(
            nn.Conv2d(inputs, outputs, size, stride, size // 2, groups=groups, bias=False),
            nn.BatchNorm2d(outputs),
            nn.ReLU6(),
        )


class Narrow(nn.Sequential):
    """One to few channels, not bent."""

    def __init__(self, inputs: int, outputs: int) -> None:
        """Untrained."""
        super().__init__(nn.Conv2d(inputs, outputs, 1, bias=False), nn.BatchNorm2d(outputs))


class Inverted(nn.Module):
    """Few channels to many, each of these by itself, and to few again (Sandler et al. 2018)."""

    def __init__(self, inputs: int, wide: int, outputs: int, size: int, stride: int = 1) -> None:
        """Untrained."""
        super().__init__()
        self.adds = stride == 1 and inputs == outputs
        self.wide = Layer(inputs, wide, 1)
        self.apart = Layer(wide, wide, size, stride, apart=True)
        self.narrow = Narrow(wide, outputs)

    def forward(self, x: Tensor) -> Tensor:
        """Planes in, planes out."""
        found = self.narrow(self.apart(self.wide(x)))
        return x + found if self.adds else found


class Aside(nn.Sequential):
    """What a stage gives to the maps' way up."""

    def __init__(self, inputs: int, outputs: int) -> None:
        """Untrained."""
        super().__init__(Layer(inputs, inputs, 3, apart=True), Layer(inputs, outputs, 1))


class LandmarkNetwork(nn.Module):
    """Five halvings, and back up to a quarter of the size.

    All but `outline`, `maps` and `told` are the layers of MediaPipe Pose's lite network of
    landmarks (Bazarevsky et al. 2020): `photographed_start` fills them.
    The silhouette joins at a quarter of the size, so that colours are seen as they were then.
    """

    def __init__(self) -> None:
        """Untrained."""
        super().__init__()
        self.fine = nn.Sequential(
            Layer(COLOURS, 24, 3, 2),
            Layer(24, 24, 3, apart=True),
            Narrow(24, 8),
            Inverted(8, 32, 16, 3, 2),
            Inverted(16, 96, 16, 3),
        )
        self.outline = nn.Sequential(Layer(1, OUTLINED, 5, 4), nn.Conv2d(OUTLINED, OUTLINED, 1))
        self.eighth = nn.Sequential(Inverted(16, 96, 24, 5, 2), Inverted(24, 144, 24, 5))
        self.sixteenth = nn.Sequential(
            Inverted(24, 144, 40, 3, 2),
            Inverted(40, 240, 40, 3),
            Inverted(40, 240, 40, 3),
            Inverted(40, 240, 56, 5),
            Inverted(56, 336, 56, 5),
            Inverted(56, 336, 56, 5),
        )
        self.coarse = nn.Sequential(
            Inverted(56, 336, 96, 5, 2),
            Inverted(96, DEEP, 96, 5),
            Inverted(96, DEEP, 96, 5),
            Inverted(96, DEEP, 96, 5),
            Layer(96, DEEP, 1),
            Layer(DEEP, DEEP, 3, apart=True),
        )
        self.asides = nn.ModuleList([Aside(inputs, MIXED) for inputs in (16, 24, 56, DEEP)])
        self.summed = Aside(DEEP, SUMMED)
        self.maps = nn.Conv2d(MIXED, JOINTS, 1)
        self.told = nn.Sequential(
            nn.AdaptiveAvgPool2d(1),
            nn.Flatten(),
            nn.Linear(SUMMED, TOLD),
            nn.ReLU(),
            nn.Linear(TOLD, BINS + 1 + JOINTS),
        )
        self.up = nn.Upsample(scale_factor=2, mode="bilinear", align_corners=False)

    def forward(self, x: Tensor) -> tuple[Tensor, Tensor]:
        """Planes (n, PLANES, SIDE, SIDE) in; maps (n, 15, CELLS, CELLS), and what is told beside
        them (n, BINS + 1 + 15), out: all of it logits."""
        stages = [self.fine(x[:, :COLOURS]) + self.outline(x[:, COLOURS:])]
        for stage in (self.eighth, self.sixteenth, self.coarse):
            stages.append(stage(stages[-1]))
        *finer, risen = (aside(stage) for aside, stage in zip(self.asides, stages, strict=True))
        for aside in reversed(finer):
            risen = self.up(risen) + aside
        return self.maps(risen), self.told(self.summed(stages[-1]))

    def train(self, mode: bool = True) -> "LandmarkNetwork":
        """Learn, or do not; what sees colours at their finest stays as photographs taught it."""
        super().train(mode)
        self.fine.eval()
        return self

    def paces(self) -> list[Paced]:
        """What learns, and how fast: what is new, and what photographs taught."""
        new = (self.outline, self.maps, self.told)
        old = (self.eighth, self.sixteenth, self.coarse, self.asides, self.summed)
        return [
            Paced([weights for part in parts for weights in part.parameters()], pace)
            for parts, pace in ((new, 1.0), (old, TRUNK_PACE))
        ]

    def photographed(self) -> list[Layer | Narrow]:
        """Layers that the file of `photographed_start` holds, in its order."""
        finer = (self.fine, self.eighth, self.sixteenth, self.coarse)
        parts = [part for parts in (*finer, self.asides, self.summed) for part in parts.modules()]
        return [part for part in parts if isinstance(part, Layer | Narrow)]
