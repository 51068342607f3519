"""What has the same outline, held against the projection and the drawn body (T21, T22, L4)."""

import numpy as np
import pytest

from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS, POSE_INDEX, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.notes.notes import Orientation
from common.rig.camera import paper_rig, project
from integrator.single.reflection import (
    ANEW_ASIDE_HZ,
    ANEW_HZ,
    CERTAIN,
    PROPOSED_HZ,
    SHOWN_HZ,
    SIDEWAYS_DEG,
    SUREST,
    Front,
    agrees,
    as_deep,
    as_shown,
    faces,
    front_of,
    leaning,
    mirrored,
    seen_from_behind,
    yaw_deg,
)

CAMERA = paper_rig((160, 120), (200.0, 200.0), (4.375, 4.375)).cameras[0]
AT = {name: i for i, name in enumerate(JOINT_NAMES)}


def body(yaw: float) -> np.ndarray:
    pose = rest_pose()
    pose[POSE_INDEX["torso_y"]] = yaw
    pose[POSE_INDEX["r_shoulder_x"]] = 60.0
    pose[POSE_INDEX["l_hip_x"]], pose[POSE_INDEX["l_knee_x"]] = 50.0, -60.0
    return np.asarray(joints(body_vector(thesis_bdp(1.75)), pose))


def test_joints_as_deep_as_others_stay_in_the_picture() -> None:
    seen, other = body(20.0), body(60.0) + np.array([0.2, 0.1, 0.3])
    moved = as_deep(CAMERA, seen, other)
    assert project(CAMERA, moved) == pytest.approx(project(CAMERA, seen))
    forward = np.array(CAMERA.R)[2]
    assert moved @ forward == pytest.approx(other @ forward)


@pytest.mark.parametrize("yaw", [-140.0, -40.0, 20.0, 120.0])
def test_from_behind_it_is_the_same_picture_and_faces_the_other_way(yaw: float) -> None:
    """L4: front and back cannot be told apart; sides change with them."""
    seen = body(yaw)
    other = seen_from_behind(CAMERA, seen)
    swapped = [AT[{"l_": "r_", "r_": "l_"}.get(n[:2], n[:2]) + n[2:]] for n in JOINT_NAMES]
    assert project(CAMERA, other)[swapped] == pytest.approx(project(CAMERA, seen))
    turned = yaw_deg(CAMERA, other)
    assert np.sign(turned) == np.sign(yaw)
    assert abs(turned) == pytest.approx(180.0 - abs(yaw), abs=5.0)


def test_a_limb_leans_as_told_and_is_seen_where_it_was() -> None:
    """T21: an arm that points to the camera points away from it, its hand too."""
    seen = body(0.0)
    other = leaning(CAMERA, seen, {"r_upper_arm": "away", "l_upper_leg": "toward"})
    assert project(CAMERA, other) == pytest.approx(project(CAMERA, seen))
    for near, far in (("r_shoulder", "r_elbow"), ("r_elbow", "r_wrist")):
        before, after = (j[AT[far], 2] - j[AT[near], 2] for j in (seen, other))
        assert (after < 0 < before) if far == "r_elbow" else after == pytest.approx(before, abs=0.1)
    assert other[AT["l_ankle"]] == pytest.approx(seen[AT["l_ankle"]])


def test_the_six_ways_are_named_by_the_yaw() -> None:
    """T22."""
    named = {-40.0: "forward_left", -90.0: "left", -140.0: "backward_left", 75.0: "right"}
    assert {yaw: faces(yaw) for yaw in named} == named
    assert faces(140.0) == "backward_right"
    assert agrees(-60.0, "left")
    assert not agrees(60.0, "left")


def after(front: Front, yaw: float, shown: tuple[float, float] | None, times: int) -> Front:
    for _ in range(times):
        front, _ = front_of(front, yaw, shown, None, 0.1)
    return front


def test_front_turns_to_back_through_the_side_alone() -> None:
    """A proposal that jumps from front to back is seen from behind; through the side it is not."""
    facing = after(Front(), 5.0, None, 10)
    assert front_of(facing, 150.0, None, None, 0.1)[1]
    aside = after(facing, 100.0, None, 10)
    assert not front_of(aside, 100.0, None, None, 0.1)[1]
    assert not front_of(aside, 150.0, None, None, 0.1)[1]


def test_who_insists_is_believed_and_the_user_at_once() -> None:
    facing = after(Front(), 5.0, None, 40)
    assert front_of(after(facing, 150.0, None, 10), 150.0, None, None, 0.1)[1]
    assert not front_of(after(facing, 150.0, None, 40), 150.0, None, None, 0.1)[1]
    assert not front_of(facing, 150.0, None, "backward_right", 0.1)[1]
    assert front_of(facing, 150.0, None, "forward_right", 0.1)[1]
    assert not front_of(facing, 150.0, None, "left", 0.1)[1]


def test_a_first_picture_that_surely_shows_a_back_is_believed_and_no_proposal_insists() -> None:
    front = Front()
    for _ in range(40):  # 4 s
        front, behind = front_of(front, -5.0, (-150.0, 0.9), None, 0.1)
        assert behind
    assert after(front, -5.0, None, 5).away > 0.5


