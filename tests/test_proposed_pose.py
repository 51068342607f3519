"""The pose of two views, of what outlines propose and what landmarks lift."""

import math

import msgspec
import numpy as np
import pytest
from rolling import BODY, ROLLED, on_one_leg, outlines, person_in

from common.body.body import JOINT_NAMES, POSE_INDEX, Vector
from common.body.kinematics import joints
from common.body.observation import Landmarks, Observation
from common.body.proportions import body_vector, stature
from common.bus.instant import Seen
from common.method import DEFAULT
from common.rig.camera import Camera, project
from integrator.fit import proposed_pose
from integrator.fit.proposed_pose import Before, Sighting
from integrator.pose.inverse_kinematics import trunk_of
from integrator.proposal import lifting_network, pose_network, pose_proposal
from integrator.proposal.lifting_network import Lifted
from integrator.proposal.pose_proposal import (
    AT,
    BELIEVED,
    BELIEVED_AFTER_S,
    CONFIDENT,
    HARDLY,
    JOINTS_OFF,
    PLACED,
    Memory,
    PoseProposal,
)


def glaring() -> tuple[Observation, Observation]:
    """Glare on the floor, as large as a trunk, that one view alone shows."""
    first, second = outlines(on_one_leg())
    first[200:240, 0:40] = True
    return person_in(first), person_in(second)


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
    found = proposed_pose.step(Before(), Sighting(BODY, ROLLED, glaring(), (0, 1), 1 / 15, DEFAULT))
    assert (found.seen != glaring()) == cleared
    assert found.confidence == pytest.approx(clean if cleared else glared)


def shown(report: Observation, camera: Camera, sure: float) -> Observation:
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
    first = shown(person_in(outline), ROLLED.cameras[0], 0.9)
    second = shown(person_in(other), ROLLED.cameras[1], 0.9)
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
    first = shown(person_in(outline), ROLLED.cameras[0], 0.9)
    alone = pose_proposal.step(None, BODY, ROLLED, (first, None), 1 / 15, lifts=False).joints_m
    beyond_m = np.array([0.1, 0.0, -0.6])
    lifting(monkeypatch, alone + beyond_m)
    joined = pose_proposal.step(None, BODY, ROLLED, (first, None), 1 / 15).joints_m
    assert joined - alone == pytest.approx(np.tile(beyond_m / 2, (len(AT), 1)), abs=1e-5)


@pytest.mark.parametrize("sure", [(0.2, 0.8), (0.9, 0.5)])
@pytest.mark.parametrize("alone_s", [0.0, 2.0, 60.0])
def test_outlines_and_landmarks_are_joined_by_their_odds(
    sure: tuple[float, float], alone_s: float
) -> None:
    rng = np.random.default_rng(1)
    proposed_m, lifted_m = rng.normal(size=(2, 12, 3))
    given = np.full(12, sure[0]), np.full(12, sure[1])
    found_m, confidence = pose_proposal._joined(
        proposed_m, given[0], Lifted(lifted_m, given[1]), alone_s
    )
    assert confidence == pytest.approx(np.full(12, sum(sure) / 2))
    share = 1.0
    if alone_s:
        share = min(1.0, alone_s / BELIEVED_AFTER_S)
        hips_m = [each[6:8].mean(axis=0) for each in (proposed_m, lifted_m)]
        place_m = hips_m[0] + PLACED * share * (hips_m[1] - hips_m[0])
        proposed_m, lifted_m = (
            each + place_m - own for each, own in zip((proposed_m, lifted_m), hips_m, strict=True)
        )
    odds = [each / (1.0 - each + HARDLY) for each in sure]
    odds[1] *= BELIEVED * share
    expected_m = (odds[0] * proposed_m + odds[1] * lifted_m) / sum(odds)
    assert found_m == pytest.approx(expected_m)


