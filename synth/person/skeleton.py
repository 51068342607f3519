"""The performers' skeleton: from joint angles and a body's measures to joints and bones."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector

JOINTS: Final = (
    "pelvis",
    "navel",
    "neck",
    "head_top",
    *(
        f"{side}_{name}"
        for side in "lr"
        for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle", "knuckle", "toe")
    ),
)
"""The 20 joints of `truth.npz`."""

ANGLES: Final = (
    *(f"torso_{name}" for name in ("pitch", "roll", "yaw")),
    *(f"head_{name}" for name in ("pitch", "yaw", "roll")),
    *(f"{side}_{name}" for side in "lr" for name in ("sh_abd", "sh_flex", "sh_twist", "elbow")),
    *(
        f"{side}_{name}"
        for side in "lr"
        for name in ("hip_abd", "hip_flex", "hip_twist", "knee", "foot")
    ),
    *(f"root_{name}" for name in ("pitch", "roll", "yaw")),
)
"""The 27 numbers of a pose, degrees; `foot` is 0 for a level sole, 1 for a hanging foot."""

BONES: Final = (
    "pelvis",
    "chest",
    "head",
    *(
        f"{side}_{name}"
        for side in "lr"
        for name in ("upper_arm", "forearm", "hand", "thigh", "shank", "foot")
    ),
)
"""The bones that vertices follow; a bone's frame is at its upper joint, all parallel at rest."""

BONE_INDEX: Final = {name: i for i, name in enumerate(BONES)}

NAVEL_UP, NAVEL_BACK = 0.165, 0.035
"""Place of the navel above the pelvis, as shares of the trunk: the spine curves."""
SHOULDER_SHARE, SHOULDER_DROP_SHARE = 0.473, 0.2
"""Place of a hanging shoulder: this share of the shoulders' width beside the middle, and this
share of the trunk below the neck. In a T pose the clavicles raise it and the shoulders are
wider."""
HEAD_FORWARD: Final = 0.16
"""Forward place of the crown, as a share of the way from neck to crown."""
CLAVICLE_LIFT: Final = 0.2
"""Rise of a shoulder about the neck, degrees per degree of the arm's elevation."""
KNUCKLE_SHARE: Final = 0.55
"""Place of the knuckles between wrist and fingertip."""
FOOT_SHARE, HEEL_SHARE, BALL_SHARE = 0.152, 0.24, 0.62
"""Length of the shoe over the stature; its share behind the ankle; place of the ball."""
HANGING_FOOT_DEG: Final = 22.0
"""Downward angle of a foot in the air."""
ANKLE_DEG: Final = (-42.0, 50.0)
"""Range of the ankle when it levels a sole: toes up, toes down."""


def shoe_length(measures: dict[str, float]) -> float:
    """From heel to toe, metres."""
    return FOOT_SHARE * measures["stature_m"]


def rest_origins(measures: dict[str, float]) -> dict[str, Vector]:
    """Start of each bone in a body that stands at the origin with hanging arms, metres."""
    m = measures
    hip_y = m["thigh_m"] + m["shin_m"] + m["ankle_height_m"]
    navel = np.array([0.0, hip_y + NAVEL_UP * m["torso_m"], -NAVEL_BACK * m["torso_m"]])
    neck = np.array([0.0, hip_y + m["torso_m"], 0.0])
    found = {"pelvis": np.array([0.0, hip_y, 0.0]), "chest": navel, "head": neck}
    down = np.array([0.0, -1.0, 0.0])
    for side, sign in (("l", 1.0), ("r", -1.0)):
        half = sign * SHOULDER_SHARE * m["shoulder_width_m"]
        shoulder = neck + np.array([half, -SHOULDER_DROP_SHARE * m["torso_m"], 0.0])
        found[f"{side}_upper_arm"] = shoulder
        found[f"{side}_forearm"] = shoulder + down * m["upper_arm_m"]
        found[f"{side}_hand"] = found[f"{side}_forearm"] + down * m["forearm_m"]
        hip = np.array([sign * m["hip_width_m"] / 2, hip_y, 0.0])
        found[f"{side}_thigh"] = hip
        found[f"{side}_shank"] = hip + down * m["thigh_m"]
        found[f"{side}_foot"] = hip + down * (m["thigh_m"] + m["shin_m"])
    return found


