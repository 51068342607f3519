"""How far away a body is in one view: where its feet stand, and no faster than people walk."""

import msgspec
import numpy as np
import pytest
from crowd_of_two import pose_at
from staging import PERSON, RIG, observation, silhouettes

from common.body.body import Vector
from common.body.kinematics import joints
from common.body.observation import Landmarks, Observation
from common.body.proportions import body_vector, stature
from common.body.stick_body import ADULT
from common.bus.messages import Lifting
from common.method import DEFAULT
from common.rig.camera import centre, project
from integrator.proposal import pose_proposal
from integrator.single import single_view
from integrator.single.floor_depth import ANKLE, ANKLES, PELVIS, SURE, feet_depth, known, step
from integrator.single.sight import Annotations, Hypothesis, Sight

CAMERA = RIG.cameras[0]
ANKLE_M = ANKLE * stature(PERSON)
POSE = pose_at((0.3, -0.4))


def standing_m() -> Vector:
    """(15, 3) a person on the floor, ankles as high as people's."""
    joints_m = np.array(joints(body_vector(PERSON), POSE))
    joints_m[list(ANKLES), 1] = ANKLE_M
    return joints_m


STANDING_M = standing_m()
DEPTH_M = known(CAMERA, STANDING_M).depth_m
FEET_M = float(np.mean([known(CAMERA, STANDING_M[[a] * 15]).depth_m for a in ANKLES]))


def landmarks(joints_m: Vector, confidence: float = 0.9) -> Landmarks:
    px = project(CAMERA, joints_m)
    return Landmarks(tuple((x, y) for x, y in px.tolist()), (confidence,) * 15)


def person(shown: Landmarks | None) -> Observation:
    return msgspec.structs.replace(observation(silhouettes(POSE)[0]), landmarks=shown)


def sight_of(shown: Landmarks | None, dt_s: float = 1 / 15, on_floor: bool = True) -> Sight:
    seen = person(shown)
    return Sight(DEFAULT, 0, RIG, seen, ADULT, PERSON, None, dt_s, Annotations(), 1, on_floor)


def away(by_m: float) -> Hypothesis:
    """The person, proposed so much farther along the line of sight."""
    off_m = STANDING_M[PELVIS] - centre(CAMERA)
    by = off_m / DEPTH_M * by_m
    pose = POSE.copy()
    pose[:3] += by
    lifting = Lifting("", 1.0, ())
    return Hypothesis(STANDING_M + by, pose, 0.9, np.full(15, 0.9), lifting)


def test_two_feet_on_the_floor_tell_the_depth() -> None:
    found = feet_depth(CAMERA, landmarks(STANDING_M), ANKLE_M)
    assert found is not None
    assert found.depth_m == pytest.approx(FEET_M, abs=1e-6)


def test_feet_that_are_not_both_seen_on_the_floor_tell_nothing() -> None:
    assert feet_depth(CAMERA, None, ANKLE_M) is None
    assert feet_depth(CAMERA, landmarks(STANDING_M, SURE - 0.01), ANKLE_M) is None
    lifted = STANDING_M.copy()
    lifted[ANKLES[0], 1] += 0.4
    assert feet_depth(CAMERA, landmarks(lifted), ANKLE_M) is None


def test_feet_far_apart_are_less_sure() -> None:
    stride = STANDING_M.copy()
    stride[ANKLES[0], 2] += 0.4
    wide, close = (feet_depth(CAMERA, landmarks(each), ANKLE_M) for each in (stride, STANDING_M))
    assert wide is not None
    assert close is not None
    assert wide.variance_m2 > 2.0 * close.variance_m2


@pytest.mark.parametrize("by_m", [-0.5, 0.5])
def test_a_body_that_is_proposed_elsewhere_comes_to_its_feet(by_m: float) -> None:
    proposed = away(by_m)
    _, body = step(None, sight_of(landmarks(STANDING_M)), proposed)
    off_m = known(CAMERA, body.joints_m).depth_m - DEPTH_M
    assert abs(off_m) < 0.6 * abs(by_m)
    moved_m = body.joints_m - proposed.joints_m
    assert moved_m == pytest.approx(np.repeat(moved_m[:1], 15, axis=0))
    assert body.pose[:3] - proposed.pose[:3] == pytest.approx(moved_m[0])
    before_px, after_px = (project(CAMERA, each.joints_m)[PELVIS] for each in (proposed, body))
    assert after_px == pytest.approx(before_px)


