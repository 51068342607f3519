"""The stick body fitted to a silhouette: joints, foreshortening and what is hidden (T10-T18)."""

from typing import Final, Literal, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.bits import pack_words
from common.body import LIMBS, Vector
from common.similarity import Mask
from common.stickman import (
    ADULT,
    THESIS,
    ANGLE,
    BREADTH,
    CHAINS,
    POSE_SIZE,
    RATIO,
    STATURE,
    X,
    Y,
    Stickman,
    joints_px,
    standing,
)
from viewer.printed import fit_printed
from viewer.stick_search import beamed, refined
from viewer.strokes import ALL_SEGMENTS, UPRIGHT_SEGMENTS, match_stick

Mode = Literal["default", "thesis"]

STATURE_PX: Final = 100
"""Stature of a body in the normalised silhouette: cost does not depend on the camera (T9)."""
NORMAL_SIZE: Final = (128, 160)
"""Width and height of the normalised silhouette: arms stretched aside or up fit in."""


COSTS = np.array([0.006, 0.2, 0.02, 0.02, 0.05, 10.0, 0.01, 0.012, 1.0])


class Stick(NamedTuple):
    """A fitted stick body."""

    pose: Vector
    """(POSE_SIZE,), see common.stickman; pixels of the silhouette that was given."""
    joints_px: NDArray[np.float64]
    """(15, 2), JOINT_NAMES; r is on the left of the picture."""
    hidden: NDArray[np.bool_]
    """(10,) of LIMBS: what is mostly before or behind the rest of the body."""
    score: float
    evaluations: int

    @property
    def ratios(self) -> Vector:
        """Foreshortening of LIMBS, (10,), in [0, 1]."""
        return self.pose[RATIO:]


class Normal(NamedTuple):
    """A silhouette at its fixed size, and where it lies in the given one (T9)."""

    mask: Mask
    scale: float
    """Pixels here for one pixel there."""
    corner: Vector
    """What of the given picture is at the corner of this one, (2,) px."""


def normalised(mask: Mask, stature_px: float) -> Normal:
    """The silhouette scaled so that a stature is STATURE_PX, its box in the middle (T9)."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    width, height = NORMAL_SIZE
    scale = STATURE_PX / stature_px
    if not len(rows):
        return Normal(np.zeros((height, width), np.bool_), scale, np.zeros(2))
    middle = np.array([columns[0] + columns[-1] + 1, rows[0] + rows[-1] + 1]) / 2
    corner = middle - np.array([width, height]) / 2 / scale
    span = np.ceil(np.array([width, height]) / scale).astype(int) + 2
    first = np.floor(corner).astype(int)
    piece = np.zeros((span[1], span[0]), np.float32)
    x0, y0 = np.maximum(first, 0)
    x1, y1 = min(first[0] + span[0], mask.shape[1]), min(first[1] + span[1], mask.shape[0])
    piece[y0 - first[1] : y1 - first[1], x0 - first[0] : x1 - first[0]] = mask[y0:y1, x0:x1]
    if scale < 1:  # the mean of what falls into a pixel, not what is at its centre
        size = (max(1, round(span[0] * scale)), max(1, round(span[1] * scale)))
        piece = cv2.resize(piece, size, interpolation=cv2.INTER_AREA).astype(np.float32)
    per_x, per_y = piece.shape[1] / span[0], piece.shape[0] / span[1]
    dx, dy = corner - first
    turn = np.array(
        [
            [per_x / scale, 0.0, dx * per_x + 0.5 * per_x / scale - 0.5],
            [0.0, per_y / scale, dy * per_y + 0.5 * per_y / scale - 0.5],
        ]
    )
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    small = cv2.warpAffine(piece, turn, NORMAL_SIZE, flags=flags)
    return Normal(small > 0.5, scale, corner)


def _moved(pose: Vector, scale: float, corner: Vector) -> Vector:
    """A pose of the given picture in the normalised one."""
    pose = pose.copy()
    pose[[X, Y]] = (pose[[X, Y]] - corner) * scale
    pose[STATURE] *= scale
    return pose


def _moved_back(pose: Vector, scale: float, corner: Vector) -> Vector:
    pose = pose.copy()
    pose[[X, Y]] = pose[[X, Y]] / scale + corner
    pose[STATURE] /= scale
    return pose


def _moves() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What the refinement turns, in order, and its units."""
    rows: list[dict[int, float]] = []
    units: list[float] = []

    def move(unit: float, **_: float) -> None: ...
    def put(unit: float, *at: int) -> None:
        rows.append({i: 1.0 for i in at})
        units.append(unit)

    put(0.25, X)
    put(0.25, Y)
    rows.append({Y: 1.0, RATIO: 0.031, RATIO + 2: -0.04, RATIO + 3: -0.04})
    units.append(0.25)
    put(1.0, ANGLE)
    put(0.02, RATIO)
    put(0.02, BREADTH)
    put(0.2, STATURE)
    put(1.0, ANGLE + 1)
    for upper, lower in (*CHAINS[2:], *CHAINS[:2]):
        put(1.0, ANGLE + upper, ANGLE + lower)
        put(1.0, ANGLE + upper)
        put(1.0, ANGLE + lower)
        put(0.03, RATIO + upper)
        put(0.03, RATIO + lower)
    moves = np.zeros((len(rows), POSE_SIZE))
    for i, row in enumerate(rows):
        for at, factor in row.items():
            moves[i, at] = factor
    return moves, np.array(units)


