"""The stick body fitted as the thesis prints it: its order of segments, frame by frame (T11)."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import LIMBS, Vector
from common.body.proportions import THESIS_RATIOS
from common.body.stick_body import (
    ANGLE,
    HEAD,
    RATIO,
    STATURE,
    THESIS,
    TORSO,
    segments_px,
    standing,
)
from common.method import Method
from common.raster.bits import Bits, pack_words
from common.raster.similarity import Mask
from common.raster.stick_raster import match_stick
from viewer.stick.contour import (
    arm_angles,
    arm_curve,
    knees_crossed,
    line_angle_deg,
    lower_leg_curves,
    outer_runs,
)
from viewer.stick.subdivision import angle_found, ratio_found

LIMITS_DEG: Final = {"neck": (45.0, 135.0), "waist": (45.0, 135.0), "hip": (240.0, 300.0)}
"""Ranges of the segments' angles, degrees: table 3.3 (T6)."""


Span = tuple[float, float]
"""First and last pixel along the rows or down the columns."""


class ThesisFit(NamedTuple):
    """Result of the thesis's stages."""

    pose: Vector
    hidden: NDArray[np.bool_]
    """(10,) of LIMBS: segments that the user is asked about (T26)."""
    evaluations: int


class _Fit(NamedTuple):
    """A fit in progress: the pose is changed in place, matches are counted."""

    seen: Bits
    width: int
    pose: Vector
    matches: list[int]
    method: Method


def fit_thesis(mask: Mask, stature_px: float, method: Method) -> ThesisFit:
    """Torso, head, contours of arms and lower legs, upper legs; each is then foreshortened (T11).

    Args:
        mask: (H, W), normalised.
        stature_px: Height of the standing body, in its pixels.
        method: How elbows are found.
    """
    rows = np.flatnonzero(mask.any(axis=1))
    share = (THESIS_RATIOS["head"] + THESIS_RATIOS["torso"]) / THESIS_RATIOS["stature"]
    fit = _Fit(
        pack_words(mask),
        mask.shape[1],
        standing(_middle(mask, stature_px), rows[0] + share * stature_px, stature_px),
        [],
        method,
    )
    hidden = np.zeros(len(LIMBS), np.bool_)
    _turned(fit, (TORSO, HEAD), LIMITS_DEG["waist"])
    _shortened(fit, TORSO)
    _turned(fit, (HEAD,), LIMITS_DEG["neck"])
    _shortened(fit, HEAD)
    for side in range(2):
        hidden[[6 + side, 8 + side]] = not _arm(fit, mask, side)
    hidden[[4, 5]] = not _lower_legs(fit, mask, int(rows[-1]) + 1)
    for side in range(2):
        _turned(fit, (2 + side, 4 + side), LIMITS_DEG["hip"])
        for limb in (2 + side, 4 + side, 6 + side, 8 + side):
            _shortened(fit, limb)
    return ThesisFit(fit.pose, hidden, sum(fit.matches))


def _middle(mask: Mask, stature_px: float) -> float:
    """Column of the torso: the median of the rows' middles; one stretched arm moves few of them
    (T11)."""
    rows = np.flatnonzero(mask.any(axis=1))
    head, torso = (THESIS_RATIOS[name] / THESIS_RATIOS["stature"] for name in ("head", "torso"))
    high, low = (rows[0] + round(share * stature_px) for share in (head, head + torso))
    found = outer_runs(mask[high:low] if mask[high:low].any() else mask)
    return float(np.median(found[found[:, 0] > 0][:, [1, 4]].mean(axis=1)))


def _turned(fit: _Fit, limbs: Sequence[int], limits_deg: tuple[float, float]) -> None:
    """Algorithm 1 for the first of the limbs; the head turns with the torso."""
    at = ANGLE + limbs[0]
    part = _reachable(fit, limbs)

    def score_at(angle_deg: float) -> float:
        fit.pose[at] = angle_deg
        if limbs == (TORSO, HEAD):
            fit.pose[ANGLE + HEAD] = angle_deg
        return _score(fit, limbs, part)

    found = angle_found(score_at, limits_deg)
    score_at(found.angle_deg)
    fit.matches.append(found.matches)


