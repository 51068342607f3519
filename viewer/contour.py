"""The contour method: curves of arms and lower legs, elbows, crossed legs (algorithms 2 to 5)."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.similarity import Mask

CORNER_DISTANCE: Final = 4
"""Points on either side of an elbow at least: minimumCornerDistance."""
CORNER_SHARE: Final = 0.25
"""The same as a share of the curve: as printed noise at an end makes an elbow there (M21)."""
CORNER_DEG: Final = 15.0
"""minimumCornerAngleDifference is printed as 10, which noise of half a pixel reaches (T16)."""

Curve = NDArray[np.float64]
"""(n, 2): x and y, px, from the trunk outwards."""


class ArmAngles(NamedTuple):
    """Angles of an arm in the picture, degrees, 0 to the right, 90 up."""

    upper: float
    lower: float
    corner: int
    """Which point of the curve is the elbow; -1: none is seen, the arm is straight."""


def runs(row: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Where a scan line is inside the silhouette, (n, 2): first pixel and one past the last."""
    steps = np.flatnonzero(np.diff(row.astype(np.int8), prepend=0, append=0))
    pairs: NDArray[np.int64] = steps.reshape(-1, 2)
    return pairs


def _line(curve: Curve) -> tuple[float, float]:
    """The line of least squared distances through a curve: (angle, sum of these squares)."""
    centred = curve - curve.mean(axis=0)
    _, sizes, axes = np.linalg.svd(centred, full_matrices=False)
    dx, dy = axes[0] if (curve[-1] - curve[0]) @ axes[0] >= 0 else -axes[0]
    return math.degrees(math.atan2(-dy, dx)) % 360.0, float(sizes[1] ** 2)


def line_angle_deg(curve: Curve) -> float:
    """FindAngle: where a curve leads, in [0, 360), by the least squared distances (T14)."""
    return _line(curve)[0]


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
    points = []
    for y in range(max(0, shoulder - reach_px), min(len(mask), shoulder + reach_px + 1)):
        found = runs(mask[y])
        if len(found):
            begin, end = found[0] if side == 0 else found[-1]
            begin, end = (begin, min(end, left)) if side == 0 else (max(begin, right), end)
            if end > begin:
                points.append(((begin + end) / 2, y + 0.5))
    curve = np.array(points).reshape(-1, 2)
    upwards = np.count_nonzero(curve[:, 1] < shoulder) > len(curve) / 2
    return curve[::-1] if upwards else curve


def lower_leg_curves(mask: Mask, top: int, bottom: int) -> tuple[Curve, Curve, list[bool]]:
    """Middles of both lower legs in every scan line, and where these are one (T14, T17).

    Where there is one run, it is both legs, a half each.

    Returns:
        (left curve, right curve, for each line with a run: whether the legs share it).
    """
    left, right, merged = [], [], []
    for y in range(max(0, top), min(len(mask), bottom)):
        found = runs(mask[y])
        if not len(found):
            continue
        first, last = found[0], found[-1]
        merged.append(len(found) == 1)
        if len(found) == 1:
            half = (first[0] + first[1]) / 2
            first, last = (first[0], half), (half, last[1])
        left.append(((first[0] + first[1]) / 2, y + 0.5))
        right.append(((last[0] + last[1]) / 2, y + 0.5))
    return np.array(left).reshape(-1, 2), np.array(right).reshape(-1, 2), merged


def turn_deg(one_deg: float, other_deg: float) -> float:
    """The angle between two directions, in [0, 180]."""
    return abs((one_deg - other_deg + 180.0) % 360.0 - 180.0)


def elbow_corner(curve: Curve) -> int:
    """Algorithm 4: the point that parts a curve into two lines of different directions; -1: none.

    Of the points that do, it is the one at which two lines fit best, away from both ends; printed
    is the largest difference, which noise at an end decides (M21, T16).
    """
    guard = max(CORNER_DISTANCE, math.ceil(CORNER_SHARE * len(curve)))
    best, least = -1, math.inf
    for i in range(guard, len(curve) - guard):
        (upper, one), (lower, other) = _line(curve[: i + 1]), _line(curve[i:])
        if turn_deg(upper, lower) >= CORNER_DEG and one + other < least:
            best, least = i, one + other
    return best


def arm_angles(curve: Curve) -> ArmAngles:
    """Algorithm 3: one angle for both halves of a straight arm, else one for each (T15)."""
    corner = elbow_corner(curve)
    if corner < 0:
        angle = line_angle_deg(curve)
        return ArmAngles(angle, angle, -1)
    return ArmAngles(line_angle_deg(curve[: corner + 1]), line_angle_deg(curve[corner:]), corner)


def knees_crossed(merged: list[bool]) -> bool:
    """Algorithm 5: crossed where the lines begin as one run and go on as two, to the end (T17).

    It also fires for legs apart that touch at the knee, and misses two, one, two.
    """
    until = merged.index(False) if False in merged else len(merged)
    return 0 < until < len(merged) and not any(merged[until:])
