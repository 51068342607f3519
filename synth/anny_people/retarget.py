"""Poses of our skeleton on Anny bodies: limbs point in the same directions."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Vector
from synth.anny_people.anatomy import anatomy
from synth.anny_people.figures import Figure
from synth.anny_people.part_turns import Turns, about, between, hanging, raised_deg
from synth.person.skeleton import ANGLES, BONE_INDEX, CLAVICLE_LIFT, bone_frames, turned

SPINE: Final = {"spine05": 0.15, "spine04": 0.5, "spine03": 0.8, "spine02": 1.0, "spine01": 1.0}
"""Share of the turn from pelvis to chest for each bone of the spine."""
NECK: Final = {"neck01": 0.3, "neck02": 0.55, "neck03": 0.8, "head": 1.0}
"""Share of the turn from chest to head at each bone of the neck."""
TWIST: Final = 0.4
"""Share of a limb's twist in its upper half."""
TWISTS: Final = np.array([name.endswith("twist") for name in ANGLES])
FOREARM: Final = {"lowerarm01": 0.15, "lowerarm02": 0.55, "wrist": 1.0}
"""Share of a hand's turn in each bone of the forearm."""
PRONATED_DEG: Final = 30.0
"""Standard deviation of that turn from a palm that faces the body."""
CURLED_DEG: Final = (3.0, 55.0)
"""Bend of each finger joint."""
BEGINS: Final = {
    "shoulder": "upperarm01",
    "elbow": "lowerarm01",
    "wrist": "wrist",
    "hip": "upperleg01",
    "knee": "lowerleg01",
    "ankle": "foot",
}
"""The bone that begins at each joint."""


class Retargeted(NamedTuple):
    """A body in several poses, its pelvis at the origin."""

    turns: NDArray[np.float64]
    """(n, bones, 3, 3) from rest to the world."""
    places_m: NDArray[np.float64]
    """(n, bones, 3) starts of the bones."""
    joints_m: NDArray[np.float64]
    """(n, 15, 3) JOINT_NAMES order."""
    front: NDArray[np.float64]
    """(n, 3) direction of the chest."""


def retargeted(
    figure: Figure,
    measures: dict[str, float],
    angles_deg: NDArray[np.float64],
    rng: np.random.Generator,
) -> Retargeted:
    """A body in poses of our own people.

    Args:
        figure: The body.
        measures: Measures of one of our own people; only turns depend on them, no length.
        angles_deg: (n, 27) in the order of ANGLES.
        rng: Source of the hands' poses.
    """
    known = anatomy()
    frames = _frames(measures, angles_deg)
    own = _turns(figure, frames, _frames(measures, np.where(TWISTS, TWIST, 1.0) * angles_deg), rng)
    turns = np.empty((len(angles_deg), len(known.bones), 3, 3))
    places = np.zeros((len(angles_deg), len(known.bones), 3))
    for i, (name, above) in enumerate(zip(known.bones, known.parents, strict=True)):
        turns[:, i] = own.get(name, turns[:, above])
        if above >= 0:
            offset = figure.heads_m[name] - figure.heads_m[known.bones[above]]
            places[:, i] = places[:, above] + turns[:, above] @ offset
    front = frames[:, BONE_INDEX["chest"], :, 2]
    return Retargeted(turns, places, _joints(figure, turns, places), front)


def hung(
    vertices_m: NDArray[np.float64],
    weights: NDArray[np.float64],
    figure: Figure,
    body: Retargeted,
) -> NDArray[np.float64]:
    """Places of vertices in each pose, (n, v, 3).

    Args:
        vertices_m: (v, 3) at rest.
        weights: (v, bones) skinning weights.
        figure: At rest.
        body: Posed.
    """
    heads = np.stack([figure.heads_m[name] for name in anatomy().bones])
    offsets = body.places_m - np.einsum("nbij,bj->nbi", body.turns, heads)
    frames = np.concatenate([body.turns, offsets[..., None]], axis=3).transpose(3, 1, 0, 2)
    spread = [weights, *(weights * vertices_m[:, [k]] for k in range(3))]
    moved = np.hstack([each.astype(np.float32) for each in spread]) @ np.concatenate(
        [frames[k].reshape(len(heads), -1) for k in (3, 0, 1, 2)]
    ).astype(np.float32)
    placed = moved.reshape(len(vertices_m), len(body.turns), 3).transpose(1, 0, 2)
    return np.ascontiguousarray(placed, np.float64)


def _frames(measures: dict[str, float], angles_deg: NDArray[np.float64]) -> Turns:
    """Turns of our own bones, (n, bones, 3, 3)."""
    named = {name: angles_deg[:, i] for i, name in enumerate(ANGLES)}
    return bone_frames(measures, named)[..., :3]


