"""The body proposed from a single silhouette. Where faces, bends or landmarks contradict it,
another body with the same silhouette takes its place."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMB_ENDS, Vector
from common.body.observation import Observation
from common.body.stick_body import SHOULDERS_BELOW
from common.bus.messages import Lifting
from common.rig.camera import Camera, centre, ray
from integrator.landmarks import joint_marks, landmark_fusion
from integrator.landmarks.landmark_rays import rays_of
from integrator.proposal import pose_network, pose_proposal
from integrator.proposal.pose_proposal import HEAD, NECK, PELVIS
from integrator.rig.undistortion import undistorted_rig
from integrator.single import bent_limbs, calm_depth, reflection
from integrator.single.reflection import Front
from integrator.single.sight import Hypothesis, Sight, posed
from integrator.single.stick_similarity import stick_similarity

CROWN: Final = 0.155
"""Height of the crown above the neck, statures: 0.15 to 0.17 for two performers and synthetic
people whose arms are not raised (docs/measurements.md)."""

BESIDE: Final = 1 / 3
"""Exponent for a joint's confidence: raised to it, the confidence of its place in space becomes
that of its place in the picture. Chosen on two performers (docs/measurements.md)."""


class Proposed(NamedTuple):
    """A proposal from one silhouette, and its memory."""

    found: Hypothesis
    agrees: bool
    """It faces the side that the user named, if any."""
    memory: pose_proposal.Memory
    front: Front | None
    landmarks: landmark_fusion.Memory | None
    depth: calm_depth.Memory
    lifted_m: Vector | None
    """(3,) the middle of the hips by the landmarks alone."""


class Before(NamedTuple):
    """Memory of the instant before."""

    memory: pose_proposal.Memory | None
    """The network's; None at the first."""
    front: Front | None
    """Of front and back; None: the network remembers it."""
    landmarks: landmark_fusion.Memory | None
    depth: calm_depth.Memory | None
    """Of the joints' distances; None at the first."""


def step(before: Before, sight: Sight) -> Proposed:
    """One instant of one view: the silhouette's proposal, fused with what the picture shows.

    The facing of a person who leans far or lies is not tested: front and back differ there from a
    standing person's.

    Args:
        before: The memory.
        sight: The view.
    """
    front = before.front
    camera, annotations = sight.camera, sight.annotations
    rig = undistorted_rig(sight.rig)
    up = pose_proposal.up_of(sight.bdp, sight.before)
    known = pose_proposal.step(
        before.memory,
        sight.bdp,
        rig,
        sight.seen,
        sight.dt_s,
        up,
        sight.method.lifting,
        at_once=sight.on_floor,
    )
    joints_m = _with_trunk(sight, known.joints_m)
    if sight.method.reflection and front is not None and up is None:
        yaw = reflection.yaw_deg(camera, joints_m)
        shown, named = _shown(sight.person), annotations.orientation
        front, behind = reflection.front_of(front, yaw, shown, named, sight.dt_s)
        joints_m = reflection.seen_from_behind(camera, joints_m) if behind else joints_m
        joints_m = joints_m if named else reflection.as_shown(camera, joints_m, shown)
    joints_m, confidence, landmarks = _with_landmarks(before, sight, joints_m, known.confidence)
    depth, joints_m = calm_depth.step(before.depth, centre(camera), joints_m, sight.dt_s)
    joints_m = bent_limbs.bent(sight, joints_m)
    joints_m = reflection.leaning(camera, joints_m, annotations.depth)
    for name, place in annotations.joints_px.items():
        at = JOINT_NAMES.index(name)
        joints_m[at] = _at_depth(camera, place, joints_m[at])
    yaw = reflection.yaw_deg(camera, joints_m)
    agrees = annotations.orientation is None or reflection.agrees(yaw, annotations.orientation)
    pose, limited_m = posed(sight, joints_m)
    joints_m = reflection.as_deep(camera, joints_m, limited_m)
    lifting = Lifting(
        annotations.orientation or reflection.faces(reflection.yaw_deg(camera, joints_m)),
        1.0 if annotations.orientation else float(confidence[PELVIS]),
        tuple(confidence[LIMB_ENDS[:, 1]].tolist()),
    )
    score = stick_similarity(sight, joints_m)
    found = Hypothesis(joints_m, pose, score, confidence, lifting)
    return Proposed(found, agrees, known.memory, front, landmarks, depth, known.lifted_m)


def _shown(person: Observation) -> tuple[float, float] | None:
    """Facing of a whole person by landmarks, and its confidence; None where they show none."""
    shown = person.landmarks
    return None if shown is None or person.cut else (shown.facing_deg, shown.facing_confidence)


def _with_landmarks(
    before: Before, sight: Sight, joints_m: NDArray[np.float64], confidence: Vector
) -> tuple[NDArray[np.float64], Vector, landmark_fusion.Memory | None]:
    """Joints (15, 3) and their confidence, fused with what the picture shows.

    The picture does not show their depth, which is the main error of one silhouette.
    """
    rays = rays_of(undistorted_rig(sight.rig), sight.seen)
    if rays is None:
        return joints_m, confidence, before.landmarks
    if before.front is not None:  # the facing was taken into account already
        rays = rays._replace(facing_confidence=(0.0, 0.0))
    at = pose_proposal.AT
    beside = confidence[at] ** BESIDE
    proposed_m, rays = joint_marks.centred(before.landmarks, joints_m[at], rays, sight.stature_m)
    fused = landmark_fusion.step(before.landmarks, proposed_m, beside, rays, sight.stature_m)
    sure = pose_proposal.of_landmarks(fused.confidence * confidence[at] / beside)
    return _with_trunk(sight, fused.joints_m), sure, fused.memory


def _with_trunk(sight: Sight, found: NDArray[np.float64]) -> NDArray[np.float64]:
    """The 15 joints from the 12 proposed ones, neck and crown in line with the trunk."""
    joints_m = np.empty((len(JOINT_NAMES), 3))
    joints_m[pose_proposal.AT] = found
    joints_m[PELVIS] = found[pose_network.HIPS].mean(axis=0)
    middle = found[pose_network.SHOULDERS].mean(axis=0)
    up = (middle - joints_m[PELVIS]) / max(float(np.linalg.norm(middle - joints_m[PELVIS])), 1e-9)
    joints_m[NECK] = middle + up * sight.man.lengths[SHOULDERS_BELOW] * sight.stature_m
    joints_m[HEAD] = joints_m[NECK] + up * CROWN * sight.stature_m
    return joints_m


def _at_depth(
    camera: Camera, pixel: tuple[float, float], place_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The world point of a pixel at the depth of a place."""
    forward = np.array(camera.R)[2]
    depth_m = float(forward @ (place_m - centre(camera)))
    along = ray(camera, pixel)
    found: NDArray[np.float64] = centre(camera) + along * depth_m / float(forward @ along)
    return found
