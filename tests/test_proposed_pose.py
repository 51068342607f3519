"""The pose of two views, of what outlines propose and what landmarks lift."""

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
from integrator.fit.proposed_pose import Before, Instant
from integrator.pairing import Seen
from integrator.proposal import lifting_network, pose_proposal
from integrator.proposal.lifting_network import Lifted
from integrator.proposal.pose_proposal import AT, CONFIDENT, Memory, PoseProposal


def glaring() -> tuple[Report, Report]:
    """Glare on the floor, as large as a trunk, that one view alone shows."""
    first, second = outlines(on_one_leg())
    first[200:240, 0:40] = True
    return told(1, first), told(2, second)


def proposing(monkeypatch: pytest.MonkeyPatch, glared: float, clean: float) -> None:
    """A network that proposes somebody who bends over too far, with so much confidence in
    outlines with glare and without."""
    pose = on_one_leg()
    pose[POSE_INDEX["torso_z"]] += 12.0
    joints_m = joints(body_vector(BODY), pose)[AT]
    memory = Memory(np.zeros(1, np.float32), None, 0.0)

    def step(_memory: object, _bdp: object, _rig: object, seen: Seen, *_: object) -> PoseProposal:
        sure = glared if seen == glaring() else clean
        return PoseProposal(joints_m, np.full(len(JOINT_NAMES), sure), memory)

    monkeypatch.setattr(pose_proposal, "step", step)


@pytest.mark.parametrize(
    ("glared", "clean", "cleared"),
    [(0.3, 0.6, True), (0.3, 0.2, False), (CONFIDENT, 0.9, False)],
    ids=["unsure", "surer with clutter", "sure"],
)
def test_what_one_view_alone_shows_goes_where_the_network_is_unsure_with_it_and_surer_without(
    monkeypatch: pytest.MonkeyPatch, glared: float, clean: float, cleared: bool
) -> None:
    proposing(monkeypatch, glared, clean)
    found = proposed_pose.step(Before(), Instant(BODY, ROLLED, glaring(), 1 / 15, DEFAULT))
    assert (found.seen != glaring()) == cleared
    assert found.confidence == pytest.approx(clean if cleared else glared)


def shown(report: Report, camera: Camera, sure: float) -> Report:
    """With landmarks of that pose, so sure."""
    places_px = project(camera, joints(body_vector(BODY), on_one_leg())).tolist()
    landmarks = Landmarks(tuple((x, y) for x, y in places_px), (sure,) * len(JOINT_NAMES))
    return msgspec.structs.replace(report, landmarks=landmarks)


def lifting(monkeypatch: pytest.MonkeyPatch, joints_m: Vector) -> None:
    """Landmarks are lifted to these joints, (12, 3)."""
    lifted = np.zeros(1, np.float32), Lifted(joints_m, np.full(len(AT), 0.5))
    monkeypatch.setattr(lifting_network, "step", lambda *_: lifted)


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