def _turns(
    figure: Figure, frames: Turns, half: Turns, rng: np.random.Generator
) -> dict[str, Turns]:
    """From rest to the world, (n, 3, 3), for all bones that do not just follow their parent.

    `half`: turns of our own bones in which each limb has the twist of its upper half.
    """
    pelvis, chest, head = (frames[:, BONE_INDEX[name]] for name in ("pelvis", "chest", "head"))
    found = {"root": pelvis}
    found |= {name: between(pelvis, chest, share) for name, share in SPINE.items()}
    found |= {name: between(chest, head, share) for name, share in NECK.items()}
    for side in "LR":
        found |= _arm(figure, side, frames, half, rng) | _leg(figure, side, frames, half)
    return found


def _arm(
    figure: Figure, side: str, frames: Turns, half: Turns, rng: np.random.Generator
) -> dict[str, Turns]:
    at = _side(figure, side)
    sign, own = (1.0, "l") if side == "L" else (-1.0, "r")
    chest, bone = frames[:, BONE_INDEX["chest"]], BONE_INDEX[f"{own}_upper_arm"]
    upper, fore = at["lowerarm01"] - at["upperarm01"], at["wrist"] - at["lowerarm01"]
    hinge = np.cross(fore, upper)
    level, straight = hanging(upper, hinge), hanging(fore, hinge)
    raised = raised_deg(np.swapaxes(chest, 1, 2) @ frames[:, bone])
    lift = CLAVICLE_LIFT * (raised - float(raised_deg(level.T[None])[0]))
    found = {"clavicle": chest @ turned("z", sign * lift)}
    found |= {"upperarm01": half[:, bone] @ level, "upperarm02": frames[:, bone] @ level}
    across = straight @ (at["finger2-1"] - at["finger5-1"])
    pronated = rng.normal(-np.degrees(np.arctan2(across[0], across[2])), PRONATED_DEG, len(chest))
    forearm = frames[:, BONE_INDEX[f"{own}_forearm"]]
    for name, share in FOREARM.items():
        found[name] = forearm @ turned("y", share * pronated) @ straight
    found |= _fingers(at, found["wrist"], sign * rng.uniform(*CURLED_DEG, len(chest)))
    return {f"{name}.{side}": turns for name, turns in found.items()}


def _fingers(at: dict[str, Vector], hand: Turns, bent_deg: Vector) -> dict[str, Turns]:
    """All four fingers curl towards the palm, each joint by the same angle; mirrored on the
    right."""
    along = at["finger3-3"] - at["wrist"]
    axis = np.cross(along, np.cross(at["finger5-1"] - at["finger2-1"], along))
    joints = (1, 2, 3)
    curls = {joint: hand @ about(axis, joint * bent_deg) for joint in joints}
    return {f"finger{finger}-{joint}": curls[joint] for finger in range(2, 6) for joint in joints}


def _leg(figure: Figure, side: str, frames: Turns, half: Turns) -> dict[str, Turns]:
    at, own = _side(figure, side), side.lower()
    x = np.array([1.0, 0.0, 0.0])
    thigh = hanging(at["lowerleg01"] - at["upperleg01"], x)
    shank = frames[:, BONE_INDEX[f"{own}_shank"]] @ hanging(at["foot"] - at["lowerleg01"], x)
    toes = at["toe3-1"] - at["foot"]
    ahead = turned("y", -np.degrees(np.arctan2(toes[[0]], toes[[2]])))[0]
    bone = BONE_INDEX[f"{own}_thigh"]
    return {
        f"upperleg01.{side}": half[:, bone] @ thigh,
        f"upperleg02.{side}": frames[:, bone] @ thigh,
        f"lowerleg01.{side}": shank,
        f"foot.{side}": frames[:, BONE_INDEX[f"{own}_foot"]] @ ahead,
    }


def _side(figure: Figure, side: str) -> dict[str, Vector]:
    """Starts of one side's bones, by their names without the side."""
    return {name[:-2]: at for name, at in figure.heads_m.items() if name.endswith(f".{side}")}


def _joints(figure: Figure, turns: Turns, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, 15, 3) in the order of JOINT_NAMES."""
    bones = anatomy().bones
    at = {name: places[:, i] for i, name in enumerate(bones)}
    crown = figure.crown_m() - figure.heads_m["head"]
    found = {
        "pelvis": (at["upperleg01.L"] + at["upperleg01.R"]) / 2,
        "neck": at["neck01"],
        "head_top": at["head"] + turns[:, bones.index("head")] @ crown,
    }
    for name in JOINT_NAMES:
        if name not in found:
            found[name] = at[f"{BEGINS[name[2:]]}.{name[0].upper()}"]
    return np.stack([found[name] for name in JOINT_NAMES], axis=1)
