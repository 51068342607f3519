"""A single view: its proposed body, or its lifted stick body (thesis 3.1.5)."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.bus.messages import Lifting, ViewerNumber
from common.rig.camera import TOWARDS, arrays_of, project
from integrator.landmarks import landmark_fusion
from integrator.proposal.pose_proposal import Memory
from integrator.rig.undistortion import undistorted_camera
from integrator.single import (
    calm_depth,
    depth_signs,
    floor_depth,
    lifted_stick,
    lone_proposal,
    reflection,
)
from integrator.single.reflection import Front
from integrator.single.sight import Hypothesis, Sight

GOOD: Final = 0.7
"""S above which a proposed body needs no stick body beside it."""
SURELY: Final = 1.15
"""Factor by which the lifted body's S must exceed the proposed one's to be preferred."""


class Alone(NamedTuple):
    """Decisions of a single view, kept for its next instant."""

    number: ViewerNumber
    """Index of the view."""
    score: float
    """S of the body in its picture."""
    lifting: Lifting
    front: Front | None
    """Front or back; None where the network's own memory has it from both views."""
    signs: depth_signs.Memory
    landmarks: landmark_fusion.Memory | None
    """Memory of the landmarks."""
    stick: bool
    """True: a stick body is requested for the next instant, because the proposal fits badly."""
    depth: calm_depth.Memory | None = None
    """Memory of the joints' distances."""
    place: floor_depth.Memory | None = None
    """Memory of the whole body's."""


class Found(NamedTuple):
    """The body of an instant."""

    body: Hypothesis
    memory: Memory | None
    alone: Alone
    lifted_m: Vector | None = None
    """(3,) the middle of the hips by the landmarks alone; None: they show none."""


def begun(sight: Sight, joints_m: NDArray[np.float64] | None, other: Alone | None = None) -> Alone:
    """The knowledge of a view that has just become the only one: the facing by both views, or by
    the other one (T22).

    Args:
        sight: Of the first instant alone.
        joints_m: (15, 3) of the instant before; None: unknown.
        other: The other view's memory, where that was alone at the instant before.
    """
    nothing, signs = Lifting("", 1.0, ()), depth_signs.init()
    if joints_m is None:
        return Alone(sight.number, 0.0, nothing, Front(), signs, None, stick=False)
    signs, front, landmarks = _witnessed(sight, signs, joints_m), None, None
    if other is not None:
        landmarks = other.landmarks
        yaw = reflection.yaw_deg(sight.camera, joints_m)
        front = None if other.front is None else reflection.as_known(other.front, yaw)
    place = floor_depth.known(undistorted_camera(sight.camera), joints_m)
    return Alone(sight.number, 0.0, nothing, front, signs, landmarks, stick=False, place=place)


def step(memory: Memory | None, alone: Alone, sight: Sight) -> Found:
    """One frame with a person: a lifted body competes with the proposed one, by S.

    Args:
        memory: The network's; None at the first.
        alone: Of the instant before.
        sight: The view.
    """
    if sight.method.stick_lifting:
        signs, lifted = lifted_stick.step(alone.signs, sight)
        return _found(lifted, memory, alone._replace(signs=signs))
    found = _proposed_or_lifted(memory, alone, sight)
    if not sight.on_floor:
        return found
    lifted_m = None if sight.is_only else found.lifted_m  # no better there (docs/measurements.md)
    place, body = floor_depth.step(alone.place, sight, found.body, lifted_m)
    return found._replace(body=body, alone=found.alone._replace(place=place))


def _proposed_or_lifted(memory: Memory | None, alone: Alone, sight: Sight) -> Found:
    """The proposed body, or the lifted stick body where it fits better."""
    before = lone_proposal.Before(memory, alone.front, alone.landmarks, alone.depth)
    seen = lone_proposal.step(before, sight)
    body, suffices = seen.found, seen.agrees and seen.found.score >= GOOD
    alone = alone._replace(
        front=seen.front, landmarks=seen.landmarks, depth=seen.depth, stick=not suffices
    )
    if suffices or sight.person.stick is None:
        signs = _witnessed(sight, alone.signs, body.joints_m, body.lifting.orientation_confidence)
        return _found(body, seen.memory, alone._replace(signs=signs), seen.lifted_m)
    signs, lifted = lifted_stick.step(alone.signs, sight)
    fits = lifted.score >= SURELY * body.score
    if not seen.agrees or (fits and _off_px(sight, lifted) <= _off_px(sight, body)):
        body = lifted
    return _found(body, seen.memory, alone._replace(signs=signs), seen.lifted_m)


def _found(
    body: Hypothesis, memory: Memory | None, alone: Alone, lifted_m: Vector | None = None
) -> Found:
    alone = alone._replace(score=body.score, lifting=body.lifting)
    return Found(body, memory, alone, lifted_m)


def _off_px(sight: Sight, body: Hypothesis) -> float:
    """Distance of a body from the observed joints, weighted by confidence; 0 where there are
    none."""
    found = sight.person.landmarks
    if found is None:
        return 0.0
    sure = np.array(found.confidence)
    seen_px = project(undistorted_camera(sight.camera), body.joints_m)
    off_px = np.linalg.norm(seen_px - np.array(found.joints_px), axis=1)
    return float(sure @ off_px / max(sure.sum(), 1e-9))


def _witnessed(
    sight: Sight, signs: depth_signs.Memory, joints_m: NDArray[np.float64], confidence: float = 1.0
) -> depth_signs.Memory:
    """Direction of segments and facing, for the frames whose silhouette needs a stick body."""
    seen_m = joints_m @ arrays_of(sight.camera).R.T * TOWARDS
    facing = reflection.faces(reflection.yaw_deg(sight.camera, joints_m))
    return depth_signs.witnessed(signs, seen_m, facing, confidence)