_MOVES, _UNITS = _moves()
_LOWS, _HIGHS = np.full(POSE_SIZE, -1e9), np.full(POSE_SIZE, 1e9)
_LOWS[RATIO:], _HIGHS[RATIO:] = 0.05, 1.0
_LOWS[RATIO] = 0.6
_LOWS[BREADTH], _HIGHS[BREADTH] = 0.0, 1.0
_LOWS[ANGLE], _HIGHS[ANGLE] = 45.0, 135.0
_LOWS[ANGLE + 1], _HIGHS[ANGLE + 1] = 45.0, 135.0
_LOWS[RATIO + 1] = 1.0


def fit(
    mask: Mask, before: Stick | None, mode: Mode = "default", stature_px: float = float(STATURE_PX)
) -> Stick:
    """The stick body of a silhouette.

    Args:
        mask: (H, W).
        before: The fit of the frame before; None at the start.
        mode: thesis or default.
        stature_px: Height of the body standing upright, in pixels of the mask (T20).
    """
    normal = normalised(mask, stature_px)
    seen = pack_words(normal.mask)
    if mode == "thesis":
        found = fit_printed(normal.mask, float(STATURE_PX))
        value = match_stick(
            THESIS.lengths,
            THESIS.parts,
            THESIS.depth,
            found.pose,
            ALL_SEGMENTS,
            NORMAL_SIZE[0],
            seen,
        )
        pose = _moved_back(found.pose, normal.scale, normal.corner)
        return Stick(pose, joints_px(THESIS, pose), found.hidden, float(value), found.evaluations)
    if before is None:
        rows, columns = (
            np.flatnonzero(normal.mask.any(axis=1)),
            np.flatnonzero(normal.mask.any(axis=0)),
        )
        expected = standing(
            float(np.median(np.nonzero(normal.mask)[1])), rows[0] + 0.465 * STATURE_PX, STATURE_PX
        )
        trust = 0.3
    else:
        expected, trust = _moved(before.pose, normal.scale, normal.corner), 1.0
        expected[STATURE] = STATURE_PX
    pose, matches = _fitted(seen, expected, trust)
    value = match_stick(
        ADULT.lengths, ADULT.parts, ADULT.depth, pose, ALL_SEGMENTS, NORMAL_SIZE[0], seen
    )
    pose = _moved_back(pose, normal.scale, normal.corner)
    return Stick(
        pose, joints_px(ADULT, pose), np.zeros(len(LIMBS), np.bool_), float(value), matches
    )


def _fitted(seen, expected: Vector, trust: float) -> tuple[Vector, int]:
    man, width = ADULT, NORMAL_SIZE[0]
    pose = expected.copy()
    body = (man.lengths, man.parts, man.depth)
    upright = UPRIGHT_SEGMENTS | 0b111100
    matches = 0
    for half, stop in ((16, 4), (4, 2)):
        _, n = refined(
            *body,
            pose,
            expected,
            trust,
            COSTS,
            seen,
            width,
            _MOVES[:8],
            _UNITS[:8],
            half,
            stop,
            _LOWS,
            _HIGHS,
            upright,
        )
        matches += n
    for upper, _ in CHAINS[2:]:
        matches += beamed(
            *body, pose, expected, trust, COSTS, seen, width, upper, 180.0, 360.0, 100.0, upright
        )
    for upper, _ in CHAINS[:2]:
        matches += beamed(
            *body, pose, expected, trust, COSTS, seen, width, upper, 0.0, 345.0, 140.0, ALL_SEGMENTS
        )
    for half, stop in ((16, 4), (8, 2), (4, 2)):
        _, n = refined(
            *body,
            pose,
            expected,
            trust,
            COSTS,
            seen,
            width,
            _MOVES,
            _UNITS,
            half,
            stop,
            _LOWS,
            _HIGHS,
            ALL_SEGMENTS,
        )
        matches += n
    return pose, matches