def bone_frames(measures: dict[str, float], angle: dict[str, Vector]) -> NDArray[np.float64]:
    """Frames of all bones with the pelvis at the origin, (n, bones, 3, 4)."""
    rest = rest_origins(measures)
    bones = np.zeros((len(angle["root_yaw"]), len(BONES), 3, 4))

    def put(name: str, parent: str, turn: NDArray[np.float64]) -> None:
        above = bones[:, BONE_INDEX[parent]]
        bones[:, BONE_INDEX[name], :, :3] = above[..., :3] @ turn
        offset = rest[name] - rest[parent]
        bones[:, BONE_INDEX[name], :, 3] = above[..., :3] @ offset + above[..., 3]

    root = turned("y", angle["root_yaw"]) @ turned("x", angle["root_pitch"])
    bones[:, 0, :, :3] = root @ turned("z", angle["root_roll"])
    put("chest", "pelvis", _trunk_turn(angle, "torso"))
    put("head", "chest", _trunk_turn(angle, "head"))
    for side, sign in (("l", 1.0), ("r", -1.0)):
        upper = _limb_turn(angle, f"{side}_sh", sign)
        put(f"{side}_upper_arm", "chest", upper)
        chest, shoulder = bones[:, BONE_INDEX["chest"]], BONE_INDEX[f"{side}_upper_arm"]
        bones[:, shoulder, :, 3] = _lifted_shoulder(chest, rest, side, upper)
        put(f"{side}_forearm", f"{side}_upper_arm", turned("x", -angle[f"{side}_elbow"]))
        put(f"{side}_hand", f"{side}_forearm", np.eye(3)[None])
        put(f"{side}_thigh", "pelvis", _limb_turn(angle, f"{side}_hip", sign))
        put(f"{side}_shank", f"{side}_thigh", turned("x", angle[f"{side}_knee"]))
        shank = bones[:, BONE_INDEX[f"{side}_shank"], :, :3]
        put(f"{side}_foot", f"{side}_shank", _foot_turn(shank, angle[f"{side}_foot"]))
    return bones


def _lifted_shoulder(
    chest: NDArray[np.float64], rest: dict[str, Vector], side: str, upper: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Place of a shoulder, (n, 3), raised on its clavicle: its distance from the neck is
    constant."""
    sign = 1.0 if side == "l" else -1.0
    raised_deg = np.degrees(np.arccos(np.clip(upper[:, 1, 1], -1.0, 1.0)))
    swung = turned("z", sign * CLAVICLE_LIFT * raised_deg) @ (
        rest[f"{side}_upper_arm"] - rest["head"]
    )
    offset = swung + rest["head"] - rest["chest"]
    return np.asarray(np.einsum("nij,nj->ni", chest[..., :3], offset) + chest[..., 3])


def _foot_turn(shank: NDArray[np.float64], hanging: Vector) -> NDArray[np.float64]:
    """The ankle: it levels the sole where `hanging` is 0, and lets the toes point down where it
    is 1."""
    pitch = np.degrees(np.arctan2(shank[:, 1, 2], shank[:, 1, 1]))
    half = shank @ turned("x", pitch)
    roll = -np.degrees(np.arctan2(half[:, 1, 0], half[:, 1, 1]))
    reach = np.clip(pitch, *ANKLE_DEG) * (1.0 - hanging) + HANGING_FOOT_DEG * hanging
    return turned("x", reach) @ turned("z", np.clip(roll, -35.0, 35.0) * (1.0 - hanging))


def joint_places(measures: dict[str, float], bones: NDArray[np.float64]) -> NDArray[np.float64]:
    """The joints (n, 20, 3) of bones (n, bones, 3, 4)."""
    m = measures
    head = m["neck_to_headtop_m"] * np.array([0.0, (1 - HEAD_FORWARD**2) ** 0.5, HEAD_FORWARD])
    places = {
        "pelvis": bones[:, 0, :, 3],
        "navel": bones[:, 1, :, 3],
        "neck": bones[:, 2, :, 3],
        "head_top": _point(bones, "head", head),
    }
    toe = np.array([0.0, -0.55 * m["ankle_height_m"], 0.68 * shoe_length(m)])
    starts = ("shoulder", "upper_arm"), ("elbow", "forearm"), ("wrist", "hand")
    starts_leg = ("hip", "thigh"), ("knee", "shank"), ("ankle", "foot")
    for side in "lr":
        for name, bone in (*starts, *starts_leg):
            places[f"{side}_{name}"] = bones[:, BONE_INDEX[f"{side}_{bone}"], :, 3]
        knuckle = np.array([0.0, -KNUCKLE_SHARE * m["hand_m"], 0.0])
        places[f"{side}_knuckle"] = _point(bones, f"{side}_hand", knuckle)
        places[f"{side}_toe"] = _point(bones, f"{side}_foot", toe)
    return np.stack([places[name] for name in JOINTS], axis=1)


def _point(bones: NDArray[np.float64], bone: str, local: Vector) -> Vector:
    frame = bones[:, BONE_INDEX[bone]]
    place: Vector = frame[..., :3] @ local + frame[..., 3]
    return place


def _trunk_turn(angle: dict[str, Vector], part: str) -> NDArray[np.float64]:
    pitched = turned("y", angle[f"{part}_yaw"]) @ turned("x", angle[f"{part}_pitch"])
    return pitched @ turned("z", angle[f"{part}_roll"])


def _limb_turn(angle: dict[str, Vector], joint: str, sign: float) -> NDArray[np.float64]:
    """Twist about the limb, then abduction, then flexion about the body's lateral axis."""
    lifted = turned("x", -angle[f"{joint}_flex"]) @ turned("z", sign * angle[f"{joint}_abd"])
    return lifted @ turned("y", sign * angle[f"{joint}_twist"])


def turned(axis: str, angle_deg: Vector) -> NDArray[np.float64]:
    """Right-handed rotations about x, y or z, (n, 3, 3)."""
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    angle = np.radians(angle_deg)
    matrix = np.zeros((len(angle), 3, 3))
    matrix[:, 3 - i - j, 3 - i - j] = 1.0
    matrix[:, i, i] = matrix[:, j, j] = np.cos(angle)
    matrix[:, j, i] = np.sin(angle)
    matrix[:, i, j] = -np.sin(angle)
    return matrix
