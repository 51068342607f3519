"""Arm angles: shoulder and elbow in the facade view, shoulder alone in the flank (section 3.3)."""

import math
from typing import Final

from common.body.body import LIMITS_DEG, POSE_INDEX, wrapped_deg
from common.body.kinematics import ARM_LIMBS
from common.config.part_settings import SearchSettings
from common.method import Method
from viewer.paper.posed_model import PosedModel, SearchRange, matched, searched, turn

SIDES: Final = ("r", "l")
BEND_MOST_DEG: Final = 140.0
"""Largest bend of an elbow, degrees (section 3.3, step 2)."""

HIDDEN: Final = 0.004
"""Smallest gain in S for which an arm moves in the flank view: five pixels of a body of 2000. An
arm hidden by the trunk or the other arm stays where it was."""
ANY_GAIN: Final = -1.0
"""Gain in S below any possible one: as printed, the best angle of a search is always taken."""

_SHOULDER_Z = [turn(ARM_LIMBS[i], **{f"{side}_shoulder_z": 1.0}) for i, side in enumerate(SIDES)]
_SHOULDER_X = [turn(ARM_LIMBS[i], **{f"{side}_shoulder_x": 1.0}) for i, side in enumerate(SIDES)]
_ELBOW = [turn(ARM_LIMBS[i][1:], **{f"{side}_elbow_x": 1.0}) for i, side in enumerate(SIDES)]
_BOTH_X = turn(ARM_LIMBS[0] + ARM_LIMBS[1], r_shoulder_x=1.0, l_shoulder_x=1.0)


def half_turn_deg(side: str, shoulder_x_deg: float) -> float:
    """Margin of theta_Z, degrees, where theta_X has swung the arm up past the horizontal.

    There the arm points up at theta_Z = 180, and outwards lies beyond: the ranges of P30 and the
    inward limit apply to theta_Z less this half turn. A departure: the print has one range.
    """
    if math.cos(math.radians(shoulder_x_deg)) >= 0.0:
        return 0.0
    return 180.0 if side == "r" else -180.0


def inward_limit_deg(side: str, shoulder_z_deg: float) -> float:
    """th_a: largest inward bend of the elbow before the lower arm meets the trunk.

    At the limit the wrist lies on the vertical line through the shoulder. Left arm mirrored.

    Source: section 3.3, step (2); figure 10b (P31).
    """
    hanging = 180.0 - shoulder_z_deg if side == "r" else shoulder_z_deg - 180.0
    return 2.0 * hanging if hanging < 70.0 else BEND_MOST_DEG


def facade_arms(
    model: PosedModel, settings: SearchSettings, wide: bool, method: Method
) -> PosedModel:
    """Shoulder theta_Z, then theta_Y and elbow, of the right and then the left arm (P30, P31).

    theta_X keeps its value: the facade view cannot see it. The elbow is searched with the
    forearm outwards positive, then given with the theta_Y that makes flexion positive (C5).
    """
    for i, side in enumerate(SIDES):
        outward = 90.0 if side == "r" else -90.0
        model = _with_elbow_outward(model, side, outward)
        low, high = LIMITS_DEG[f"{side}_shoulder_z"]
        spare = 0.0
        if method.raised_arm_ranges:
            spare = half_turn_deg(side, model.pose[_SHOULDER_X[i].at])
        limits = (low + spare, high + spare)
        width, stop = settings.arm_window_deg, settings.stop_deg
        model = searched(model, _SHOULDER_Z[i], SearchRange(width, stop, limits, wide))
        inward = inward_limit_deg(side, model.pose[_SHOULDER_Z[i].at] - spare)
        model = searched(model, _ELBOW[i], SearchRange(width, stop, (-inward, BEND_MOST_DEG)))
        model = _with_flexion_positive(model, side, outward)
    return model


def flank_arms(
    model: PosedModel, settings: SearchSettings, near: int, wide: bool, method: Method
) -> PosedModel:
    """theta_X of both shoulders from one silhouette (P32).

    Both arms share it: they are searched together as one swing and one after the other (the near
    arm first), and the better explanation is kept; the common swing wins a tie.

    Args:
        model: The model so far.
        settings: Widths of the search.
        near: 0 where the right arm is nearer to the camera, 1 where the left is.
        wide: True where the angles are unknown.
        method: Whether hidden arms stay.
    """
    width, stop = settings.arm_window_deg, settings.stop_deg
    least_gain = HIDDEN if method.hidden_arms else ANY_GAIN
    apart = model = matched(model)
    for i in (near, 1 - near):
        within = SearchRange(width, stop, _whole_turn(model, i), wide)
        apart = searched(apart, _SHOULDER_X[i], within, least_gain)
    start = model.pose.copy()
    start[_SHOULDER_X[1 - near].at] = start[_SHOULDER_X[near].at]
    within = SearchRange(width, stop, _whole_turn(model, near), wide)
    together = searched(matched(model._replace(pose=start)), _BOTH_X, within, least_gain)
    matches = apart.matches + together.matches - model.matches
    better = apart if apart.score > together.score else together
    pose = better.pose.copy()
    for how in _SHOULDER_X:
        pose[how.at] = wrapped_deg(pose[how.at])
    return better._replace(pose=pose, matches=matches)


def _whole_turn(model: PosedModel, i: int) -> tuple[float, float]:
    """The printed range of theta_X, [-180, 180], centred on the present angle: its ends are one
    pose, so a search passes through them, and every probe lies in the range after wrapping
    (P30)."""
    angle = model.pose[_SHOULDER_X[i].at]
    return angle - 180.0, angle + 180.0


def _with_elbow_outward(model: PosedModel, side: str, outward_deg: float) -> PosedModel:
    """theta_Y outwards and the elbow's sign turned with it: the same place of the forearm."""
    pose = model.pose.copy()
    y, elbow = POSE_INDEX[f"{side}_shoulder_y"], POSE_INDEX[f"{side}_elbow_x"]
    if pose[y] * outward_deg < 0.0:
        pose[elbow] = -pose[elbow]
    pose[y] = outward_deg
    return model._replace(pose=pose)


def _with_flexion_positive(model: PosedModel, side: str, outward_deg: float) -> PosedModel:
    pose = model.pose.copy()
    y, elbow = POSE_INDEX[f"{side}_shoulder_y"], POSE_INDEX[f"{side}_elbow_x"]
    if pose[elbow] < 0.0:
        pose[y], pose[elbow] = -outward_deg, -pose[elbow]
    return model._replace(pose=pose)
