"""The pose proposed by the silhouettes, and the joints' offsets from the cylinders."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Bdp, Vector
from common.body.kinematics import TORSO, joints, limb_frames
from common.body.proportions import body_vector, stature
from common.bus.instant import Seen
from common.raster.silhouette_report import unpack
from common.rig.camera import Rig
from integrator.pose.inverse_kinematics import pose_of, trunk_of
from integrator.proposal import landmark_look, lifting_network, network_weights, pose_network
from integrator.proposal.lifting_network import Lifted
from integrator.proposal.network_weights import JOINTS
from integrator.proposal.silhouette_window import Floats, look

AT: Final = np.array([JOINT_NAMES.index(name) for name in JOINTS])
"""Indices of the proposed joints among the landmarks."""
"""Joints whose offset from their cylinders depends on the arm's turn, and does not carry over to
another pose."""
PELVIS, NECK, HEAD = (JOINT_NAMES.index(name) for name in ("pelvis", "neck", "head_top"))

OFF: Final = {
    "wrist": (0.005, 0.0, 0.0),
    "hip": (0.0, 0.009, 0.016),
    "knee": (0.0, 0.009, 0.007),
    "ankle": (0.0, 0.009, 0.0),
}
"""Offset of the network's joints inwards, up and forwards from the true joints of two
performers, statures: synthetic people have theirs elsewhere in their silhouette
(docs/measurements.md)."""
JOINTS_OFF: Final = np.array(
    [
        np.multiply(OFF.get(name[2:], (0.0, 0.0, 0.0)), (-1.0 if name[0] == "l" else 1.0, 1.0, 1.0))
        for name in JOINTS
    ]
)
"""(12, 3) the same offset, to the left, up and forwards."""
RISE: Final = (0.055, 0.080)
"""Height of the shoulders above the cylinders' with level upper arms, and its gain when both
point straight up (its loss: straight down), in lengths from pelvis to neck. Robust least squares
on the true necks of two performers, whose spines keep their lengths (docs/measurements.md)."""
PLATT: Final = (0.99, -0.64)
"""Platt scaling of the network's confidence, learnt on synthetic people: slope and offset of the
logit; the target is a joint less than 50 mm off. Fitted to two performers and new synthetic people
(docs/measurements.md)."""
CONFIDENT: Final = 0.75
"""Mean confidence of the landmarks above which a proposal is not changed: better matching
cylinders are farther from two performers' true joints (docs/measurements.md)."""

LEANS: Final = math.cos(math.radians(60.0))
"""Cosine of a trunk's lean from which on silhouettes are turned as if it stood: the training
data contain no larger lean."""

HARDLY: Final = 0.01
"""Doubt added to each joint's odds where two proposals are joined."""
BELIEVED: Final = 3.0
"""Factor on the odds of the lifted depths beside those of the silhouettes. For two performers 98
% of the depths' signs are right at 2, 99 % at 3 and 4; the joints' error is equal at 2 to 4
(docs/measurements.md)."""

BELIEVED_AFTER_S: Final = 8.0
"""Seconds after the loss of one of two views over which the weight of lifted joints grows to 1.
The silhouette network remembers both views; the landmark network was not trained on such a
change. The best of 2, 4 and 8 (docs/measurements.md)."""

PLACED: Final = 0.5
"""Place of the hips between those of the silhouette alone (0) and the lifted ones (1). The best
of 0, .35, .5 and .65 in sum over two performers and eight synthetic people who fall, each camera
alone (docs/measurements.md)."""


class Memory(NamedTuple):
    """Memory of both networks; None: that one had no input yet."""

    outlines: Floats | None
    lifting: Floats | None
    alone_s: float
    """How long one view has been alone; infinite where there never were two."""


class PoseProposal(NamedTuple):
    """The proposal of one instant."""

    joints_m: NDArray[np.float64]
    """(12, 3) world, in the order of JOINTS."""
    confidence: Vector
    """(15,) probability that each landmark is less than 50 mm off."""
    memory: Memory
    lifted_m: Vector | None = None
    """(3,) the middle of the hips of the lifted joints alone; None: there are none."""

    @property
    def is_confident(self) -> bool:
        """True: it must not be changed."""
        return bool(self.confidence.mean() >= CONFIDENT)


def step(
    memory: Memory | None,
    bdp: Bdp,
    rig: Rig,
    seen: Seen,
    since_s: float,
    up: Vector | None = None,
    lifts: bool = True,
    *,
    at_once: bool = False,
) -> PoseProposal:
    """The joints proposed by silhouettes, by whole ones where there are any, and by landmarks.

    Two silhouettes that no one person can cast are of two things: the larger is taken for the
    person. The lifted joints are joined in where one silhouette is alone, and where the person
    leans far: the silhouette network guesses depths, and its training data contain no lying person.

    Args:
        memory: Of the instant before; None at the first.
        bdp: The body: its stature sets the scale.
        rig: The cameras, without distortion.
        seen: The person in each view; None where it has none.
        since_s: Time since the instant before.
        up: (3,) direction to the head of a person who leans far or lies, world; None: upright.
        lifts: Whether landmarks are lifted.
        at_once: Lifted joints count fully as soon as one view is alone: its silhouette may hold
            others too.
    """
    any_whole = any(person is not None and not person.cut for person in seen)
    first, second = (
        None if person is None or (any_whole and person.cut) else unpack(person) for person in seen
    )
    height_m = stature(bdp)
    shown = look((first, second), rig, height_m, since_s, up)
    if shown is None:
        areas_px = [0 if person is None else person.area_px for person in seen]
        larger = (first, None) if areas_px[0] >= areas_px[1] else (None, second)
        shown = look(larger, rig, height_m, since_s, up)
    assert shown is not None  # a person in a single view is assumed to stand
    before = Memory(None, None, math.inf) if memory is None else memory
    outlines, found = pose_network.step(network_weights.shipped(), before.outlines, shown, height_m)
    joints_m = found.joints_m - height_m * JOINTS_OFF @ trunk_of(found.joints_m).T
    confidence = probability(found.confidence)
    lifting, lifted = before.lifting, None
    if lifts:
        lifting, lifted = _lifted(before.lifting, seen, rig, height_m, since_s)
    alone_s = before.alone_s + since_s if None in seen else 0.0
    if lifted is not None and (None in seen or up is not None):
        counts_s = math.inf if at_once and alone_s else alone_s
        joints_m, confidence = _joined(joints_m, confidence, lifted, counts_s)
    after = Memory(outlines, lifting, alone_s)
    hips_m = None if lifted is None else _hips_m(lifted.joints_m)
    return PoseProposal(joints_m, of_landmarks(confidence), after, hips_m)