def test_a_picture_that_shows_a_profile_or_is_not_sure_tells_nothing() -> None:
    for shown in ((90.0, 0.9), (-90.0, 0.9), (180.0, 0.5), (180.0, 0.1)):
        assert after(Front(), 5.0, shown, 5).away == pytest.approx(
            after(Front(), 5.0, None, 5).away
        )


def test_a_picture_turns_somebody_about_only_after_a_while_who_was_not_seen_from_the_side() -> None:
    """Landmarks take front for back for some frames at a time, and nobody turns at once."""
    facing = after(Front(), 5.0, (10.0, 0.9), 40)
    assert after(facing, 5.0, (170.0, 0.9), 3).away < 0.5
    assert after(facing, 5.0, (170.0, 0.9), 12).away > 0.5
    aside = after(facing, 95.0, None, 10)
    assert after(aside, 5.0, (170.0, 0.9), 3).away > 0.5


@pytest.mark.parametrize("yaw", [-90.0, -60.0, 75.0])
def test_a_profile_that_the_picture_surely_has_the_other_way_is_mirrored_in_depth(
    yaw: float,
) -> None:
    """Left and right stay where they are seen."""
    seen = body(yaw)
    other = as_shown(CAMERA, seen, (-yaw, 0.9))
    assert project(CAMERA, other) == pytest.approx(project(CAMERA, seen))
    assert yaw_deg(CAMERA, other) == pytest.approx(-yaw_deg(CAMERA, seen), abs=6.0)
    for shown in (None, (-yaw, 0.7), (yaw, 0.9), (yaw / 2, 0.9)):
        assert as_shown(CAMERA, seen, shown) is seen


@pytest.mark.parametrize("facing", [0.0, 180.0])
def test_a_picture_after_a_minute_without_one_is_believed(facing: float) -> None:
    """A viewer that was started again, a camera that stood still."""
    front, _ = front_of(Front(0.9), 5.0, (facing, 0.97), None, 60.0)
    assert (front.away > 0.5) == (facing == 180.0)
    assert after(front, 5.0, (180.0 - facing, 0.97), 40).away == pytest.approx(
        float(facing == 0.0), abs=0.1
    )


@pytest.mark.parametrize("way", ["toward", "away"])
@pytest.mark.parametrize("limb", ["l_upper_arm", "r_lower_leg", "l_upper_leg"])
def test_a_segment_that_leans_as_annotated_leans_by_as_much_as_before(limb: str, way: str) -> None:
    """In depth its far end is as far from its near one, the other way or the same."""
    seen = body(30.0)
    moved = leaning(CAMERA, seen, {limb: way})
    near, far = LIMB_ENDS[LIMBS.index(limb)]
    forward = np.array(CAMERA.R)[2]
    before, after = ((each[far] - each[near]) @ forward for each in (seen, moved))
    assert after == pytest.approx(abs(before) * (1.0 if way == "away" else -1.0))
    assert project(CAMERA, moved) == pytest.approx(project(CAMERA, seen))
    other = mirrored(CAMERA, seen, LIMBS.index(limb))
    assert (other[far] - other[near]) @ forward == pytest.approx(-before)


def expected_front(
    away: float, yaw: float, shown: tuple[float, float] | None, dt_s: float
) -> float:
    """The same by odds."""
    aside = abs(abs(yaw) - 90.0) <= SIDEWAYS_DEG
    anew = 1.0 - np.exp(-dt_s * (ANEW_ASIDE_HZ if aside else ANEW_HZ))
    away += anew * (0.5 - away)
    said = 0.0 if aside else (PROPOSED_HZ if abs(yaw) > 90.0 else -PROPOSED_HZ)
    if shown is not None and shown[1] > 0.5:
        sure = min(shown[1], SUREST)
        said -= SHOWN_HZ * np.log(sure / (1.0 - sure)) * np.cos(np.radians(shown[0]))
    odds = away / (1.0 - away) * np.exp(np.clip(said * dt_s, -CERTAIN, CERTAIN))
    return float(odds / (1.0 + odds))


@pytest.mark.parametrize("yaw", [-160.0, -95.0, 20.0, 75.0])
@pytest.mark.parametrize("shown", [None, (10.0, 0.4), (20.0, 0.6), (150.0, 0.99)])
@pytest.mark.parametrize("dt_s", [1 / 15, 30.0])
def test_front_or_back_is_a_model_of_two_states(
    yaw: float, shown: tuple[float, float] | None, dt_s: float
) -> None:
    for away in (0.2, 0.45, 0.9):
        now, behind = front_of(Front(away), yaw, shown, None, dt_s)
        wanted = expected_front(away, yaw, shown, dt_s)
        assert now.away == pytest.approx(wanted, abs=1e-12)
        aside = abs(abs(yaw) - 90.0) <= SIDEWAYS_DEG
        assert behind == (not aside and (wanted > 0.5) != (abs(yaw) > 90.0))


@pytest.mark.parametrize(
    ("named", "away", "behind_at"),
    [("left", 0.5, ()), ("right", 0.5, ()), ("forward_left", 0.0, (150.0,)),
     ("backward_right", 1.0, (30.0,))],
)  # fmt: skip
def test_the_users_word_settles_front_and_back(
    named: Orientation, away: float, behind_at: tuple[float, ...]
) -> None:
    for yaw in (30.0, 150.0):
        now, behind = front_of(Front(0.3), yaw, (0.0, 0.9), named, 1 / 15)
        assert now.away == away
        assert behind == (yaw in behind_at)
