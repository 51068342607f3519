"""The contour method: curves of arms and lower legs, elbows, crossed legs (algorithms 2 to 5)."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats
from common.compiled import compiled
from common.method import Method
from common.raster.similarity import Mask

CORNER_DISTANCE: Final = 4
"""Fewest points on either side of an elbow: minimumCornerDistance."""
CORNER_DEG: Final = 10.0
"""Smallest bend at an elbow, degrees: minimumCornerAngleDifference."""
STEADY_SHARE: Final = 0.25
"""Fewest points on either side of a steady elbow, as a share of the curve (T16)."""
STEADY_DEG: Final = 15.0
"""Smallest bend of a steady elbow: noise of half a pixel reaches 10 degrees (T16)."""

Curve = NDArray[np.float64]
"""(n, 2): x and y, px, from the trunk outwards."""


class ArmAngles(NamedTuple):
    """Angles of an arm in the picture, degrees, 0 to the right, 90 up."""

    upper: float
    lower: float
    corner: int
    """Index of the elbow in the curve; -1: none is visible, the arm is straight."""


@compiled
def outer_runs(mask: Mask) -> NDArray[np.int64]:
    """Intersections of scan lines with a silhouette (H, W): the number of runs, and the outermost
    ones.

    Returns:
        (H, 5): number of runs, then first pixel and one past the last of the first and of the last.
    """
    height, width = mask.shape
    found = np.zeros((height, 5), np.int64)
    for y in range(height):
        for x in range(width):
            if mask[y, x] and not (x and mask[y, x - 1]):
                found[y, 0] += 1
                found[y, 3] = x
            if mask[y, x] and not (x + 1 < width and mask[y, x + 1]):
                found[y, 4] = x + 1
                if found[y, 0] == 1:
                    found[y, 1:3] = found[y, 3:5]
    return found


@compiled
def _line(curve: Floats) -> tuple[float, float]:
    """The line of least squared distances through a curve: (angle, sum of these squares)."""
    size = len(curve)
    mean_x, mean_y = curve[:, 0].sum() / size, curve[:, 1].sum() / size
    across = both = down = 0.0
    for x, y in curve:
        across += (x - mean_x) ** 2
        both += (x - mean_x) * (y - mean_y)
        down += (y - mean_y) ** 2
    turn = 0.5 * math.atan2(2.0 * both, across - down)
    dx, dy = math.cos(turn), math.sin(turn)
    if (curve[-1, 0] - curve[0, 0]) * dx + (curve[-1, 1] - curve[0, 1]) * dy < 0.0:
        dx, dy = -dx, -dy
    off = across * dy * dy - 2.0 * both * dx * dy + down * dx * dx
    return math.degrees(math.atan2(-dy, dx)) % 360.0, off


def line_angle_deg(curve: Curve) -> float:
    """FindAngle: direction of a curve, in [0, 360), by least squared distances (T14)."""
    return float(_line(curve)[0])


def arm_curve(mask: Mask, trunk: tuple[int, int, int], reach_px: int, side: int) -> Curve:
    """Middles of the outermost run of every scan line within an arm's reach (T14).

    A run that joins the trunk counts as far as it lies outside it.

    Args:
        mask: (H, W).
        trunk: Left and right edge of the trunk (one past it), and the row of the shoulder.
        reach_px: Length of an arm.
        side: 0 on the left of the picture, 1 on the right.
    """
    left, right, shoulder = trunk
    rows = np.arange(max(0, shoulder - reach_px), min(len(mask), shoulder + reach_px + 1))
    found = outer_runs(mask[rows])
    begin, end = (found[:, 1], found[:, 2]) if side == 0 else (found[:, 3], found[:, 4])
    begin, end = (begin, np.minimum(end, left)) if side == 0 else (np.maximum(begin, right), end)
    seen = (found[:, 0] > 0) & (end > begin)
    curve = np.stack([(begin[seen] + end[seen]) / 2, rows[seen] + 0.5], axis=1)
    upwards = np.count_nonzero(curve[:, 1] < shoulder) > len(curve) / 2
    return curve[::-1] if upwards else curve


def lower_leg_curves(mask: Mask, top: int, bottom: int) -> tuple[Curve, Curve, list[bool]]:
    """Middles of both lower legs in every scan line, and where these coincide (T14, T17).

    A single run is both legs, a half each.

    Returns:
        (left curve, right curve, for each line with a run: whether the legs share it).
    """
    rows = np.arange(max(0, top), min(len(mask), bottom))
    found = outer_runs(mask[rows])
    rows, found = rows[found[:, 0] > 0], found[found[:, 0] > 0]
    merged, ends = found[:, 0] == 1, found[:, 1:].astype(np.float64)
    ends[merged, 1:3] = ends[merged][:, :2].mean(axis=1)[:, None]
    left, right = (
        np.stack([ends[:, at : at + 2].mean(axis=1), rows + 0.5], axis=1) for at in (0, 2)
    )
    return left, right, merged.tolist()


@compiled
def turn_deg(one_deg: float, other_deg: float) -> float:
    """The angle between two directions, in [0, 180]."""
    return abs((one_deg - other_deg + 180.0) % 360.0 - 180.0)


@compiled
def elbow_corner(curve: Floats) -> int:
    """Algorithm 4: the point that splits a curve into the two lines of most different directions;
    -1: they nowhere differ by more than CORNER_DEG.

    The printed loop guards one end of the curve. M21 guards both, and takes angles on the circle.
    """
    best, most = -1, CORNER_DEG
    for i in range(CORNER_DISTANCE, len(curve) - CORNER_DISTANCE):
        bend = turn_deg(_line(curve[: i + 1])[0], _line(curve[i:])[0])
        if bend > most:
            best, most = i, bend
    return best


@compiled
def steady_corner(curve: Floats) -> int:
    """The point at which two lines of different directions fit a curve best; -1: none.

    A departure from algorithm 4, whose largest difference depends on noise at an end (T16).
    """
    guard = max(CORNER_DISTANCE, math.ceil(STEADY_SHARE * len(curve)))
    best, least = -1, math.inf
    for i in range(guard, len(curve) - guard):
        (upper, one), (lower, other) = _line(curve[: i + 1]), _line(curve[i:])
        if turn_deg(upper, lower) >= STEADY_DEG and one + other < least:
            best, least = i, one + other
    return best


def arm_angles(curve: Curve, method: Method) -> ArmAngles:
    """Algorithm 3: one angle for both halves of a straight arm, else one for each (T15).

    Args:
        curve: The arm's curve.
        method: How its elbow is found.
    """
    corner = int(steady_corner(curve) if method.steady_elbows else elbow_corner(curve))
    if corner < 0:
        angle = line_angle_deg(curve)
        return ArmAngles(angle, angle, -1)
    return ArmAngles(line_angle_deg(curve[: corner + 1]), line_angle_deg(curve[corner:]), corner)


def knees_crossed(merged: list[bool]) -> bool:
    """Algorithm 5: crossed where the lines begin as one run and continue as two, to the end (T17).

    It also fires for legs apart that touch at the knee, and misses the sequence two, one, two.
    """
    until = merged.index(False) if False in merged else len(merged)
    return 0 < until < len(merged) and not any(merged[until:])
