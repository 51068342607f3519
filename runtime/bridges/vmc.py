"""A body as VMC (Virtual Motion Capture): turns of Unity's humanoid bones, one bundle per body;
postures as blend values.

Source: the VMC protocol specification, version 2.x: addresses of a Performer. Unity's axes are
left-handed, +x right of a person who faces +z, +y up, so x changes its sign.
"""

from typing import Any, Final, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from animator.skeleton.bone_turns import turned_axes
from animator.skeleton.bones import Skeleton, offset_m, skeleton_of
from animator.skeleton.limb_twist import Before
from common.body.body import JOINT_NAMES, Vector
from common.bus.messages import Body, Posture
from runtime.bridges.osc import message

UNITY: Final = {
    f"{side}{ours}": f"{side}{unity}"
    for side in ("Left", "Right")
    for ours, unity in (
        ("Arm", "UpperArm"),
        ("ForeArm", "LowerArm"),
        ("UpLeg", "UpperLeg"),
        ("Leg", "LowerLeg"),
    )
}
"""Unity's names of BONES that differ from ours."""
PELVIS: Final = JOINT_NAMES.index("pelvis")
MEASURED: Final = 30
"""Number of poses whose median lengths make the skeleton; before, all poses so far."""
TYPES: Final = "sfffffff"


class Measured(NamedTuple):
    """The skeleton so far, and its last twists."""

    poses: tuple[Any, ...] = ()
    """(15, 3) or, with hands and feet, (22, 3) each, at most MEASURED."""
    skeleton: Skeleton | None = None
    before: Before | None = None
    """Twists of the limbs in the body before, which straight limbs keep."""
    person: int = 0
    """The number of the person whose skeleton it is."""


def step(state: Measured, body: Body) -> tuple[Measured, bytes | None]:
    """The packet of a body; None where it has no pose. Another person has a skeleton anew."""
    if not body.joints_m:
        return state, None
    if body.person != state.person:
        state = Measured(person=body.person)
    joints_m = np.array((*body.joints_m, *body.extremities_m))
    if state.skeleton is None or len(state.poses) < MEASURED:
        poses = (*state.poses, joints_m)
        state = state._replace(poses=poses, skeleton=skeleton_of(np.array(poses)))
    assert state.skeleton is not None
    time_s = np.array([body.captured_s])
    axes, twists = turned_axes(state.skeleton, joints_m[None], time_s, state.before)
    packet = _packet(body, state.skeleton, joints_m[PELVIS], axes[:, 0])
    return state._replace(before=Before(twists[:, 0], body.captured_s)), packet


def posture_packet(posture: Posture) -> bytes:
    """A blend value of each posture that the model knows: 1 while it is in progress, else 0."""
    from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder

    bundle: Any = OscBundleBuilder(IMMEDIATELY)
    for name in sorted({*posture.log_likelihoods, posture.doing} - {""}):
        value = [name, float(name == posture.doing)]
        bundle.add_content(message("/VMC/Ext/Blend/Val", value, "sf"))
    bundle.add_content(message("/VMC/Ext/Blend/Apply", [], ""))
    packet: bytes = bundle.build().dgram
    return packet


def _packet(body: Body, skeleton: Skeleton, pelvis_m: Vector, axes: Any) -> bytes:
    """The bundle of a pose with these turns of its bones, (bones, 3, 3)."""
    from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder

    turns = Rotation.from_matrix(axes, assume_valid=True).as_quat().tolist()
    bundle: Any = OscBundleBuilder(IMMEDIATELY)
    bundle.add_content(message("/VMC/Ext/OK", [1], "i"))
    bundle.add_content(message("/VMC/Ext/T", [body.captured_s], "f"))
    root = ["root", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    bundle.add_content(message("/VMC/Ext/Root/Pos", root, TYPES))
    for i, (bone, (x, y, z, w)) in enumerate(zip(skeleton.bones, turns, strict=True)):
        place_m = pelvis_m if i == 0 else offset_m(skeleton, i)
        told = [UNITY.get(bone.name, bone.name), *_mirrored(place_m), x, -y, -z, w]
        bundle.add_content(message("/VMC/Ext/Bone/Pos", told, TYPES))
    packet: bytes = bundle.build().dgram
    return packet


def _mirrored(place_m: Vector) -> list[float]:
    x, y, z = place_m.tolist()
    return [-x, y, z]
