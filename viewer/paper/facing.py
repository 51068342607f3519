"""Facade or flank: the width of the upper body against two thresholds (section 3.1)."""

import math

import numpy as np

from common.body.body import Bdp
from common.body.observation import Facing
from common.raster.similarity import Mask

FACADE_YAW_DEG, FLANK_YAW_DEG = 35.0, 55.0
"""Yaws up to which a view is surely the facade, and from which on surely the flank (P26)."""

HIP_SHARE = 0.2
"""Depth of the hips below the body's centre, in heights of the trunk (P24)."""


def upper_body_px(mask: Mask, centre_row: float, torso_px: float) -> float:
    """W_u-body: width of the columns that are taller than the trunk, above the hips.

    Args:
        mask: The silhouette, (H, W).
        centre_row: Row of the body's centre y_c.
        torso_px: Height of the trunk in this picture: height_torso r_t,n.

    Returns:
        x2 - x1 for the first and last such column; 0 where there are fewer than two.

    Source: section 3.1 with the readings M8 and M9: rows run down, so the hips are at
    y_c + 0.2 height_torso; the scale factor is in `torso_px` and `centre_row` already (P24, P25).
    """
    hip_row = max(0, round(centre_row + HIP_SHARE * torso_px))
    high = np.flatnonzero(mask[:hip_row].sum(axis=0) > torso_px)
    return float(high[-1] - high[0]) if len(high) else 0.0


def trunk_width(bdp: Bdp, yaw_deg: float) -> float:
    """Width of the elliptic trunk, turned by a yaw, in the BDP's unit (P26)."""
    yaw = math.radians(yaw_deg)
    return 2 * math.hypot(
        bdp.torso.long_radius * math.cos(yaw), bdp.torso.short_radius * math.sin(yaw)
    )


def thresholds_px(bdp: Bdp, px_per_m: float) -> tuple[float, float]:
    """th_low and th_high of a view at its present scale (P26)."""
    return trunk_width(bdp, FLANK_YAW_DEG) * px_per_m, trunk_width(bdp, FACADE_YAW_DEG) * px_per_m


def vote(before: Facing, width_px: float, limits_px: tuple[float, float]) -> Facing:
    """This view's vote: it changes only beyond a threshold (P26)."""
    low, high = limits_px
    if width_px < low:
        return "flank"
    if width_px > high:
        return "facade"
    return before
