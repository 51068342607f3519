"""Composites as the network of landmarks takes them, and the masks that are due."""

from collections.abc import Iterator

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn.functional import interpolate

from synth.picture.composites import UNKNOWN, Composite
from viewer.landmarks.landmark_looks import CELLS
from viewer.landmarks.landmark_window import SIDE, Planes


def planes_of(shown: list[Composite]) -> torch.Tensor:
    """What the network sees of composites, levels (n, PLANES, SIDE, SIDE): larger than they were
    drawn, as it sees most people who are recorded."""
    colours = _levels(np.stack([one.picture for one in shown]))
    outlines = _levels(np.stack([one.outline[..., None] for one in shown]))
    planes = torch.cat(
        [
            interpolate(colours, (SIDE, SIDE), mode="bilinear"),
            interpolate(outlines, (SIDE, SIDE), mode="nearest"),
        ],
        1,
    )
    return planes.contiguous(memory_format=torch.channels_last)


def windows_of(shown: list[Composite]) -> Iterator[Planes]:
    """The same in bytes, one by one, as the viewer cuts them out."""
    for one in shown:
        yield planes_of([one]).round().to(torch.uint8).contiguous().numpy()


def masks_of(shown: list[Composite]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The share of each cell that the person covers, (n, CELLS, CELLS), and where that is known,
    (n,), 1 or 0."""
    masks = [cv2.resize(one.mask, (CELLS, CELLS), interpolation=cv2.INTER_AREA) for one in shown]
    known = [float((one.mask != UNKNOWN).any()) for one in shown]
    return np.array(masks, np.float32) / np.float32(255), np.array(known, np.float32)


def _levels(pictures: NDArray[np.uint8]) -> torch.Tensor:
    return torch.from_numpy(pictures).permute(0, 3, 1, 2).float()
