"""Fusion of two views' angles into one body's: which view determines which angle (section 4.4)."""

from typing import Final

from common.body.body import POSE_INDEX, Vector, wrapped_deg
from common.body.observation import Observation
from common.method import Method

LIFT_WITHIN_DEG: Final = 5.0
"""Distance of a hip's theta_Z from 180 up to which the leg is seen from its flank, degrees: it
may be lifted (P53, M16)."""

ARM_FROM_FACADE: Final = (
    "r_shoulder_y",
    "r_shoulder_z",
    "l_shoulder_y",
    "l_shoulder_z",
    "r_elbow_x",
    "l_elbow_x",
)
ARM_FROM_FLANK: Final = ("r_shoulder_x", "l_shoulder_x")


def lifted(side: str, hip_z_deg: float, squats: bool) -> bool:
    """Whether a leg is lifted, by the facade's theta_Z of its hip (P53, M16).

    Printed is 175 < theta_Z < 180 for the right leg, mirrored for the left. 180 itself is the
    resting value and on the search's grid, so M16 reads |theta_Z - 180| <= 5. Beyond the print, a
    leg counts as lifted only where the knees are not bent in a squat.
    """
    inwards_deg = wrapped_deg(hip_z_deg - 180.0) * (-1.0 if side == "r" else 1.0)
    if squats:
        return 0.0 < inwards_deg < LIFT_WITHIN_DEG
    return abs(inwards_deg) <= LIFT_WITHIN_DEG


def fused(
    before: Vector, facade: Observation | None, flank: Observation | None, method: Method
) -> Vector:
    """The universal pose from both views' angles.

    Arms: theta_X of the shoulders from the flank, the rest from the facade (P51). Legs: theta_Z of
    the hips from the facade; theta_X of hips and knees from the flank where the leg is lifted, else
    from the facade, which has 0 unless it squats (P52, P53). Other angles stay as they were.

    Args:
        before: Pose of the frame before, (25,); its position and trunk are not changed.
        facade: Result of the view that sees the facade, if it has a body.
        flank: Result of the view that sees the flank, if it has a body.
        method: Whether a person who squats lifts no leg.
    """
    pose = before.copy()
    if flank is not None:
        pose = _with_angles(pose, flank, ARM_FROM_FLANK)
    if facade is not None:
        pose = _with_angles(pose, facade, ARM_FROM_FACADE)
    for side in ("r", "l"):
        hip_x, knee_x = f"{side}_hip_x", f"{side}_knee_x"
        if facade is not None:
            pose = _with_angles(pose, facade, (f"{side}_hip_z",))
        squats = facade is not None and facade.search is not None and facade.search.squatting
        may_lift = not (squats and method.squat_first)
        if facade is not None and may_lift:
            may_lift = lifted(side, float(pose[POSE_INDEX[f"{side}_hip_z"]]), squats)
        if flank is not None and may_lift:
            pose = _with_angles(pose, flank, (hip_x, knee_x))
        elif facade is not None and squats:
            pose = _with_angles(pose, facade, (hip_x, knee_x))
        elif facade is not None:
            pose[[POSE_INDEX[hip_x], POSE_INDEX[knee_x]]] = 0.0
    return pose


def _with_angles(pose: Vector, person: Observation, names: tuple[str, ...]) -> Vector:
    """The pose with the named angles that a view determines."""
    found, angles_deg = pose.copy(), {} if person.search is None else person.search.angles_deg
    for name in names:
        if name in angles_deg:
            found[POSE_INDEX[name]] = angles_deg[name]
    return found
