"""Composites as the network of landmarks takes them."""

from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn.functional import interpolate

from synth.picture.composites import Composite
from viewer.landmarks.landmark_window import GREY, SIDE

STEP: Final = 64
"""Levels of a byte, from GREY on, that are 1 for the network."""


def planes_of(shown: list[Composite]) -> torch.Tensor:
    """What the network sees of composites, (n, PLANES, SIDE, SIDE): larger than they were drawn,
    as it sees most people who are recorded."""
    colours = _whole(np.stack([one.picture for one in shown]))
    outlines = _whole(np.stack([one.outline[..., None] for one in shown]))
    planes = torch.cat(
        [
            interpolate(colours, (SIDE, SIDE), mode="bilinear"),
            interpolate(outlines, (SIDE, SIDE), mode="nearest"),
        ],
        1,
    )
    return planes.contiguous(memory_format=torch.channels_last)


def _whole(pictures: NDArray[np.uint8]) -> torch.Tensor:
    return (torch.from_numpy(pictures).permute(0, 3, 1, 2).float() - GREY) / STEP
