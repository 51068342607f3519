"""The ten-cylinder body: definition parameters (BDPs), joints, angles (BAPs) and their limits."""

import math
from typing import Final

import msgspec
import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
"""(n,) numbers: a body, a pose, a view, or a place in metres; each use states n."""
Floats = NDArray[np.float64]
"""Arrays of more dimensions, (n, k) or (n, k, 3): rows of places, of frames, of weights."""


class Elliptic(msgspec.Struct, frozen=True, cache_hash=True, forbid_unknown_fields=True):
    """A cylinder of elliptic section: torso, head, legs (table 1)."""

    long_radius: float
    """Half width along the body's left-right axis."""
    short_radius: float
    """Half width along the body's front-back axis."""
    height: float

    def __post_init__(self) -> None:
        """ValueError for lengths that no body has."""
        _refuse_unless_positive(self)


class Round(msgspec.Struct, frozen=True, cache_hash=True, forbid_unknown_fields=True):
    """A cylinder of circular section: arms (table 1)."""

    radius: float
    height: float

    def __post_init__(self) -> None:
        """ValueError for lengths that no body has."""
        _refuse_unless_positive(self)


class Bdp(msgspec.Struct, frozen=True, cache_hash=True, forbid_unknown_fields=True, kw_only=True):
    """The body definition parameters: 6 x 3 + 4 x 2 = 26 lengths, all in one unit.

    Universal BDPs are in metres; what a viewer measures is in its own pixels until unified.

    Source: Huang & Chung 2004, table 1 (P5).
    """

    torso: Elliptic
    head: Elliptic
    r_upper_leg: Elliptic
    l_upper_leg: Elliptic
    r_lower_leg: Elliptic
    l_lower_leg: Elliptic
    r_upper_arm: Round
    l_upper_arm: Round
    r_lower_arm: Round
    l_lower_arm: Round

    def scaled(self, factor: float) -> "Bdp":
        """The same body with every length times `factor`."""
        return body_of_lengths([length * factor for length in self.lengths()])

    def lengths(self) -> list[float]:
        """The 26 numbers, in the order of the fields."""
        return [
            float(length)
            for part in msgspec.structs.astuple(self)
            for length in msgspec.structs.astuple(part)
        ]


LIMBS: Final = (
    "torso",
    "head",
    "r_upper_leg",
    "l_upper_leg",
    "r_lower_leg",
    "l_lower_leg",
    "r_upper_arm",
    "l_upper_arm",
    "r_lower_arm",
    "l_lower_arm",
)
"""The ten cylinders, in the order of Bdp's fields and of every array of limbs."""

JOINT_AXES: Final = {
    "torso": "xyz",
    "neck": "xyz",
    "r_shoulder": "xyz",
    "l_shoulder": "xyz",
    "r_elbow": "x",
    "l_elbow": "x",
    "r_hip": "xyz",
    "l_hip": "xyz",
    "r_knee": "x",
    "l_knee": "x",
}
"""The ten joints and the axes they turn about: six are spherical, four are hinges (P6). The
torso turns at the navel."""

POSITION_NAMES: Final = ("x", "y", "z")
"""Place of the navel in the world: the first three entries of a pose."""

DOF_NAMES: Final = tuple(f"{joint}_{axis}" for joint, axes in JOINT_AXES.items() for axis in axes)
"""The 22 angles of a pose, degrees (P7, M17)."""

POSE_NAMES: Final = POSITION_NAMES + DOF_NAMES
"""The 25 motion parameters (P22): a pose is a vector in this order, metres and degrees."""

POSE_INDEX: Final = {name: i for i, name in enumerate(POSE_NAMES)}

TORSO_X, TORSO_Y, TORSO_Z = (POSE_INDEX[f"torso_{axis}"] for axis in "xyz")
NECK: Final = POSE_INDEX["neck_x"]
SHOULDER, ELBOW, HIP, KNEE = (
    POSE_INDEX[f"r_{joint}_x"] for joint in ("shoulder", "elbow", "hip", "knee")
)
"""Index in a pose at which a joint's angles begin. For a limb it is the right one's; the left
one's follow. Compiled functions read these."""

FIXED_ANGLES: Final = ("torso_x", "torso_z", "neck_x", "neck_y", "neck_z")
"""The angles that the paper does not estimate: three of the head, two of the torso (P22)."""

ANGLE_NAMES: Final = tuple(name for name in DOF_NAMES if name not in FIXED_ANGLES)
"""The 17 angles that are estimated and published as BAPs (M17)."""

ANGLE_INDEX: Final = {name: i for i, name in enumerate(ANGLE_NAMES)}

ANGLES_IN_POSE: Final = tuple(POSE_INDEX[name] for name in ANGLE_NAMES)
"""Indices of the 17 angles in a pose."""

