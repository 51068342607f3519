"""Leg angles: standing or squatting in the facade view, hips and knees in the flank (3.4)."""

from typing import Final

from common.body.body import LIMITS_DEG
from common.body.kinematics import LEG_LIMBS
from common.config.part_settings import SearchSettings
from common.method import Method
from viewer.paper.posed_model import PosedModel, SearchRange, searched, turn

SIDES: Final = ("r", "l")
SQUAT_SHARE, RISE_SHARE = 0.04, 0.025
"""Drop of the navel from its height in the opening posture that begins a squat, and that ends
it, statures: normal walking bobs by 2-3 % (P33)."""

_HIP_Z = [turn(LEG_LIMBS[i], **{f"{side}_hip_z": 1.0}) for i, side in enumerate(SIDES)]
_HIP_X = [turn(LEG_LIMBS[i], **{f"{side}_hip_x": 1.0}) for i, side in enumerate(SIDES)]
_KNEE = [turn(LEG_LIMBS[i][1:], **{f"{side}_knee_x": 1.0}) for i, side in enumerate(SIDES)]
_SQUAT = [
    turn(LEG_LIMBS[i], **{f"{side}_hip_x": 1.0, f"{side}_knee_x": -2.0})
    for i, side in enumerate(SIDES)
]
_BOTH_SQUAT = turn(
    LEG_LIMBS[0] + LEG_LIMBS[1], r_hip_x=1.0, r_knee_x=-2.0, l_hip_x=1.0, l_knee_x=-2.0
)
_SQUAT_LIMITS_DEG: Final = (0.0, -LIMITS_DEG["r_knee_x"][0] / 2)
"""The knee, bent twice as far as the hip, limits the range (P34)."""


def squats(before: bool, drop_share: float) -> bool:
    """Whether the person squats, from the navel's drop in statures, with hysteresis (P33)."""
    return drop_share > (RISE_SHARE if before else SQUAT_SHARE)


def facade_legs(model: PosedModel, settings: SearchSettings, squatting: bool) -> PosedModel:
    """theta_Z of both hips; in a squat also theta_X with knee = -2 theta_X (P33, P34).

    The triangle of hip, knee and foot has two equal sides, so the foot stays under the hip (C6).
    """
    width, stop = settings.leg_window_deg, settings.stop_deg
    for i, side in enumerate(SIDES):
        model = searched(model, _HIP_Z[i], SearchRange(width, stop, LIMITS_DEG[f"{side}_hip_z"]))
    if squatting:
        for how in _SQUAT:
            model = searched(model, how, SearchRange(width, stop, _SQUAT_LIMITS_DEG))
    return model


def flank_legs(
    model: PosedModel, settings: SearchSettings, near: int, method: Method
) -> PosedModel:
    """theta_X of the hip and then of the knee, the near leg first (P35).

    Both legs share the silhouette, and one leg can move unseen behind the other: beyond the print
    they are also searched together as one squat, and the better explanation is kept.
    """
    width, stop = settings.leg_window_deg, settings.stop_deg
    apart = model
    for i in (near, 1 - near):
        side = SIDES[i]
        apart = searched(apart, _HIP_X[i], SearchRange(width, stop, LIMITS_DEG[f"{side}_hip_x"]))
        apart = searched(apart, _KNEE[i], SearchRange(width, stop, LIMITS_DEG[f"{side}_knee_x"]))
    if not method.common_squat:
        return apart
    together = searched(model, _BOTH_SQUAT, SearchRange(width, stop, _SQUAT_LIMITS_DEG))
    better = apart if apart.score >= together.score else together
    return better._replace(matches=apart.matches + together.matches - model.matches)