class Networks:
    """Networks that propose and lift this, and what they were asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.looked: list[tuple[bool, bool]] = []
        self.joints_m = joints(body_vector(BODY), on_one_leg())[AT]
        self.meet = True
        self.lifted_m = self.joints_m + 0.3
        lifting(monkeypatch, self.lifted_m)
        monkeypatch.setattr(pose_proposal, "look", self.look)
        found = pose_network.Proposal(self.joints_m, np.full(12, 0.5))
        monkeypatch.setattr(pose_network, "step", lambda *_: (np.zeros(1, np.float32), found))

    def look(self, masks: tuple[object, object], *_: object) -> object:
        self.looked.append((masks[0] is not None, masks[1] is not None))
        return "a look" if self.meet or sum(self.looked[-1]) == 1 else None


@pytest.fixture
def networks(monkeypatch: pytest.MonkeyPatch) -> Networks:
    return Networks(monkeypatch)


def both_shown(first: bool = True, second: bool = True) -> Seen:
    made = zip((1, 2), outlines(on_one_leg()), ROLLED.cameras, (first, second), strict=True)
    one, other = (
        shown(person_in(mask), camera, 0.9) if there else None for n, mask, camera, there in made
    )
    return one, other


def test_outlines_are_off_by_what_they_are_off_in_the_trunks_axes(networks: Networks) -> None:
    found = pose_proposal.step(None, BODY, ROLLED, both_shown(), 1 / 15)
    off_m = (networks.joints_m - found.joints_m) @ trunk_of(networks.joints_m)
    assert off_m == pytest.approx(stature(BODY) * JOINTS_OFF, abs=1e-9)


def test_landmarks_are_lifted_in_beside_one_view_and_for_who_leans_far(networks: Networks) -> None:
    up = np.array([1.0, 0.0, 0.0])
    plain = pose_proposal.step(None, BODY, ROLLED, both_shown(), 1 / 15, lifts=False).joints_m
    for seen, leans, lifts in (
        (both_shown(), None, False),
        (both_shown(), up, True),
        (both_shown(second=False), None, True),
        (both_shown(first=False), None, True),
    ):
        found = pose_proposal.step(None, BODY, ROLLED, seen, 1 / 15, leans)
        assert np.allclose(found.joints_m, plain) != lifts
        assert found.memory.lifting is not None
        assert found.memory.alone_s == (math.inf if None in seen else 0.0)
    told_nothing = (person_in(outlines(on_one_leg())[0]), None)
    found = pose_proposal.step(None, BODY, ROLLED, told_nothing, 1 / 15)
    assert np.allclose(found.joints_m, plain)
    assert found.memory.lifting is None
    half = (both_shown()[0], person_in(outlines(on_one_leg())[1]))
    assert pose_proposal.step(None, BODY, ROLLED, half, 1 / 15).memory.lifting is not None


def test_one_view_is_alone_for_as_long_as_it_has_been(networks: Networks) -> None:
    known = Memory(None, None, 2.0)
    assert pose_proposal.step(known, BODY, ROLLED, both_shown(), 0.5).memory.alone_s == 0.0
    alone = both_shown(second=False)
    assert pose_proposal.step(known, BODY, ROLLED, alone, 0.5).memory.alone_s == 2.5


def test_beside_others_landmarks_are_lifted_in_fully_as_soon_as_one_view_is_alone(
    networks: Networks,
) -> None:
    """As of who was alone for ever; no sooner where both views show the person."""
    outlines = pose_proposal.step(None, BODY, ROLLED, both_shown(), 1 / 15).memory.outlines
    alone, both = both_shown(second=False), both_shown()

    def joints_m(seen: Seen, alone_s: float, at_once: bool) -> Vector:
        known = Memory(outlines, None, alone_s)
        return pose_proposal.step(known, BODY, ROLLED, seen, 1 / 15, at_once=at_once).joints_m

    fully_m = joints_m(alone, math.inf, False)
    assert joints_m(alone, 0.0, True) == pytest.approx(fully_m)
    assert not np.allclose(joints_m(alone, 0.0, False), fully_m)
    assert joints_m(both, 0.0, True) == pytest.approx(joints_m(both, 0.0, False))


@pytest.mark.parametrize("larger", [1, 2])
def test_of_two_things_that_no_one_person_casts_the_larger_is_looked_at(
    networks: Networks, larger: int
) -> None:
    networks.meet = False
    first, second = both_shown()
    assert first is not None
    assert second is not None
    first = msgspec.structs.replace(first, area_px=500 if larger == 1 else 400)
    second = msgspec.structs.replace(second, area_px=400 if larger == 1 else 500)
    pose_proposal.step(None, BODY, ROLLED, (first, second), 1 / 15)
    assert networks.looked == [(True, True), (larger == 1, larger == 2)]


def test_a_silhouette_that_is_cut_is_looked_at_only_where_none_is_whole(networks: Networks) -> None:
    first, second = both_shown()
    assert first is not None
    assert second is not None
    cut, other = (msgspec.structs.replace(each, cut=True) for each in (first, second))
    for seen in ((cut, second), (first, other), (cut, other)):
        pose_proposal.step(None, BODY, ROLLED, seen, 1 / 15)
    assert networks.looked == [(False, True), (True, False), (True, True)]


def test_joints_lie_beside_the_cylinders_where_they_are_free(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Else they are where the cylinders end."""
    proposing(monkeypatch, 0.9, 0.9)
    ends = []
    for free in (True, False):
        method = msgspec.structs.replace(DEFAULT, free_joints=free)
        seen = (person_in(outlines(on_one_leg())[0]), person_in(outlines(on_one_leg())[1]))
        found = proposed_pose.step(Before(), Sighting(BODY, ROLLED, seen, (0, 1), 1 / 15, method))
        ends.append(np.allclose(found.joints_m, joints(body_vector(BODY), found.pose)))
    assert ends == [False, True]
