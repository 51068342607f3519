"""A camera that trembles, held still: each frame in the place and the light of one (T2)."""

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.compiled import compiled
from viewer.background.image_stack import LUMA, Floats, Frame

EDGE_POINTS: Final = 4000
"""So many pixels, where the background is steepest, tell where a frame lies."""
COARSE_PX, FINE_PX = 2.0, 1.0
"""How far pictures are blurred before they are laid over each other, in two rounds."""
WIDE_PX: Final = 6.0
"""What changes over more than this is light, not edges."""
ROUNDS: Final = 4
UNLIKE: Final = 15.0
"""Grey levels of difference beyond which an edge is not the background's."""
CLEAR: Final = 6.0
"""The same of a pixel's light."""
STIFF: Final = 500.0
"""How much a pixel's shift weighs against the edges: where there are none, none is found."""
FARTHEST: Final = 0.05
"""No frame is moved further than this share of the picture's height."""
TREMBLES_PX: Final = 0.3
"""What a tenth of the frames pass where a camera is not fixed: 0.02 where it is, 1 to 2.5 where it
is held."""
ASKED: Final = 4
"""Every so many frames tell whether a camera trembles."""
LIGHT_STEP: Final = 7
"""Every so many pixels tell the light."""


class Due(NamedTuple):
    """What a frame that lies where the background does shows at the steep pixels, at one blur."""

    edges: Floats
    """(n,) grey levels beside the slow light."""
    slopes: Floats
    """(n, 2): how they change to the right and downwards, a pixel."""


class Anchor(NamedTuple):
    """The background that frames are laid over."""

    luma: Floats
    """(H, W) brightness of the background."""
    steep: NDArray[np.intp]
    """(n, 2) rows and columns of EDGE_POINTS pixels."""
    due: tuple[Due, ...]
    """For COARSE_PX and FINE_PX."""


class Alignment(NamedTuple):
    """Where a frame lies, and its light."""

    right_px: float
    down_px: float
    """By how much the frame is to be moved."""
    gain: float
    offset: float
    """Its brightness is gain times the background's and offset, grey levels."""


def anchored(sample: Sequence[Frame]) -> Anchor | None:
    """What frames are to be laid over; None where the camera stands still.

    Args:
        sample: Frames (H, W, 3) from all over a clip.
    """
    lumas = [np.asarray(frame @ LUMA, np.float32) for frame in sample]
    anchor = _anchor(np.median(lumas, axis=0).astype(np.float32))
    some = [alignment_of(anchor, luma)[:2] for luma in lumas[::ASKED]]
    if np.quantile(np.abs(some).max(axis=1), 0.9) < TREMBLES_PX:
        return None
    shifts = [alignment_of(anchor, luma)[:2] for luma in lumas]
    moved = [_moved(luma, *shift) for luma, shift in zip(lumas, shifts, strict=True)]
    return _anchor(np.median(moved, axis=0).astype(np.float32))


def alignment_of(anchor: Anchor, luma: Floats) -> Alignment:
    """Where a frame lies: least squares over the edges, what does not fit set aside."""
    shift = np.zeros(2)
    limit = FARTHEST * len(luma)
    for edges, due in zip(_edges(luma), anchor.due, strict=True):
        for _ in range(ROUNDS):
            step = _nearer(edges, anchor.steep, due.edges, due.slopes, shift)
            shift = np.clip(shift + step, -limit, limit)
    gain, offset = _light(anchor.luma, _moved(luma, *shift))
    return Alignment(float(shift[0]), float(shift[1]), gain, offset)


def aligned(frame: Frame, alignment: Alignment) -> Frame:
    """The frame where the background is, under its light."""
    moved = _moved(frame.astype(np.float32), alignment.right_px, alignment.down_px)
    return np.asarray(
        np.clip(np.rint((moved - alignment.offset) / alignment.gain), 0, 255), np.uint8
    )


def unaligned(mask: NDArray[np.bool_], alignment: Alignment) -> NDArray[np.bool_]:
    """A silhouette of a laid frame where the frame itself has it."""
    turn = np.array([[1.0, 0.0, -alignment.right_px], [0.0, 1.0, -alignment.down_px]])
    size = (mask.shape[1], mask.shape[0])
    return cv2.warpAffine(mask.view(np.uint8), turn, size, flags=cv2.INTER_NEAREST) > 0


def _anchor(luma: Floats) -> Anchor:
    pictures = _edges(luma)
    steepness = np.hypot(*np.gradient(pictures[-1])).ravel()
    steep = np.stack(np.unravel_index(np.argsort(steepness)[-EDGE_POINTS:], luma.shape), axis=1)
    at = tuple(steep.T)
    due = tuple(
        Due(edges[at], np.stack([slope[at] for slope in np.gradient(edges)[::-1]], axis=1))
        for edges in pictures
    )
    return Anchor(luma, steep, due)


def _edges(luma: Floats) -> list[Floats]:
    """The picture without its slow light, blurred by COARSE_PX and by FINE_PX."""
    wide, *blurred = (cv2.GaussianBlur(luma, (0, 0), px) for px in (WIDE_PX, COARSE_PX, FINE_PX))
    return [np.asarray(picture - wide, np.float32) for picture in blurred]


@compiled
def _nearer(edges: Any, steep: Any, due: Any, slopes: Any, shift: Any) -> Any:
    """How much further a picture is to be moved, (2,): a step of reweighted least squares."""
    height, width = edges.shape
    matrix, target = STIFF * np.eye(2), np.zeros(2)
    for n in range(len(steep)):
        x = min(max(steep[n, 1] - shift[0], 0.0), width - 1.0)
        y = min(max(steep[n, 0] - shift[1], 0.0), height - 1.0)
        left, top = min(int(x), width - 2), min(int(y), height - 2)
        right, down = x - left, y - top
        above = (1.0 - right) * edges[top, left] + right * edges[top, left + 1]
        below = (1.0 - right) * edges[top + 1, left] + right * edges[top + 1, left + 1]
        off = (1.0 - down) * above + down * below - due[n]
        weight = 1.0 / (1.0 + (off / UNLIKE) ** 2) ** 2
        for i in range(2):
            target[i] += weight * slopes[n, i] * off
            for j in range(2):
                matrix[i, j] += weight * slopes[n, i] * slopes[n, j]
    return np.linalg.solve(matrix, target)


def _moved(picture: Floats, right_px: float, down_px: float) -> Floats:
    turn = np.array([[1.0, 0.0, right_px], [0.0, 1.0, down_px]])
    size = (picture.shape[1], picture.shape[0])
    border = cv2.BORDER_REPLICATE
    return np.asarray(cv2.warpAffine(picture, turn, size, borderMode=border), np.float32)


def _light(background: Floats, luma: Floats) -> tuple[float, float]:
    """Gain and offset of a frame's brightness, what is not background set aside."""
    x, y = background.ravel()[::LIGHT_STEP].astype(np.float64), luma.ravel()[::LIGHT_STEP]
    weight, gain, offset = np.ones(len(x)), 1.0, 0.0
    for _ in range(2 * ROUNDS):
        total, mean_x, mean_y = weight.sum(), weight @ x, weight @ y
        spread = total * (weight @ (x * x)) - mean_x**2
        gain = (total * (weight @ (x * y)) - mean_x * mean_y) / max(spread, 1e-9)
        offset = (mean_y - gain * mean_x) / total
        weight = 1.0 / (1.0 + ((y - gain * x - offset) / CLEAR) ** 2) ** 2
    return (float(gain), float(offset)) if 0.5 < gain < 2.0 else (1.0, 0.0)
