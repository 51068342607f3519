"""Body definition parameters from the opening posture: upright, arms stretched (section 2.4)."""

import math
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Bdp, Elliptic, Round
from common.body.observation import Box, Facing, Measure, Observation
from common.body.proportions import SHOULDER_DROP, THESIS_RATIOS, TORSO_DEPTH_SHARE
from common.bus.messages import Guide
from common.raster.similarity import Mask
from viewer.paper.fine_tuning import fine_tuned

TORSO_SHARE: Final = 0.4
"""Torso to leg is 4 : 6 (P16)."""
HEAD_LONG, HEAD_SHORT, LEG_LONG, LEG_SHORT = 0.20, 0.16, 0.20, 0.18
"""Radii over the width of the trunk (P17); the leg's depth by M10."""
CENTRE_SHARE: Final = 1 - (1 - TORSO_SHARE) * (1 - THESIS_RATIOS["head"] / THESIS_RATIOS["stature"])
"""Depth of the body's centre below the crown, statures, from the thesis's head (T4) and P16."""

SPAN_LEAST: Final = 0.7
"""Smallest span of stretched arms, heights of the person."""
ARM_LIMITS_DEG: Final = (70.0, 115.0)
"""Range of the arms' angles: horizontal or a little below; above it P14 finds the shoulder in
the arms (P10)."""
TORSO_LIMITS: Final = (0.12, 0.36)
"""Range of a trunk's width over the height of a person with closed feet."""


class FacadeShape(NamedTuple):
    """Measurements in the facade's silhouette, pixels; rows run down (P11-P18)."""

    left: float
    right: float
    centre: float
    """x_c."""
    shoulder_row: int
    """y_h."""
    head: float
    torso: float
    leg: float


def opening_measure(
    mask: Mask, person: Observation, guide: Guide | None, facing: Facing
) -> tuple[Measure | None, str]:
    """The measures of the opening posture, or why this is another posture; nothing once
    measured."""
    if guide is not None and guide.measured:
        return None, ""
    if person.cut:
        return None, "the person is partly outside the picture"
    if facing == "flank":
        return measure_side(mask, person.box), ""
    refusal = refusal_of(mask, person.box)
    return (None, refusal) if refusal else (measure_front(mask, person.box), "")


def projection_width(mask: Mask) -> tuple[float, float]:
    """x1 and x2: the first and last column above the mean of the vertical projection (P12, P13).

    The mean runs over the columns from the leftmost to the rightmost.
    """
    column = _heights(mask).astype(np.float64)
    filled = np.flatnonzero(column)
    mean = column[filled[0] : filled[-1] + 1].mean()
    high = np.flatnonzero(column > mean)
    if not len(high):  # all columns have the same height
        high = filled
    return float(high[0]), float(high[-1])


def _heights(mask: Mask) -> NDArray[np.int32]:
    """Number of pixels in each column of a mask: its vertical projection."""
    counts = cv2.reduce(mask.view(np.uint8), 0, cv2.REDUCE_SUM, dtype=cv2.CV_32S)
    return np.asarray(counts[0], np.int32)


def without_head(mask: Mask, torso_width: float) -> Mask:
    """Closing, then opening, by a horizontal line 0.8 trunk widths long: it removes the head (P14).

    The mask is padded by that length on both sides: the closing joins the legs, so that the opening
    keeps them.
    """
    line = 2 * round(0.4 * torso_width) + 1  # odd, or the mask would shift
    padded = cv2.copyMakeBorder(mask.astype(np.uint8), 0, 0, line, line, cv2.BORDER_CONSTANT)
    element = np.ones((1, line), np.uint8)
    closed = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, element)
    opened = cv2.morphologyEx(closed, cv2.MORPH_OPEN, element)
    return opened[:, line:-line].astype(np.bool_)


def facade_shape(mask: Mask, box: Box) -> FacadeShape:
    """Trunk, head and legs of the facade (P11-P17).

    The trunk's width is measured again above y_c only, where legs apart do not count (P13).
    """
    x1, x2 = projection_width(mask)
    rows = np.flatnonzero(without_head(mask, x2 - x1).any(axis=1))
    top = int(rows[0]) if len(rows) else box.top
    below = box.bottom + 1 - top
    torso = TORSO_SHARE * below
    x1, x2 = projection_width(mask[: max(box.top + 2, round(top + torso))])
    leg = 0.5 * (1 - TORSO_SHARE) * below
    return FacadeShape(x1, x2 + 1, (x1 + x2 + 1) / 2, top, top - box.top, torso, leg)


def arm_angle_deg(side: str, dx: float, dy: float) -> float:
    """theta_Z of a stretched arm from the shoulder to its tip; rows run down (P19, C3).

    atan2 keeps what the printed arctan loses: the level arm and the quadrant.
    """
    outward = math.degrees(math.atan2(abs(dx), -dy))
    return outward if side == "r" else 360.0 - outward


