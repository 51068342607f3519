"""The skeleton of animation files: bones of fixed length, and their places in a run."""

from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from animator.turns import axes_of
from common.body.body import JOINT_NAMES, Vector
from common.body.extremities import AHEAD_SHARE, ALL_JOINT_NAMES, DOWN_SHARE

Joints = NDArray[np.float64]
"""(n, 15, 3) or (n, 22, 3), metres, JOINT_NAMES order or ALL_JOINT_NAMES; NaN where there is no
pose."""


class Bone(NamedTuple):
    """One joint of the skeleton, and the segment between it and its parent."""

    name: str
    """Its usual name in animation programs."""
    parent: int
    """Index in BONES; -1: the root."""
    starts: str
    """The landmark at its joint."""
    ends: str
    """The landmark that it is aimed at."""


BONES: Final = (
    Bone("Hips", -1, "pelvis", "l_hip"),
    Bone("Spine", 0, "pelvis", "neck"),
    Bone("Head", 1, "neck", "head_top"),
    Bone("LeftShoulder", 1, "neck", "l_shoulder"),
    Bone("LeftArm", 3, "l_shoulder", "l_elbow"),
    Bone("LeftForeArm", 4, "l_elbow", "l_wrist"),
    Bone("RightShoulder", 1, "neck", "r_shoulder"),
    Bone("RightArm", 6, "r_shoulder", "r_elbow"),
    Bone("RightForeArm", 7, "r_elbow", "r_wrist"),
    Bone("LeftUpLeg", 0, "l_hip", "l_knee"),
    Bone("LeftLeg", 9, "l_knee", "l_ankle"),
    Bone("RightUpLeg", 0, "r_hip", "r_knee"),
    Bone("RightLeg", 11, "r_knee", "r_ankle"),
    Bone("LeftHand", 5, "l_wrist", "l_knuckle"),
    Bone("RightHand", 8, "r_wrist", "r_knuckle"),
    Bone("LeftFoot", 10, "l_ankle", "l_toe"),
    Bone("RightFoot", 12, "r_ankle", "r_toe"),
)
"""The bones, parents before their children. Pelvis and trunk turn independently; so do the
shoulders, which rise with the arms. A body without extremities lacks hands and feet, the last
four."""
OF_JOINTS: Final = {
    len(JOINT_NAMES): sum(bone.ends in JOINT_NAMES for bone in BONES),
    len(ALL_JOINT_NAMES): len(BONES),
}
"""Number of BONES for that many joints."""

AT: Final = {name: i for i, name in enumerate(ALL_JOINT_NAMES)}
"""Index of each landmark."""
_UP, _LEFT = np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])
_FOOT: Final = np.array([0.0, -DOWN_SHARE, AHEAD_SHARE]) / np.hypot(DOWN_SHARE, AHEAD_SHARE)
_REST: Final = {"Spine": _UP, "Head": _UP, "Hips": _LEFT} | {
    f"{side}{bone}": {"Foot": _FOOT, "Leg": -_UP, "UpLeg": -_UP}.get(bone, sign * _LEFT)
    for side, sign in (("Left", 1.0), ("Right", -1.0))
    for bone in ("Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot")
}
"""Direction of a bone at rest: the opening posture, farthest from every pose in which a limb
points the opposite way, where the shortest turn would jump. Shoulders rest in their usual
direction."""


class Skeleton(msgspec.Struct, frozen=True):
    """A body of rigid bones, facing +z, arms stretched out."""

    tips_m: Vector
    """(13, 3) or (17, 3) from each bone's joint to its target, at rest, BONES order."""

    @property
    def bones(self) -> tuple[Bone, ...]:
        """Those of BONES that it has."""
        return BONES[: len(self.tips_m)]


class Motion(NamedTuple):
    """A skeleton's motion."""

    root_m: Vector
    """(n, 3) places of the hips."""
    turns: tuple[Rotation, ...]
    """(n,) turns of each bone, in its parent's axes."""


def skeleton_of(joints_m: Joints) -> Skeleton:
    """The bones of a run: the median length of each over the frames that have a pose.

    For a rigid body, as the paper's, that is the length by its BDPs.

    Args:
        joints_m: At least one row without NaN.
    """
    posed = joints_m[np.isfinite(joints_m).all(axis=(1, 2))]
    spine = spine_axes(posed)
    tips = []
    for bone in BONES[: OF_JOINTS[joints_m.shape[1]]]:
        along = between_m(posed, bone.starts, bone.ends)
        length_m = float(np.median(np.linalg.norm(along, axis=1)))
        rest = _REST.get(bone.name)
        if rest is None:
            rest = np.median((spine.transpose(0, 2, 1) @ along[..., None])[..., 0], axis=0)
            rest = rest / max(float(np.linalg.norm(rest)), 1e-9)
        tips.append(length_m * rest)
    return Skeleton(np.array(tips))


def joints_of(skeleton: Skeleton, motion: Motion) -> Joints:
    """The 15 landmarks of a moving skeleton, or with hands and feet the 22. Nose and heels are
    NaN, because no bone ends there."""
    names = JOINT_NAMES if len(skeleton.bones) < len(BONES) else ALL_JOINT_NAMES
    found = np.full((len(motion.root_m), len(names), 3), np.nan)
    world: list[Rotation] = []
    origins: list[NDArray[np.float64]] = []
    for i, (bone, own) in enumerate(zip(skeleton.bones, motion.turns, strict=True)):
        above = world[bone.parent] if i else Rotation.identity()
        origins.append(
            origins[bone.parent] + above.apply(offset_m(skeleton, i)) if i else motion.root_m
        )
        world.append(above * own)
        found[:, AT[bone.starts]] = origins[i]
        found[:, AT[bone.ends]] = origins[i] + world[i].apply(skeleton.tips_m[i])
    return found


def offset_m(skeleton: Skeleton, bone: int) -> Vector:
    """From the joint of a bone's parent to its own, at rest, (3,)."""
    own, parent = BONES[bone], BONES[BONES[bone].parent]
    if own.parent < 0 or own.starts == parent.starts:
        return np.zeros(3)
    mirrored = own.starts == "r_hip"
    tip: Vector = skeleton.tips_m[own.parent]
    return -tip if mirrored else tip


def rest_origins_m(skeleton: Skeleton) -> Vector:
    """Places of the bones' joints at rest, (bones, 3), the feet on the floor."""
    origins = np.zeros((len(skeleton.bones), 3))
    for i, bone in enumerate(skeleton.bones):
        if bone.parent >= 0:
            origins[i] = origins[bone.parent] + offset_m(skeleton, i)
    origins[:, 1] -= min(0.0, float((origins + skeleton.tips_m)[:, 1].min()))
    return origins


def spine_axes(joints_m: Joints) -> NDArray[np.float64]:
    """Left, up and front of the trunk as columns, (n, 3, 3)."""
    up = between_m(joints_m, "pelvis", "neck")
    return axes_of(up, between_m(joints_m, "r_shoulder", "l_shoulder"))


def between_m(joints_m: Joints, start: str, end: str) -> NDArray[np.float64]:
    """From one landmark to another, (n, 3)."""
    along: NDArray[np.float64] = joints_m[:, AT[end]] - joints_m[:, AT[start]]
    return along
