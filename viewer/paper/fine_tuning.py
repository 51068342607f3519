"""Fine tuning of the opening posture's lengths, by matching (section 2.4, P20)."""

import math
from collections.abc import Callable
from typing import Final

import msgspec
import numpy as np

from common.body.body import POSE_INDEX, Bdp, Round, Vector, rest_pose
from common.body.proportions import (
    ARMS,
    LENGTHS,
    LOWER_ARM_HEIGHT,
    PER_ROUND,
    TORSO_RADIUS,
    UPPER_ARM_HEIGHT,
    attached,
)
from common.compiled import compiled
from common.raster.bits import Bits, count, pack_words
from common.raster.kernel import match
from common.raster.similarity import Mask
from common.rig.camera import PAPER_ROTATIONS
from viewer.paper.posed_model import view_at
from viewer.paper.tritree import tritree

GRID: Final = 8
"""Unit of lengths in fine tuning: eighths of a pixel."""
ENOUGH: Final = 1e-3
"""Fine tuning stops when a round adds less than this to S (P20)."""
MOST_ROUNDS: Final = 4
ABOVE_CENTRE: Final = 0b1111000011
"""Limbs that fine tuning matches: trunk, head and arms."""
R_SHOULDER_Z, L_SHOULDER_Z = POSE_INDEX["r_shoulder_z"], POSE_INDEX["l_shoulder_z"]
TIP_PX: Final = 1.0
"""Largest displacement of an arm's tip by fine tuning: hands are thinner than the cylinders, so
S alone would cut them off (P20: within 1 px)."""


def fine_tuned(
    mask: Mask, bdp: Bdp, centre_px: tuple[float, float], arms_z_deg: tuple[float, float]
) -> tuple[Bdp, tuple[float, float]]:
    """Trunk radius, arm radius, arm angles and arm length, each in turn set to its best score.

    Coordinate descent on S by the tritree itself, until a round gains less than ENOUGH (P20). Only
    the part above y_c is matched: legs apart would widen the trunk (P13).
    """
    upper = mask.copy()
    upper[round(centre_px[1]) :] = False
    seen = pack_words(upper)
    seen_px = count(seen)
    view = view_at(np.array(PAPER_ROTATIONS[0]), 1.0, centre_px)
    lengths, pose, width = np.array(bdp.lengths()), rest_pose(), mask.shape[1]
    # trunk radius, arm radius, arm lengths right and left (px), angles right and left (deg)
    values = [
        bdp.torso.long_radius,
        bdp.r_upper_arm.radius,
        2 * bdp.r_upper_arm.height,
        2 * bdp.l_upper_arm.height,
        *arms_z_deg,
    ]
    spans = [max(1.0, values[0] / 4), max(1.0, values[1]), TIP_PX, TIP_PX, 8.0, 8.0]

    def score_of(trial: list[float]) -> float:
        return float(_score(np.array(trial), lengths, pose, view, width, seen, seen_px))

    best = _climbed(score_of, values, spans)
    return _tuned(bdp, best), (best[4], best[5])


@compiled
def _score(
    values: Vector,
    lengths: Vector,
    pose: Vector,
    view: Vector,
    width: int,
    seen: Bits,
    seen_px: int,
) -> float:
    """S of the body with other values; they are written into its lengths and its pose."""
    lengths[TORSO_RADIUS] = values[0]
    for at in range(ARMS, LENGTHS, PER_ROUND):
        lengths[at] = values[1]
    for side in range(2):
        for height in (UPPER_ARM_HEIGHT, LOWER_ARM_HEIGHT):
            lengths[height + PER_ROUND * side] = values[2 + side] / 2
    pose[R_SHOULDER_Z], pose[L_SHOULDER_Z] = values[4], values[5]
    return match(attached(lengths), pose, view, ABOVE_CENTRE, width, seen, seen_px)


def _climbed(
    score_of: Callable[[list[float]], float], values: list[float], spans: list[float]
) -> list[float]:
    """Values, each in turn set to its best score within its span, until a round gains little."""
    values, best = list(values), score_of(values)

    def score_along(i: int) -> Callable[[float], float]:
        return lambda eighths: score_of([*values[:i], eighths / GRID, *values[i + 1 :]])

    for _ in range(MOST_ROUNDS):
        before = best
        for i, span in enumerate(spans):
            reach = 2 ** round(math.log2(span * GRID))
            low = max(1, round(values[i] * GRID) - reach)
            found = tritree(score_along(i), (low, low + 2 * reach), 2)
            if found.score > best:
                best, values[i] = found.score, found.angle_deg / GRID
        if best - before < ENOUGH:
            break
    return values


def _tuned(bdp: Bdp, values: list[float]) -> Bdp:
    radius, arm_radius, right, left = values[:4]
    torso = msgspec.structs.replace(bdp.torso, long_radius=radius)
    r_arm, l_arm = Round(arm_radius, right / 2), Round(arm_radius, left / 2)
    return msgspec.structs.replace(
        bdp,
        torso=torso,
        r_upper_arm=r_arm,
        r_lower_arm=r_arm,
        l_upper_arm=l_arm,
        l_lower_arm=l_arm,
    )