def refusal_of(mask: Mask, box: Box) -> str:
    """Why a silhouette is not the opening posture; empty where it is (P10)."""
    height, width = box.bottom + 1 - box.top, box.right + 1 - box.left
    if width < SPAN_LEAST * height:
        return "the arms are not stretched out to the sides"
    found = facade_shape(mask, box)
    trunk = (found.right - found.left) / height
    if not TORSO_LIMITS[0] <= trunk <= TORSO_LIMITS[1]:
        return f"the trunk seems {trunk:.0%} of the height wide: stand upright with closed feet"
    if found.head < 0.05 * height or found.head > 0.3 * height:
        return "no head above the shoulders"
    arms = _arm_angles(mask, box, found)
    for side, angle in zip(("right", "left"), (arms[0], 360.0 - arms[1]), strict=True):
        if not ARM_LIMITS_DEG[0] <= angle <= ARM_LIMITS_DEG[1]:
            return f"the {side} arm is not level ({abs(angle - 90):.0f} degrees off)"
    return ""


def measure_front(mask: Mask, box: Box) -> Measure:
    """All BDPs but the trunk's depth, and the centre of the body, fine-tuned (P12-P20)."""
    found = facade_shape(mask, box)
    radius = (found.right - found.left) / 2
    angles = _arm_angles(mask, box, found)
    lengths = _arm_lengths(mask, box, found)
    thickness = _arm_thickness(mask, found, box)
    width = 2 * radius
    head = Elliptic(HEAD_LONG * width, HEAD_SHORT * width, max(found.head, 1.0))
    leg = Elliptic(LEG_LONG * width, LEG_SHORT * width, found.leg)
    arms = [Round(thickness / 2, max(length / 2, 1.0)) for length in lengths]
    bdp = Bdp(
        torso=Elliptic(radius, TORSO_DEPTH_SHARE * radius, found.torso),
        head=head,
        r_upper_leg=leg,
        l_upper_leg=leg,
        r_lower_leg=leg,
        l_lower_leg=leg,
        r_upper_arm=arms[0],
        l_upper_arm=arms[1],
        r_lower_arm=arms[0],
        l_lower_arm=arms[1],
    )
    centre = (found.centre, found.shoulder_row + found.torso)
    bdp, angles = fine_tuned(mask, bdp, centre, angles)
    return Measure(
        height_px=float(box.bottom + 1 - box.top),
        centre_px=centre,
        depth_px=bdp.torso.long_radius,
        bdp_px=bdp,
        arms_z_deg=angles,
    )


def measure_side(mask: Mask, box: Box) -> Measure:
    """The trunk's half depth from the flank view (P21).

    Measured above y_c alone, like the width in the facade (P13): legs apart or before one another
    would hide the trunk's edges. This view shows no shoulders, so y_c comes from the thesis's
    proportions.
    """
    height = box.bottom + 1 - box.top
    x1, x2 = projection_width(mask[: box.top + max(1, round(CENTRE_SHARE * height))])
    return Measure(
        height_px=float(height),
        centre_px=((x1 + x2 + 1) / 2, float(box.top)),
        depth_px=(x2 + 1 - x1) / 2,
    )


def _shoulders(found: FacadeShape) -> tuple[float, float, float]:
    """Columns of the right and the left shoulder, and their row (P18)."""
    radius = (found.right - found.left) / 2
    row = found.shoulder_row + SHOULDER_DROP * radius
    return found.centre - radius, found.centre + radius, row


def _tips(mask: Mask, box: Box) -> tuple[tuple[float, float], tuple[float, float]]:
    """The arms' extreme points, right (left in the picture) and left: mean row of the column."""
    right_row = float(np.flatnonzero(mask[:, box.left]).mean()) + 0.5
    left_row = float(np.flatnonzero(mask[:, box.right]).mean()) + 0.5
    return (float(box.left), right_row), (float(box.right + 1), left_row)


def _arm_angles(mask: Mask, box: Box, found: FacadeShape) -> tuple[float, float]:
    right, left, row = _shoulders(found)
    tips = _tips(mask, box)
    return (
        arm_angle_deg("r", tips[0][0] - right, tips[0][1] - row),
        arm_angle_deg("l", tips[1][0] - left, tips[1][1] - row),
    )


def _arm_lengths(mask: Mask, box: Box, found: FacadeShape) -> tuple[float, float]:
    right, left, row = _shoulders(found)
    tips = _tips(mask, box)
    return (
        math.hypot(tips[0][0] - right, tips[0][1] - row),
        math.hypot(tips[1][0] - left, tips[1][1] - row),
    )


def _arm_thickness(mask: Mask, found: FacadeShape, box: Box) -> float:
    """Median height of the columns that only arms fill: the start of fine tuning (P20)."""
    column = _heights(mask)
    arms = np.concatenate(
        [column[box.left : int(found.left)], column[int(found.right) + 1 : box.right + 1]]
    )
    arms = arms[arms > 0]
    return float(np.median(arms)) if len(arms) else 2.0
