"""The stick body of one silhouette: joints, foreshortening and hidden segments (T10-T18)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, OTHER_SIDE, Vector
from common.body.kinematics import joints
from common.body.observation import Fit
from common.body.stick_body import (
    ADULT,
    BREADTH,
    GIRTH,
    RATIO,
    STATURE,
    THESIS,
    joints_px,
    pose_of,
)
from common.method import Method
from common.raster.bits import pack_words
from common.raster.kernel import CENTRE_X, CENTRE_Y, FOCAL_X
from common.raster.similarity import Mask
from common.raster.stick_raster import ALL_SEGMENTS, match_stick
from viewer.stick.normalization import STATURE_PX, normalised
from viewer.stick.thesis_fit import fit_thesis
from viewer.stick.tracked_fit import fit_tracked

_RIGHT, _LEFT = (
    [JOINT_NAMES.index(f"{side}_{name}") for name in ("shoulder", "hip")] for side in "rl"
)


class Stick(NamedTuple):
    """A fitted stick body, in the pixels of the given silhouette."""

    pose: Vector
    """(POSE_SIZE,), see common.body.stick_body."""
    joints_px: NDArray[np.float64]
    """(15, 2), JOINT_NAMES; r is on the left of the picture (T10)."""
    hidden: NDArray[np.bool_]
    """(10,) of LIMBS: segments that the silhouette does not show, because they lie over the rest
    of the body."""
    score: float
    """S of the drawn body and the silhouette, at the normalised size (eq. 3.3)."""
    evaluations: int
    """Number of matches."""

    @property
    def ratios(self) -> Vector:
        """Foreshortening of LIMBS, (10,), in [0, 1]."""
        return self.pose[RATIO:GIRTH]

    @property
    def breadth(self) -> float:
        """Share of its breadth that the trunk shows."""
        return float(self.pose[BREADTH])

    @property
    def stature_px(self) -> float:
        """Height that the body would have standing upright, pixels."""
        return float(self.pose[STATURE])


class NoFit(ValueError):
    """A silhouette to which no body can be fitted."""


def fit(mask: Mask, before: Vector | None, stature_px: float, method: Method) -> Stick:
    """The stick body of a silhouette.

    The thesis's method treats every frame separately, as printed; ours tracks the body.

    Args:
        mask: (H, W), of any size: it is normalised here (T9).
        before: The predicted stick pose, in its pixels; None at the start.
        stature_px: Height of the body standing upright, in pixels of the mask (T20).
        method: How to fit.

    Raises:
        NoFit: When the mask is empty, contains nothing of its stature, or the stature is invalid.
    """
    if not mask.any() or not stature_px > 0.0:
        raise NoFit(f"no body to fit: {mask.sum()} pixels, a stature of {stature_px}")
    normal = normalised(mask, stature_px)
    man = THESIS if method.stick_lifting else ADULT
    if not normal.mask.any():
        raise NoFit(f"no body to fit: {mask.sum()} pixels are nothing of {stature_px}")
    if method.stick_lifting:
        pose, hidden, evaluations = fit_thesis(normal.mask, float(STATURE_PX), method)
    else:
        expected = None if before is None else normal.inward(before)
        pose, hidden, evaluations = fit_tracked(normal.mask, expected)
    seen, width = pack_words(normal.mask), normal.mask.shape[1]
    value = match_stick(man.lengths, man.parts, man.depth, pose, ALL_SEGMENTS, width, seen)
    pose = normal.outward(pose)
    return Stick(pose, joints_px(man, pose), hidden, float(value), evaluations)


def expected(body: Vector, pose: Vector, view: Vector, stature_px: float) -> Vector:
    """The stick pose, (POSE_SIZE,), of a posed body in a view, r on the left (T10).

    Args:
        body: Body vector.
        pose: (25,)
        view: Scaled orthography, as `view_at` returns it.
        stature_px: Height that the body would have standing upright, in that picture.
    """
    across = joints(body, pose) - pose[:3]
    scale_px, root_px = view[FOCAL_X], view[[CENTRE_X, CENTRE_Y]]
    seen_px = root_px + scale_px * across @ view[:9].reshape(3, 3)[:2].T
    mirrored = seen_px[_RIGHT, 0].mean() > seen_px[_LEFT, 0].mean()
    return pose_of(ADULT, seen_px[OTHER_SIDE] if mirrored else seen_px, stature_px)


def fit_of(stick: Stick) -> Fit:
    """A fit as a viewer reports it."""
    return Fit(
        joints_px=tuple((float(x), float(y)) for x, y in stick.joints_px),
        ratios=tuple(stick.ratios.tolist()),
        breadth=stick.breadth,
        stature_px=stick.stature_px,
        hidden=tuple(stick.hidden.tolist()),
        score=stick.score,
        matches=stick.evaluations,
    )