JOINT_NAMES: Final = (
    "pelvis",
    "neck",
    "head_top",
    "l_shoulder",
    "l_elbow",
    "l_wrist",
    "l_hip",
    "l_knee",
    "l_ankle",
    "r_shoulder",
    "r_elbow",
    "r_wrist",
    "r_hip",
    "r_knee",
    "r_ankle",
)
"""The 15 landmarks that are published, in the order of `joints_m`."""
OTHER_SIDE: Final = np.array(
    [
        JOINT_NAMES.index({"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:])
        for name in JOINT_NAMES
    ]
)
"""For each index in JOINT_NAMES, the index of the same joint on the other side."""

_BETWEEN: Final = {
    "upper_leg": ("hip", "knee"),
    "lower_leg": ("knee", "ankle"),
    "upper_arm": ("shoulder", "elbow"),
    "lower_arm": ("elbow", "wrist"),
}
LIMB_ENDS: Final = np.array(
    [
        [JOINT_NAMES.index("pelvis"), JOINT_NAMES.index("neck")],
        [JOINT_NAMES.index("neck"), JOINT_NAMES.index("head_top")],
        *(
            [JOINT_NAMES.index(f"{limb[0]}_{end}") for end in _BETWEEN[limb[2:]]]
            for limb in LIMBS[2:]
        ),
    ]
)
"""(10, 2): the landmarks at the near and the far end of each of LIMBS."""

LIMITS_DEG: Final[dict[str, tuple[float, float]]] = {
    "neck_z": (-45.0, 45.0),
    "torso_z": (-45.0, 45.0),
    "r_shoulder_x": (-180.0, 180.0),
    "l_shoulder_x": (-180.0, 180.0),
    "r_shoulder_z": (0.0, 180.0),
    "l_shoulder_z": (180.0, 360.0),
    "r_elbow_x": (-140.0, 140.0),
    "l_elbow_x": (-140.0, 140.0),
    "r_hip_x": (-60.0, 130.0),
    "l_hip_x": (-60.0, 130.0),
    "r_hip_z": (90.0, 210.0),
    "l_hip_z": (150.0, 270.0),
    "r_knee_x": (-150.0, 0.0),
    "l_knee_x": (-150.0, 0.0),
}
"""Limits of the joint angles, degrees (P30, P35; neck and waist: T6 by C7). The thesis's
150..210 for hips would forbid the paper's own side kick, so the hips are wider here."""

REST_DEG: Final[dict[str, float]] = {
    "r_shoulder_z": 180.0,
    "l_shoulder_z": 180.0,
    "r_shoulder_y": 90.0,
    "l_shoulder_y": -90.0,
    "r_hip_z": 180.0,
    "l_hip_z": 180.0,
}
"""The angles of a body that stands with hanging arms, where they are not zero (C3). The sign of
theta_Y makes positive elbow flexion point outwards and up (C5)."""

YAW_DEG: Final = (0.0, -90.0)
"""Yaw of the trunk while camera 1, or camera 2, sees the facade (P49): the person faces that
camera. Silhouettes cannot tell this from its opposite (limitation L4)."""


def rest_pose() -> Vector:
    """A pose of a body that stands at the origin and faces +z, arms hanging, shape (25,)."""
    pose = np.zeros(len(POSE_NAMES))
    for name, angle_deg in REST_DEG.items():
        pose[POSE_INDEX[name]] = angle_deg
    return pose


def wrapped_deg(angle_deg: float) -> float:
    """The same angle in (-180, 180]."""
    turned = math.remainder(angle_deg, 360.0)
    return 180.0 if turned == -180.0 else turned


def body_of_lengths(lengths: list[float]) -> Bdp:
    """The body with the 26 numbers of `Bdp.lengths`."""
    parts: dict[str, Elliptic | Round] = {}
    at = 0
    for name in LIMBS:
        if name.endswith("arm"):
            parts[name] = Round(*lengths[at : at + 2])
            at += 2
        else:
            parts[name] = Elliptic(*lengths[at : at + 3])
            at += 3
    return msgspec.convert(parts, Bdp, from_attributes=True)


def _refuse_unless_positive(part: Elliptic | Round) -> None:
    lengths = msgspec.structs.astuple(part)
    if min(lengths) > 0 and math.isfinite(sum(lengths)):  # a NaN makes the sum one
        return
    for name, length in zip(part.__struct_fields__, lengths, strict=True):
        if not (math.isfinite(length) and length > 0):
            raise ValueError(f"{name} must be a positive length, got {length}")


TILTED_DEG: Final = 30.0
"""A trunk that leans by less counts as upright, degrees. Nearly all people in the pictures that
the facing network was trained on lean by less."""


def lean_deg(right: float, down: float) -> float:
    """Lean of a trunk in the picture, degrees clockwise; 0 below TILTED_DEG or without a trunk.

    Args:
        right: From the pelvis to the neck, along the rows of the picture.
        down: From the pelvis to the neck, along its columns.
    """
    found = math.degrees(math.atan2(right, -down))
    return found if abs(found) > TILTED_DEG and math.hypot(right, down) > 0.0 else 0.0
