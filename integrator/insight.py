"""The pose that both silhouettes propose, and where joints lie beside the cylinders."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body import JOINT_NAMES, Bdp, Vector, stature
from common.camera import Rig
from common.kinematics import TORSO, joints, limb_frames
from common.messages import Report, unpack
from integrator import propose
from integrator.limbs import pose_of, trunk_of

AT: Final = [JOINT_NAMES.index(name) for name in propose.JOINTS]
"""Where the proposed joints stand among the landmarks."""
PELVIS, NECK = JOINT_NAMES.index("pelvis"), JOINT_NAMES.index("neck")


def seen_joints(
    bdp: Bdp, rig: Rig, seen: tuple[Report, Report], facade: int
) -> NDArray[np.float64] | None:
    """The twelve joints, (12, 3) world metres; None for cameras that the network was not taught."""
    masks = (unpack(seen[0]), unpack(seen[1]))
    height_m = stature(bdp)
    window = propose.look(masks, rig, height_m, facade)
    if window is None:
        return None
    found = propose.proposed(propose.shipped(), window, height_m)
    found[propose.HIPS] -= height_m * trunk_of(found) @ propose.HIPS_OFF
    return found


def pose_and_rest(
    body: Vector, before: Vector, found: NDArray[np.float64]
) -> tuple[Vector, NDArray[np.float64]]:
    """The pose of found joints, and what the landmarks still miss, (15, 3) in the trunk's axes.

    Shoulders rise with their arms and people differ: both are more than cylinders can show.
    """
    pose = pose_of(found, body, before)
    rest = np.zeros((len(JOINT_NAMES), 3))
    landmarks = joints(body, pose)
    rest[AT] = (found - landmarks[AT]) @ trunk_axes(body, pose)
    rest[PELVIS] = rest[AT[propose.HIPS]].mean(axis=0)
    rest[NECK] = rest[AT[propose.SHOULDERS]].mean(axis=0)
    return pose, rest


def trunk_axes(body: Vector, pose: Vector) -> NDArray[np.float64]:
    """Left, up and front of the trunk in the world, as columns, (3, 3)."""
    axes: NDArray[np.float64] = limb_frames(body, pose)[TORSO, 3:].reshape(3, 3)
    return axes
