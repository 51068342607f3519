"""The pose proposed by both silhouettes, without clutter where it fits badly."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Bdp, Vector, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, stature
from common.bus.instant import Seen
from common.method import Method
from common.rig.camera import Rig
from integrator.fit import visual_hull
from integrator.fit.silhouette_pair import poorest
from integrator.landmarks import joint_marks, landmark_fusion
from integrator.landmarks.landmark_rays import rays_of
from integrator.measuring.prior_body import prior
from integrator.proposal import pose_proposal
from integrator.proposal.pose_proposal import Memory, PoseProposal
from integrator.rig.best_pair import Places, Two, two_of

POOR: Final = 0.6
"""S in either view below which a pose fits badly: 5 % of two performers' poses do
(docs/measurements.md)."""


class Before(NamedTuple):
    """Memory of the instant before."""

    memory: Memory | None = None
    pose: Vector | None = None
    """(25,); None at the first instant."""
    landmarks: landmark_fusion.Memory | None = None


class Sighting(NamedTuple):
    """The person in the views, and the rig and body to compare them with."""

    bdp: Bdp
    rig: Rig
    """Cameras without distortion."""
    seen: Seen
    pair: Places
    """The two views that show the person best: both do."""
    dt_s: float
    method: Method
    is_first: bool = False
    """The body is a prior, fitted to these silhouettes."""

    @property
    def two(self) -> Two:
        """The views of the pair: the silhouette network takes two."""
        return two_of(self.rig, self.seen, self.pair)


class ProposedPose(NamedTuple):
    """A pose from two views."""

    pose: Vector
    """(25,)"""
    joints_m: NDArray[np.float64]
    """(15, 3) world."""
    confidence: Vector
    """(15,) probability that each joint is less than 50 mm off."""
    memory: Memory
    landmarks: landmark_fusion.Memory | None
    seen: Seen
    """The reports used: without clutter, where that was removed."""
    bdp: Bdp
    """The body; a new one where it was a prior fitted to silhouettes with clutter."""


def step(before: Before, now: Sighting) -> ProposedPose:
    """One instant of both views.

    Where the network is not confident and the pose fits badly, the silhouettes without clutter are
    tried; they are used if the network is more confident in them. The result is fused with the
    joints that the pictures show.
    """
    known, was = _proposed(before, now), rest_pose() if before.pose is None else before.pose
    if now.method.clutter_removal and not known.is_confident:
        now, known = _without_clutter(before, now, known)
    known, landmarks = _with_landmarks(before, now, known)
    body = body_vector(now.bdp)
    pose, beside_m = pose_proposal.pose_and_rest(body, was, known.joints_m)
    joints_m = joints(body, pose)
    if now.method.free_joints:
        joints_m = joints_m + beside_m @ pose_proposal.trunk_axes(body, pose).T
    return ProposedPose(
        pose, joints_m, known.confidence, known.memory, landmarks, now.seen, now.bdp
    )


def _proposed(before: Before, now: Sighting) -> PoseProposal:
    up = pose_proposal.up_of(now.bdp, before.pose)
    return pose_proposal.step(before.memory, now.bdp, *now.two, now.dt_s, up, now.method.lifting)


def _with_landmarks(
    before: Before, now: Sighting, known: PoseProposal
) -> tuple[PoseProposal, landmark_fusion.Memory | None]:
    """The proposal fused with the joints that the pictures show, where they show any."""
    rays = rays_of(now.rig, now.seen)
    if rays is None:
        return known, before.landmarks
    sure, stature_m = known.confidence[pose_proposal.AT], stature(now.bdp)
    joints_m, rays = joint_marks.centred(before.landmarks, known.joints_m, rays, stature_m)
    fused = landmark_fusion.step(before.landmarks, joints_m, sure, rays, stature_m)
    confidence = pose_proposal.of_landmarks(fused.confidence)
    return known._replace(joints_m=fused.joints_m, confidence=confidence), fused.memory


def _without_clutter(
    before: Before, now: Sighting, known: PoseProposal
) -> tuple[Sighting, PoseProposal]:
    """The instant without what both views do not show as one piece, if that is surer."""
    body, was = body_vector(now.bdp), rest_pose() if before.pose is None else before.pose
    pose, _ = pose_proposal.pose_and_rest(body, was, known.joints_m)
    if poorest(pose, body, *now.two) >= POOR:
        return now, known
    cleaned = visual_hull.cleaned(*now.two)
    if not cleaned.clutter:
        return now, known
    of_pair = dict(zip(now.pair, cleaned.seen, strict=True))
    clean = now._replace(seen=tuple(of_pair.get(n, own) for n, own in enumerate(now.seen)))
    clean = clean._replace(bdp=prior(*clean.two) if now.is_first else now.bdp)
    again = _proposed(before, clean)
    return (clean, again) if again.confidence.mean() > known.confidence.mean() else (now, known)
