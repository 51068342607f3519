"""The pose of two views, held against a proposal that fits badly, with and without confidence."""

import msgspec
import numpy as np
import pytest
from rolling import BODY, ROLLED, on_one_leg, outlines, told

from common.body.body import JOINT_NAMES, POSE_INDEX, Vector
from common.body.kinematics import joints
from common.body.proportions import body_vector
from common.bus.messages import Landmarks, Report
from common.method import DEFAULT
from common.rig.camera import Camera, project
from integrator.fit import proposed_pose
from integrator.fit.proposed_pose import Before, Instant, ProposedPose
from integrator.proposal import pose_proposal
from integrator.proposal.pose_proposal import AT, CONFIDENT, Memory, PoseProposal


def bent_over() -> Vector:
    pose = on_one_leg()
    pose[POSE_INDEX["torso_z"]] += 12.0
    return pose


@pytest.fixture
def proposing(monkeypatch: pytest.MonkeyPatch, confidence: float) -> None:
    """A network that proposes somebody who bends over too far, with so much confidence."""
    joints_m = joints(body_vector(BODY), bent_over())[AT]
    memory = Memory(np.zeros(1, np.float32), None)
    given = PoseProposal(joints_m, np.full(len(JOINT_NAMES), confidence), memory)
    monkeypatch.setattr(pose_proposal, "step", lambda *_: given)


def shown(report: Report, camera: Camera, sure: float) -> Report:
    """With landmarks of what is proposed, so sure."""
    places_px = project(camera, joints(body_vector(BODY), bent_over())).tolist()
    landmarks = Landmarks(tuple((x, y) for x, y in places_px), (sure,) * len(JOINT_NAMES))
    return msgspec.structs.replace(report, landmarks=landmarks)


def found(sures: tuple[float, float] | None = None) -> ProposedPose:
    first, second = outlines(on_one_leg())
    seen = (told(1, first), told(2, second))
    if sures is not None:
        one, other = ROLLED.cameras
        seen = (shown(seen[0], one, sures[0]), shown(seen[1], other, sures[1]))
    return proposed_pose.step(
        Before(pose=on_one_leg(35.0), matched=True), Instant(BODY, ROLLED, seen, 1 / 15, DEFAULT)
    )


@pytest.mark.usefixtures("proposing")
@pytest.mark.parametrize(("confidence", "matched"), [(CONFIDENT, False), (0.05, True)])
def test_a_confident_proposal_is_left_as_it_is(matched: bool) -> None:
    """However badly it matches: cylinders are no people."""
    pose = found()
    assert pose.matched == matched
    assert (pose.confidence[0] == CONFIDENT) != matched


@pytest.mark.usefixtures("proposing")
@pytest.mark.parametrize("confidence", [0.05])
@pytest.mark.parametrize(("sures", "matched"), [((0.55, 0.55), False), ((0.55, 0.4), True)])
def test_a_pose_that_both_views_landmarks_show_is_not_matched_to_outlines(
    sures: tuple[float, float], matched: bool
) -> None:
    """Clothes of the wall's colour leave ragged outlines, to which no pose should be bent."""
    pose = found(sures)
    assert pose.confidence.mean() < CONFIDENT
    assert pose.matched == matched
