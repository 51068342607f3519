"""What else has the same outline: the body seen from behind, a limb that leans the other way."""

from collections.abc import Mapping
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS, OTHER_SIDE
from common.notes.notes import ORIENTATIONS, Orientation
from common.rig.camera import Camera, arrays_of, centre
from integrator.landmarks.turned_about import facing_deg

Joints = NDArray[np.float64]
SIDEWAYS_DEG: Final = 20.0
"""Somebody who is turned so near to a right angle is seen from the side."""
SHOWN_ASIDE_DEG: Final = 40.0
"""So near to it landmarks hardly tell front from back. With 20 degrees, made-up people in free
motion err by 3 % less, but who runs and walks across by 4 % more."""
INSISTS_S: Final = 3.0
"""Proposals that differ for so long from what is remembered of front and back are believed."""
NEARLY_DEG: Final = 40.0
"""How far a proposal may face beside the sector that the user named."""
PELVIS: Final = JOINT_NAMES.index("pelvis")
_HANGS: Final = [
    [int(LIMB_ENDS[part, 1]) for part in ((limb, limb + 2) if limb in (2, 3, 6, 7) else (limb,))]
    for limb in range(len(LIMBS))
]
"""The joints that move with the far end of each of LIMBS: a lower limb follows its upper one."""


class Front(NamedTuple):
    """What is remembered of front and back, which one outline hardly tells (L4)."""

    away: bool = False
    """Whether the person faces away from the camera: filmed people mostly do not at first."""
    aside: bool = False
    """Whether the person was seen from the side just before."""
    doubted_s: float = 0.0
    """For how long proposals have said otherwise."""
    first: bool = True
    """Nobody was seen before."""


def yaw_deg(camera: Camera, joints_m: Joints) -> float:
    """Which way the lines across shoulders and hips face: 0 the camera, 90 the picture's right."""
    at = {name: joints_m[i] for i, name in enumerate(JOINT_NAMES)}
    across = at["l_shoulder"] - at["r_shoulder"] + at["l_hip"] - at["r_hip"]
    return facing_deg(arrays_of(camera).R, across)


def faces(yaw: float) -> Orientation:
    """Which of the six ways that is (T22)."""
    side: Literal["left", "right"] = "right" if yaw >= 0 else "left"
    if _is_aside(yaw):
        return side
    return ORIENTATIONS[ORIENTATIONS.index(side) + (4 if abs(yaw) < 90.0 else 2)]


def front_of(
    before: Front, yaw: float, shown_deg: float | None, named: Orientation | None, dt_s: float
) -> tuple[Front, bool]:
    """What is remembered now, and whether a proposal is to be seen from behind for it.

    People turn from front to back through their side, where the outline is theirs alone: after
    that a picture that surely shows it is believed, else a proposal; elsewhere it goes on as it
    was. How it began tells the first picture, if that is sure, and while pictures say that it
    goes on so, proposals do not insist.

    Args:
        before: At the frame before.
        yaw: Of the proposal, degrees.
        shown_deg: Where the picture surely shows the person to face; None: it does not.
        named: The user's word, which settles it.
        dt_s: Time since then.
    """
    away, seen_away = abs(yaw) > 90.0, None
    if shown_deg is not None and not _is_aside(shown_deg, SHOWN_ASIDE_DEG):
        seen_away = abs(shown_deg) > 90.0
    if named is not None and named not in ("left", "right"):
        due = named.startswith("backward")
        return Front(due, first=False), due != away
    if named is not None or _is_aside(yaw):
        return Front(before.away, aside=True, first=False), False
    if seen_away is not None and (before.aside or before.first):
        before = Front(seen_away)
    doubted_s = 0.0 if seen_away == before.away else before.doubted_s + dt_s
    if before.aside or away == before.away or doubted_s > INSISTS_S:
        return Front(away, first=False), False
    return Front(before.away, doubted_s=doubted_s, first=False), True


def _is_aside(yaw: float, wide_deg: float = SIDEWAYS_DEG) -> bool:
    return abs(abs(yaw) - 90.0) <= wide_deg


def agrees(yaw: float, named: Orientation) -> bool:
    """Whether somebody who is turned so can be who the user says faces that way."""
    middle = {"forward": 35.0, "left": 90.0, "right": 90.0, "backward": 145.0}
    wide = SIDEWAYS_DEG if named in ("left", "right") else 35.0
    side = 1.0 if named.endswith("right") else -1.0
    off = (yaw - side * middle[named.split("_")[0]] + 180.0) % 360.0 - 180.0
    return abs(off) <= wide + NEARLY_DEG


def seen_from_behind(camera: Camera, joints_m: Joints) -> Joints:
    """The body with the same outline that faces the other way, front for back.

    Each joint stays on its ray, as far before the pelvis as it was behind it, and sides change.
    """
    depth = _depths(camera, joints_m)
    return _at_depths(camera, joints_m, 2 * depth[PELVIS] - depth)[OTHER_SIDE]


def leaning(camera: Camera, joints_m: Joints, depth: Mapping[str, str]) -> Joints:
    """The body whose segments lean as annotated, toward the camera or away, none by more than
    before.

    Args:
        camera: The view's.
        joints_m: (15, 3) world.
        depth: Names of LIMBS to toward or away (T21).
    """
    depths_m = _depths(camera, joints_m)
    for limb, name in enumerate(LIMBS):
        near, far = LIMB_ENDS[limb]
        farther = depths_m[far] - depths_m[near]
        if name in depth and (farther > 0) == (depth[name] == "toward"):
            depths_m[_HANGS[limb]] -= 2 * farther
    return _at_depths(camera, joints_m, depths_m)


def mirrored(camera: Camera, joints_m: Joints, limb: int) -> Joints:
    """The body one of whose LIMBS leans as far the other way."""
    depths_m = _depths(camera, joints_m)
    near, far = LIMB_ENDS[limb]
    depths_m[_HANGS[limb]] -= 2 * (depths_m[far] - depths_m[near])
    return _at_depths(camera, joints_m, depths_m)


def as_deep(camera: Camera, joints_m: Joints, other_m: Joints) -> Joints:
    """The joints where the picture has them, as far away as another body's are."""
    return _at_depths(camera, joints_m, _depths(camera, other_m))


def _depths(camera: Camera, joints_m: Joints) -> Joints:
    found: Joints = (joints_m - centre(camera)) @ arrays_of(camera).R[2]
    return found


def _at_depths(camera: Camera, joints_m: Joints, depths_m: Joints) -> Joints:
    """The joints moved along their rays."""
    eye = centre(camera)
    found: Joints = eye + (joints_m - eye) * (depths_m / _depths(camera, joints_m))[:, None]
    return found