def _lifted(
    memory: Floats | None,
    seen: Seen,
    rig: Rig,
    stature_m: float,
    since_s: float,
) -> tuple[Floats | None, Lifted | None]:
    """The joints lifted from the landmarks of an instant; None where these show no single body."""
    first, second = (landmark_look.shown_of(person) for person in seen)
    if first is None and second is None:
        return memory, None
    shown = landmark_look.look((first, second), rig, stature_m, since_s)
    if shown is None:
        return memory, None
    return lifting_network.step(network_weights.shipped_lifting(), memory, shown, stature_m)


def _joined(
    proposed_m: NDArray[np.float64], confidence: Vector, lifted: Lifted, alone_s: float
) -> tuple[NDArray[np.float64], Vector]:
    """Joints (12, 3) of silhouettes and of landmarks, weighted by odds, and the mean confidence.

    Where one view is alone, the hips are placed between the two estimates.
    """
    lifted_m, believed = lifted.joints_m, BELIEVED
    if alone_s:
        settled = min(1.0, alone_s / BELIEVED_AFTER_S)
        believed *= settled
        apart_m = _hips_m(lifted_m) - _hips_m(proposed_m)
        proposed_m = proposed_m + PLACED * settled * apart_m
        lifted_m = lifted_m - (1.0 - PLACED * settled) * apart_m
    odds, others = (
        (sure / (1.0 - sure + HARDLY))[:, None] for sure in (confidence, lifted.confidence)
    )
    others = believed * others
    joints_m = (odds * proposed_m + others * lifted_m) / (odds + others)
    return joints_m, (confidence + lifted.confidence) / 2.0


def _hips_m(joints_m: NDArray[np.float64]) -> Vector:
    """(3,) the middle of the hips of joints (12, 3)."""
    return np.asarray(joints_m[pose_network.HIPS].mean(axis=0))


def up_of(bdp: Bdp, pose: Vector | None) -> Vector | None:
    """Direction to the head of a person who leans far or lies, (3,); None otherwise."""
    if pose is None:
        return None
    up: Vector = trunk_axes(body_vector(bdp), pose)[:, 1]
    return up if up[1] < LEANS else None


def of_landmarks(own: Vector) -> Vector:
    """The confidence in all landmarks, (15,), from that in the joints, (12,)."""
    confidence = np.zeros(len(JOINT_NAMES))
    confidence[AT] = own
    confidence[PELVIS] = own[pose_network.HIPS].mean()
    confidence[NECK] = confidence[HEAD] = own[pose_network.SHOULDERS].mean()
    return confidence


def probability(confidence: Vector) -> Vector:
    """Probability that joints are less than 50 mm off, from the network's own confidence in (0,
    1)."""
    slope, offset = PLATT
    found: Vector = 1.0 / (1.0 + np.exp(-offset) * ((1.0 - confidence) / confidence) ** slope)
    return found


def pose_and_rest(
    body: Vector, before: Vector, found: NDArray[np.float64]
) -> tuple[Vector, NDArray[np.float64]]:
    """The pose of the joints, and the landmarks' remaining offsets, (15, 3) in the trunk's axes.

    Shoulders rise with their arms and people differ: cylinders can represent neither. The neck
    follows from the shoulders, but does not rise with the arms.
    """
    pose = pose_of(found, body, before)
    rest = np.zeros((len(JOINT_NAMES), 3))
    landmarks = joints(body, pose)
    rest[AT] = (found - landmarks[AT]) @ trunk_axes(body, pose)
    rest[PELVIS] = rest[AT[pose_network.HIPS]].mean(axis=0)
    rest[NECK] = rest[AT[pose_network.SHOULDERS]].mean(axis=0)
    rest[NECK, 1] -= _shoulders_rise(found, landmarks)
    return pose, rest


def _shoulders_rise(found: NDArray[np.float64], landmarks: NDArray[np.float64]) -> float:
    """Height by which the arms of joints (12, 3) lift the shoulders, for a body with landmarks."""
    trunk = landmarks[NECK] - landmarks[PELVIS]
    length_m = float(np.linalg.norm(trunk))
    arms = found[pose_network.ELBOWS] - found[pose_network.SHOULDERS]
    lengths_m = np.maximum(np.linalg.norm(arms, axis=1, keepdims=True), 1e-9)
    up = float((arms / lengths_m).mean(axis=0) @ trunk) / length_m
    return length_m * (RISE[0] + RISE[1] * up)


def trunk_axes(body: Vector, pose: Vector) -> NDArray[np.float64]:
    """Left, up and front of the trunk in the world, as columns, (3, 3)."""
    axes: NDArray[np.float64] = limb_frames(body, pose)[TORSO, 3:].reshape(3, 3)
    return axes
