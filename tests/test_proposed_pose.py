"""The pose of two views, held against a proposal that fits badly, with and without confidence."""

import math

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
from integrator.proposal import lifting_network, pose_proposal
from integrator.proposal.lifting_network import Lifted
from integrator.proposal.pose_proposal import AT, CONFIDENT, Memory, PoseProposal


def bent_over() -> Vector:
    pose = on_one_leg()
    pose[POSE_INDEX["torso_z"]] += 12.0
    return pose


@pytest.fixture
def proposing(monkeypatch: pytest.MonkeyPatch, confidence: float) -> None:
    """A network that proposes somebody who bends over too far, with so much confidence."""
    joints_m = joints(body_vector(BODY), bent_over())[AT]
    memory = Memory(np.zeros(1, np.float32), None, 0.0)
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


def lifting(monkeypatch: pytest.MonkeyPatch, joints_m: Vector) -> None:
    """Landmarks are lifted to these joints, (12, 3)."""
    lifted = np.zeros(1, np.float32), Lifted(joints_m, np.full(len(AT), 0.5))
    monkeypatch.setattr(lifting_network, "step", lambda *_: lifted)


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


def test_what_both_views_showed_outweighs_what_one_lifts_until_it_is_old(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A recurrent network of outlines remembers the depths that the lost camera showed."""
    lifting(monkeypatch, joints(body_vector(BODY), on_one_leg())[AT] * [1.0, 2.0, 1.0])
    outline, other = outlines(on_one_leg())
    first = shown(told(1, outline), ROLLED.cameras[0], 0.9)
    second = shown(told(2, other), ROLLED.cameras[1], 0.9)
    both = pose_proposal.step(None, BODY, ROLLED, (first, second), 1 / 15).memory
    stretched_m = []
    for alone_s in (0.0, 1.0, 4.0, 30.0, math.inf):
        before = both._replace(alone_s=alone_s)
        joints_m = pose_proposal.step(before, BODY, ROLLED, (first, None), 1 / 15).joints_m
        stretched_m.append(float(np.ptp(joints_m[:, 1])))
    assert stretched_m == sorted(stretched_m)
    assert stretched_m[0] < stretched_m[1] < stretched_m[2] < stretched_m[3] == stretched_m[4]


def test_where_one_view_is_alone_the_person_stands_between_what_outline_and_landmarks_say(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Outlines place people by their feet, landmarks by their size: both err, but not alike."""
    outline, _ = outlines(on_one_leg())
    first = shown(told(1, outline), ROLLED.cameras[0], 0.9)
    alone = pose_proposal.step(None, BODY, ROLLED, (first, None), 1 / 15, lifts=False).joints_m
    beyond_m = np.array([0.1, 0.0, -0.6])
    lifting(monkeypatch, alone + beyond_m)
    joined = pose_proposal.step(None, BODY, ROLLED, (first, None), 1 / 15).joints_m
    assert joined - alone == pytest.approx(np.tile(beyond_m / 2, (len(AT), 1)), abs=1e-5)