def _shortened(fit: _Fit, limb: int) -> None:
    """Algorithm 6 for a limb."""
    at = RATIO + limb
    part = _around(fit, limb)

    def score_at(ratio: float) -> float:
        fit.pose[at] = ratio
        return _score(fit, (limb,), part)

    found = ratio_found(score_at, float(THESIS.lengths[limb] * fit.pose[STATURE]))
    fit.pose[at] = found.angle_deg
    fit.matches.append(found.matches)


def _arm(fit: _Fit, mask: Mask, side: int) -> bool:
    """Both angles of an arm from its curve; False where it has none (algorithms 2 and 3)."""
    ends = segments_px(THESIS, fit.pose)
    size = fit.pose[STATURE]
    half = THESIS.parts[TORSO, 3] * size
    middle = ends[TORSO].mean(axis=0)[0]
    trunk = (round(middle - half), round(middle + half), round(ends[6 + side, 0, 1]))
    reach = (THESIS.lengths[6] + THESIS.lengths[8]) * size
    curve = arm_curve(mask, trunk, round(reach), side)
    if len(curve) < 2:
        return False
    found = arm_angles(curve, fit.method)
    fit.pose[[ANGLE + 6 + side, ANGLE + 8 + side]] = found.upper, found.lower
    return True


def _lower_legs(fit: _Fit, mask: Mask, bottom: int) -> bool:
    """Angles of both lower legs, exchanged where they cross (algorithms 2 and 5)."""
    size = fit.pose[STATURE]
    top = round(bottom - THESIS.lengths[4] * size)
    left, right, merged = lower_leg_curves(mask, top, bottom)
    if len(left) < 2:
        return False
    angles = [line_angle_deg(left), line_angle_deg(right)]
    if knees_crossed(merged):
        angles.reverse()
    fit.pose[[ANGLE + 4, ANGLE + 5]] = angles
    return True


def _score(fit: _Fit, limbs: Sequence[int], part: Bits) -> float:
    """S of some segments and the part of the silhouette that may contain them (T13)."""
    which = sum(1 << limb for limb in limbs)
    man = THESIS
    return float(match_stick(man.lengths, man.parts, man.depth, fit.pose, which, fit.width, part))


def _reachable(fit: _Fit, limbs: Sequence[int]) -> Bits:
    """The silhouette within the segments' reach around the joint on which they hang."""
    reach = sum(float(THESIS.lengths[limb]) for limb in limbs) * fit.pose[STATURE]
    x, y = segments_px(THESIS, fit.pose)[limbs[0], 0]
    rows = (y - reach, y) if limbs[0] in (TORSO, HEAD) else (y, y + reach)
    return _box(fit, (x - reach, x + reach), rows)


def _around(fit: _Fit, limb: int) -> Bits:
    """The silhouette in the rows and columns of a segment at its full length."""
    pose = fit.pose.copy()
    pose[RATIO + limb] = 1.0
    ends = segments_px(THESIS, pose)[limb]
    half = THESIS.parts[limb, 3] * pose[STATURE]
    low, high = ends.min(axis=0) - half, ends.max(axis=0) + half
    return _box(fit, (low[0], high[0]), (low[1], high[1]))


def _box(fit: _Fit, columns: Span, rows: Span) -> Bits:
    inside = np.zeros((fit.seen.shape[0], fit.width), np.bool_)
    first_x, last_x = (max(0, round(value)) for value in columns)
    first_y, last_y = (max(0, round(value)) for value in rows)
    inside[first_y:last_y, first_x:last_x] = True
    return fit.seen & pack_words(inside)
