"""People in a whole picture: a network that shows all of them at once, coarsely."""

from pathlib import Path
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import TILTED_DEG, Floats, lean_deg
from common.body.observation import Landmarks
from common.video.pictures import Image
from viewer.landmarks.fifteen_joints import fifteen
from viewer.landmarks.keypoint_layouts import POINT
from viewer.landmarks.landmark_looks import opened
from viewer.landmarks.landmark_window import Window, window_about
from viewer.landmarks.own_landmarks import MARGIN

NETWORK: Final = Path(__file__).with_name("people.onnx")
LONG_PX, MULTIPLE = 256, 32
"""Longer side of what the network sees, and the unit of both its sides, pixels."""
LEAST: Final = 0.3
"""Score from which a peak is a person: 0.2 false ones a picture of synthetic people, which the
network of landmarks then refuses (docs/measurements.md)."""
OVERLAP: Final = 0.5
"""Intersection over union of two boxes from which they are of one person."""
EDGE_PX: Final = 4
"""Distance from an end of the searched part, in pixels of what the network sees, from which on a
box may go on beyond it."""
MOST: Final = 6
"""Upper bound of the number of people in a picture."""
_SHOULDERS: Final = [POINT["l_shoulder"], POINT["r_shoulder"]]
_HIPS: Final = [POINT["l_hip"], POINT["r_hip"]]
_AROUND: Final = np.ones((3, 3), np.uint8)


class Detection(NamedTuple):
    """A person in a picture."""

    score: float
    """In [0, 1]."""
    corners_px: Floats
    """(2, 2) top left and bottom right of the body's box."""
    joints_px: Floats
    """(17, 2) BODY_POINTS order, coarse."""

    @property
    def landmarks(self) -> Landmarks:
        """The joints, all as sure as the person."""
        joints_px = tuple((x, y) for x, y in fifteen(self.joints_px).tolist())
        return Landmarks(joints_px, (self.score,) * len(joints_px))

    @property
    def window(self) -> Window:
        """Where the network of landmarks looks at this person, turned with a leaning trunk."""
        hips, shoulders = (self.joints_px[part].mean(axis=0) for part in (_HIPS, _SHOULDERS))
        turn_deg = lean_deg(*(shoulders - hips).tolist())
        if abs(turn_deg) <= TILTED_DEG:
            return window_about(self.corners_px)
        return window_about(self.joints_px, turn_deg, MARGIN)


def people_in(picture: Image, part_px: Floats | None = None) -> list[Detection]:
    """The people in a picture, surest first; the coarsest are an eighth of its height.

    Args:
        picture: (H, W, 3)
        part_px: (2, 2) top left and bottom right of the part that is searched, who reaches out of
            it is left out; None: all of it. The time that it takes goes with the area.
    """
    scale = max(picture.shape[:2]) / LONG_PX
    if part_px is None:
        return _people(picture, scale)
    start, end = _whole_units(part_px, scale * MULTIPLE, picture.shape)
    beyond, edge_px = np.array(picture.shape[1::-1]), EDGE_PX * scale
    found = _people(picture[start[1] : end[1], start[0] : end[0]], scale)
    return [
        each._replace(corners_px=each.corners_px + start, joints_px=each.joints_px + start)
        for each in found
        if not ((start > 0) & (each.corners_px[0] < edge_px)).any()
        and not ((end < beyond) & (each.corners_px[1] > end - start - edge_px)).any()
    ]


def _people(picture: Image, scale: float) -> list[Detection]:
    """The people in a picture or a part of it, by their places in that."""
    shown = _shown(picture, scale)
    centre, size, offset, joints = (
        each[0] for each in opened(NETWORK).run(None, {"picture": shown})
    )
    heat = centre[0]
    logit = float(np.log(LEAST / (1.0 - LEAST)))
    rows, columns = np.nonzero((heat >= cv2.dilate(heat, _AROUND)) & (heat >= logit))
    order = np.argsort(-heat[rows, columns], kind="stable")
    cell_px = shown.shape[2] / heat.shape[1] * scale
    kept: list[Detection] = []
    for row, column in zip(rows[order].tolist(), columns[order].tolist(), strict=True):
        at = row, column
        middle = np.array((column, row)) + offset[::-1, *at]
        half = np.maximum(size[::-1, *at], 0.0) / 2
        points = joints[:, *at].reshape(-1, 2)[:, ::-1] + (column, row)
        corners = np.stack((middle - half, middle + half)) * cell_px
        score = 1.0 / (1.0 + np.exp(-float(heat[at])))
        if len(kept) < MOST and all(overlap(corners, known.corners_px) < OVERLAP for known in kept):
            kept.append(Detection(score, corners, points * cell_px))
    return kept


def overlap(first: Floats, second: Floats) -> float:
    """Intersection over union of two boxes by their corners, (2, 2) each; 0 of empty ones."""
    shared = np.minimum(first[1], second[1]) - np.maximum(first[0], second[0])
    common = float(np.prod(np.maximum(shared, 0.0)))
    union = float(np.prod(first[1] - first[0]) + np.prod(second[1] - second[0])) - common
    return common / union if union > 0.0 else 0.0


def _whole_units(
    part_px: Floats, unit: float, shape: tuple[int, ...]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The ends, (2,) each, of whole units of what the network sees about a part of a picture (H, W,
    3), as far as that reaches."""
    sides = np.array(shape[1::-1])
    low, high = part_px
    lengths = np.minimum(np.ceil((high - low) / unit) * unit, sides)
    start = np.clip((low + high - lengths) / 2, 0, sides - lengths)
    return np.round(start).astype(np.intp), np.round(start + lengths).astype(np.intp)


def _shown(picture: Image, scale: float) -> NDArray[np.uint8]:
    """What the network sees, (1, h, w, 3), black beyond the picture.

    Args:
        picture: (H, W, 3)
        scale: Its pixels in one of what the network sees.
    """
    high, wide = picture.shape[:2]
    size = round(wide / scale), round(high / scale)
    shrunk = cv2.resize(
        picture, size, interpolation=cv2.INTER_AREA if scale > 1.0 else cv2.INTER_LINEAR
    )
    sides = (-(-side // MULTIPLE) * MULTIPLE for side in size[::-1])
    shown = np.zeros((1, *sides, 3), np.uint8)
    shown[0, : size[1], : size[0]] = shrunk
    return shown
