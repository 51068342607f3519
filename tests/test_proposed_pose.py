"""The pose of two views, held against a proposal that fits badly, with and without confidence."""

import numpy as np
import pytest
from rolling import BODY, ROLLED, on_one_leg, outlines, told

from common.body.body import JOINT_NAMES, POSE_INDEX, Vector
from common.body.kinematics import joints
from common.body.proportions import body_vector
from common.method import DEFAULT
from integrator.fit import proposed_pose
from integrator.fit.proposed_pose import Before, Instant, ProposedPose
from integrator.proposal import pose_proposal
from integrator.proposal.pose_proposal import AT, CONFIDENT, PoseProposal


def bent_over() -> Vector:
    pose = on_one_leg()
    pose[POSE_INDEX["torso_z"]] += 12.0
    return pose


@pytest.fixture
def proposing(monkeypatch: pytest.MonkeyPatch, confidence: float) -> None:
    """A network that proposes somebody who bends over too far, with so much confidence."""
    joints_m = joints(body_vector(BODY), bent_over())[AT]
    given = PoseProposal(joints_m, np.full(len(JOINT_NAMES), confidence), np.zeros(1, np.float32))
    monkeypatch.setattr(pose_proposal, "step", lambda *_: given)


def found() -> ProposedPose:
    first, second = outlines(on_one_leg())
    seen = (told(1, first), told(2, second))
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
