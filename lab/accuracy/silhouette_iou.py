"""Accuracy of silhouettes: intersection over union, frame by frame."""

from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.config.settings import Settings
from common.method import METHODS
from common.npz_file import Arrays
from common.raster.similarity import Mask
from common.video.clip_facts import ClipView
from common.video.clips import open_clip
from runtime.offline.lockstep import Decoders
from viewer.capture import recorded
from viewer.room.background_source import opening_of_view
from viewer.silhouette import silhouette

HALF: Final = 0.5
"""Share of a pixel that the person must cover in a reduced true mask."""


class Overlap(NamedTuple):
    """One view of one clip."""

    iou: Vector
    """(n,) IoU of the frames with a true silhouette."""
    empty: int
    """Number of frames without one."""
    ghosts: int
    """Number of frames without one in which a silhouette was found."""


def overlaps(settings: Settings, truth: Arrays, decoders: Decoders) -> dict[str, Overlap]:
    """The silhouettes of every view with true masks, as a viewer with these settings finds them.

    Args:
        settings: The run's settings; they name the clip.
        truth: The clip's ground truth: mask_cam1, mask_cam2 packed along their rows, mask_shape; a
            view without them is left out.
        decoders: Read the videos.

    Raises:
        ClipError: When the clip cannot be used.
    """
    clip = open_clip(settings, decoders.of[1])
    return {
        view.name: _of_view(view, clip.every, settings, truth, decoders)
        for view in clip.views
        if {f"mask_{view.name}", "mask_shape"} <= set(truth)
    }


def _of_view(
    view: ClipView, every: int, settings: Settings, truth: Arrays, decoders: Decoders
) -> Overlap:
    packed, width = truth[f"mask_{view.name}"], int(truth["mask_shape"][1])
    row_of = truth.get(f"frames_{view.name}", np.arange(len(packed)))
    decoder = decoders.of[view.number]
    background = opening_of_view(view, settings.silhouette, decoder).background
    state = silhouette.init(background, settings.silhouette, METHODS[settings.mode])
    shares, empty, ghosts = [], 0, 0
    for frame in recorded(view, every, decoder):
        state, seen = silhouette.step(state, frame.picture, None)
        if frame.index >= len(row_of):
            break
        filed = np.unpackbits(packed[row_of[frame.index]], axis=1, count=width)
        true = shrunk(np.rot90(filed, -view.quarters), view.size)
        if true.any():
            shares.append(iou(true, seen.mask))
        else:
            empty, ghosts = empty + 1, ghosts + bool(seen.mask.any())
    return Overlap(np.array(shares), empty, ghosts)


def shrunk(mask: NDArray[np.uint8], size: tuple[int, int]) -> Mask:
    """A mask of zeros and ones at another size (width, height): 1 where at least HALF of a pixel is
    covered.

    At half the size that is a mean of 2x2 of at least one half.
    """
    covered = cv2.resize(mask.astype(np.float32), size, interpolation=cv2.INTER_AREA)
    return np.asarray(covered >= HALF, np.bool_)


def iou(one: Mask, other: Mask) -> float:
    """Intersection over union; 1 for two empty masks."""
    union = int(np.count_nonzero(one | other))
    return int(np.count_nonzero(one & other)) / union if union else 1.0