def test_who_was_seen_by_two_views_does_not_jump_when_one_is_left() -> None:
    memory, body = step(known(CAMERA, STANDING_M), sight_of(None), away(0.6))
    assert 0.0 < memory.depth_m - DEPTH_M < 0.3
    assert known(CAMERA, body.joints_m).depth_m == pytest.approx(memory.depth_m)


@pytest.mark.parametrize(("silhouette_m", "landmarks_m"), [(-0.6, 0.0), (0.0, -0.6)])
def test_the_farther_of_silhouette_and_landmarks_counts(
    silhouette_m: float, landmarks_m: float
) -> None:
    """Others in the silhouette make it larger, and the body nearer."""
    proposed = away(silhouette_m)
    lifted_m = away(landmarks_m).joints_m[PELVIS]
    memory, body = step(known(CAMERA, STANDING_M), sight_of(None), proposed, lifted_m)
    assert memory.depth_m == pytest.approx(DEPTH_M)
    assert known(CAMERA, body.joints_m).depth_m == pytest.approx(DEPTH_M)


@pytest.mark.parametrize(
    ("on_floor", "only", "told"), [(True, False, True), (False, False, False), (True, True, False)]
)
def test_beside_others_one_of_several_views_is_told_where_landmarks_have_the_hips(
    monkeypatch: pytest.MonkeyPatch, on_floor: bool, only: bool, told: bool
) -> None:
    lifted_m = away(0.3).joints_m[PELVIS]
    found = pose_proposal.PoseProposal(
        STANDING_M[pose_proposal.AT],
        np.ones(15),
        pose_proposal.Memory(None, None, 0.0),
        lifted_m,
    )
    asked: list[bool] = []

    def proposed(*given: object, at_once: bool) -> pose_proposal.PoseProposal:
        asked.append(at_once)
        return found

    monkeypatch.setattr(pose_proposal, "step", proposed)
    sight = sight_of(None, on_floor=on_floor)
    if only:
        rig = msgspec.structs.replace(RIG, cameras=(CAMERA, CAMERA))
        sight = sight._replace(rig=rig)
    seen = single_view.step(None, single_view.begun(sight, STANDING_M), sight)
    assert asked == [on_floor]
    farther_m = known(CAMERA, seen.body.joints_m).depth_m - DEPTH_M
    assert (farther_m > 0.02) == told


def test_a_depth_that_was_quite_wrong_is_given_up_within_three_instants() -> None:
    """As of a body that was on another person; a moment's outlier is believed by half."""
    memory, off_m = known(CAMERA, STANDING_M), []
    for _ in range(3):
        memory, _ = step(memory, sight_of(None), away(1.5))
        off_m.append(memory.depth_m - DEPTH_M)
    assert 0.5 < off_m[0] < 0.9
    assert off_m[-1] > 1.1


def test_a_depth_that_stays_elsewhere_is_believed_within_a_second() -> None:
    memory = known(CAMERA, STANDING_M)
    for _ in range(15):
        memory, _ = step(memory, sight_of(None), away(0.6))
    assert memory.depth_m - DEPTH_M == pytest.approx(0.6, abs=0.1)


@pytest.mark.parametrize("on_floor", [True, False])
def test_a_floor_that_is_assumed_does_not_count(on_floor: bool) -> None:
    sight = sight_of(landmarks(STANDING_M), on_floor=on_floor)
    begun = single_view.begun(sight, STANDING_M)
    assert begun.place is not None
    assert begun.place.depth_m == pytest.approx(DEPTH_M)
    assert (single_view.step(None, begun, sight).alone.place is not begun.place) == on_floor


def test_who_comes_nearer_is_followed_at_their_speed() -> None:
    """1.5 metres a second, without feet, as of who is before a desk."""
    memory = known(CAMERA, STANDING_M)
    for n in range(15):
        memory, _ = step(memory, sight_of(None), away(-0.1 * n))
    assert memory.depth_m - DEPTH_M == pytest.approx(-1.4, abs=0.06)
