"""Outlines' proposals and pictures' landmarks made one, held against bodies that are known."""

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from staging import PERSON, RIG, observation, silhouettes, standing

from common.body.body import JOINT_NAMES, OTHER_SIDE, POSE_INDEX, rest_pose
from common.body.joint_spread import FIRM_M, PLATT
from common.body.kinematics import joints
from common.body.observation import Landmarks
from common.body.proportions import body_vector
from common.rig.camera import Camera, project
from integrator.landmarks import (
    front_back_flip,
    landmark_fusion,
    limb_springs,
    proposal_residual,
    side_hypotheses,
)
from integrator.landmarks.joint_mixture import (
    LEAST,
    MOST,
    PROPOSED,
    SECOND,
    SHOWN,
    Evidence,
    most_probable,
)
from integrator.landmarks.landmark_rays import AT, Rays, rays_of
from integrator.landmarks.left_right_swap import Exchanged
from integrator.proposal.pose_network import OTHER_SIDES
from integrator.rig.undistortion import undistorted_camera, undistorted_observation

BODY = body_vector(PERSON)
FAR = np.array([0.25, -0.2, 0.1])
LEGS = [i for i, name in enumerate(JOINT_NAMES) if name[2:] in ("hip", "knee", "ankle")]
OTHER_LEGS = [
    JOINT_NAMES.index(("r" if JOINT_NAMES[i][0] == "l" else "l") + JOINT_NAMES[i][1:]) for i in LEGS
]


def walking(yaw_deg: float = 0.0) -> np.ndarray:
    pose = standing(l_hip_x=40.0, l_knee_x=-60.0, r_shoulder_x=50.0)
    pose[POSE_INDEX["torso_y"]] = yaw_deg
    return np.asarray(joints(BODY, pose))


def shown(
    camera: Camera, joints_m: np.ndarray, facing_deg: float = 0.0, sure: float = 0.85
) -> Landmarks:
    places_px = project(camera, joints_m)
    return Landmarks(
        joints_px=tuple((float(x), float(y)) for x, y in places_px),
        confidence=(sure,) * len(JOINT_NAMES),
        facing_deg=facing_deg,
        facing_confidence=0.9,
    )


def rays(
    joints_1_m: np.ndarray, joints_2_m: np.ndarray, facings: tuple[float, float] = (0.0, 90.0)
) -> Rays:
    masks = silhouettes(standing())
    first, second = (
        shown(camera, joints_m, facing)
        for camera, joints_m, facing in zip(
            RIG.cameras, (joints_1_m, joints_2_m), facings, strict=True
        )
    )
    seen = observation(masks[0], landmarks=first), observation(masks[1], landmarks=second)
    found = rays_of(RIG, seen)
    assert found is not None
    return found


def fused(
    proposed_m: np.ndarray, seen: Rays, confidence: float, instants: int = 1
) -> landmark_fusion.Fused:
    memory = None
    for _ in range(instants):
        found = landmark_fusion.step(memory, proposed_m, np.full(12, confidence), seen, 1.75)
        memory = found.memory
    return found


def test_rays_lead_from_the_cameras_through_the_joints() -> None:
    true_m = walking()
    found = rays(true_m, true_m)
    for view in range(2):
        away = true_m[AT] - found.centres_m[view]
        assert np.cross(away, found.directions[view]) == pytest.approx(np.zeros((12, 3)), abs=1e-9)
        assert ((away * found.directions[view]).sum(axis=1) > 0.0).all()


def test_no_view_with_landmarks_gives_no_rays() -> None:
    mask = silhouettes(standing())[0]
    assert rays_of(RIG, (observation(mask), None)) is None


def test_an_arm_that_the_outline_has_wrong_is_where_both_pictures_show_it() -> None:
    true_m = walking()
    proposed_m = true_m[AT].copy()
    wrists = [i for i, at in enumerate(AT) if JOINT_NAMES[at].endswith("wrist")]
    proposed_m[wrists] += FAR
    found = fused(proposed_m, rays(true_m, true_m), 0.6)
    off_m = np.linalg.norm(found.joints_m - true_m[AT], axis=1)
    assert off_m.max() < 0.2 * np.linalg.norm(FAR)
    assert found.confidence.min() > 0.5


def test_a_view_that_exchanges_the_legs_is_found_out() -> None:
    """The other view and the proposal agree: its legs are taken the other way round."""
    true_m = walking()
    mistaken_m = true_m.copy()
    mistaken_m[LEGS] = true_m[OTHER_LEGS]
    found = fused(true_m[AT], rays(true_m, mistaken_m), 0.8)
    assert found.exchanged.arms == (0, 0)
    assert found.exchanged.legs == (0, 1)
    assert np.linalg.norm(found.joints_m - true_m[AT], axis=1).max() < 0.02


def test_views_that_do_not_tell_which_way_somebody_faces_exchange_nothing_by_themselves() -> None:
    """Joints from files may come without a face."""
    true_m = walking()
    untold = rays(true_m, true_m)._replace(facing_confidence=(0.0, 0.0))
    found = fused(true_m[AT], untold, 0.8)
    assert found.exchanged == Exchanged((0, 0), (0, 0))
    assert np.linalg.norm(found.joints_m - true_m[AT], axis=1).max() < 0.02


def test_a_view_that_shows_both_wrists_in_one_place_tells_the_other_as_its_second() -> None:
    """Not exchanged, but doubled: half of what a map shows is of the other side."""
    true_m = walking()
    left, right = JOINT_NAMES.index("l_wrist"), JOINT_NAMES.index("r_wrist")
    doubled_m = true_m.copy()
    doubled_m[left] = true_m[right]
    masks = silhouettes(standing())
    first = msgspec.structs.replace(
        shown(RIG.cameras[0], doubled_m, sure=0.6),
        second_px=shown(RIG.cameras[0], true_m).joints_px,
        second_confidence=(0.3,) * len(JOINT_NAMES),
    )
    second = shown(RIG.cameras[1], true_m)
    seen = rays_of(
        RIG, (observation(masks[0], landmarks=first), observation(masks[1], landmarks=second))
    )
    assert seen is not None
    proposed_m = true_m[AT] + (0.0, 0.0, 0.1)
    found = fused(proposed_m, seen, 0.5)
    at = list(AT).index(left)
    assert np.linalg.norm(found.joints_m[at] - true_m[left]) < 0.05


def test_what_speaks_against_each_other_is_less_sure() -> None:
    true_m = walking()
    agreed = fused(true_m[AT], rays(true_m, true_m), 0.8)
    disputed = fused(true_m[AT], rays(true_m + 0.3, true_m - (0.2, 0.0, 0.2)), 0.8)
    assert agreed.confidence.mean() > 0.9
    assert disputed.confidence.mean() < agreed.confidence.mean()


@pytest.mark.parametrize("yaw_deg", [0.0, 40.0, -30.0])
def test_a_proposal_that_both_faces_contradict_is_turned_and_one_that_they_confirm_is_not(
    yaw_deg: float,
) -> None:
    true_m = walking(yaw_deg)
    facings = [front_back_flip.yaw_deg(np.array(camera.R), true_m[AT]) for camera in RIG.cameras]
    seen = rays(true_m, true_m, (facings[0], facings[1]))
    assert not fused(true_m[AT], seen, 0.8, instants=10).memory.turned[1]
    found = fused(true_m[AT][OTHER_SIDES], seen, 0.8, instants=10)
    assert found.memory.turned[1]
    assert np.linalg.norm(found.joints_m - true_m[AT], axis=1).max() < 0.02


@pytest.mark.parametrize("yaw_deg", [130.0, -140.0, -37.0])
def test_a_proposal_a_quarter_turn_off_costs_no_view_its_sides(yaw_deg: float) -> None:
    """Two views at a right angle: a turned proposal fits one of them with its sides exchanged."""
    true_m, turned_m = walking(yaw_deg), walking(yaw_deg + 90.0)
    plain = rays(true_m, true_m)
    first, second = (front_back_flip.yaw_deg(turn, true_m[AT]) for turn in plain.rotations)
    found = fused(turned_m[AT], rays(true_m, true_m, (first + 17.0, second - 11.0)), 0.86)
    assert found.exchanged == Exchanged((0, 0), (0, 0))
    assert np.linalg.norm(found.joints_m - true_m[AT], axis=1).mean() < 0.05


@pytest.mark.parametrize("seed", range(3))
def test_a_proposal_that_both_faces_deny_again_and_again_takes_no_side(seed: int) -> None:
    """The mirror image across the plane between both views is where the rays meet with one view's
    sides exchanged. Its twelve joints are one error, not twelve votes."""
    true_m, rng = walking(-37.0), np.random.default_rng(seed)
    own = true_m[AT]
    other = own[OTHER_SIDES]
    mirrored_m = np.stack([other[:, 0], (own[:, 1] + other[:, 1]) / 2.0, own[:, 2]], axis=1)
    shown_m = [true_m + rng.normal(0.0, 0.02, true_m.shape) for _ in range(2)]
    turns = rays(true_m, true_m).rotations
    first, second = (front_back_flip.yaw_deg(turn, own) for turn in turns)
    seen = rays(shown_m[0], shown_m[1], (first + 17.0, second - 11.0))
    found = fused(mirrored_m, seen, 0.86, 5)
    assert found.exchanged == Exchanged((0, 0), (0, 0))
    assert np.linalg.norm(found.joints_m - own, axis=1).mean() < 0.05


def test_a_sure_view_is_hardly_ever_confused_and_an_unsure_one_half_the_time() -> None:
    """Rates of made-up people whom views are so sure of: 37, 15, 8 and .1 %."""
    rates = [front_back_flip.confused(sure) for sure in (0.54, 0.64, 0.7, 0.92)]
    assert rates == pytest.approx([0.37, 0.15, 0.08, 0.001], abs=0.02)
    assert front_back_flip.confused(1.0) < 1e-9
    assert front_back_flip.confused(0.2) == 0.5
    assert front_back_flip.confused(0.0) == front_back_flip.UNTOLD


def raising(side: str) -> np.ndarray:
    """One arm raised to its front and side, by half a metre."""
    raised_m = walking()
    arm = [JOINT_NAMES.index(f"{side}_{name}") for name in ("elbow", "wrist")]
    shoulder_m = raised_m[JOINT_NAMES.index(f"{side}_shoulder")]
    raised_m[arm] = shoulder_m + np.array([[-0.2, 0.2, 0.0], [-0.4, 0.4, 0.0]])
    return raised_m


def test_a_turned_proposal_does_not_exchange_the_arms_that_both_views_show() -> None:
    """Turned about and back again it raises the other arm, as surely as ever."""
    true_m, proposed_m = raising("r"), raising("l")
    facings = [front_back_flip.yaw_deg(np.array(camera.R), true_m[AT]) for camera in RIG.cameras]
    seen = rays(true_m, true_m, (facings[0], facings[1]))
    found = fused(proposed_m[AT][OTHER_SIDES], seen, 0.8, instants=10)
    assert found.memory.turned[1]
    assert found.exchanged.arms == (0, 0)
    assert np.linalg.norm(found.joints_m - true_m[AT], axis=1).max() < 0.05


def test_a_camera_that_takes_front_for_back_by_itself_turns_nobody() -> None:
    """Front and back are confused by one view often, a profile's left and right by none."""
    true_m = walking()
    facing_2 = front_back_flip.yaw_deg(np.array(RIG.cameras[1].R), true_m[AT])
    found = fused(true_m[AT], rays(true_m, true_m, (180.0, facing_2)), 0.8, instants=30)
    assert not found.memory.turned[1]


def test_facing_is_zero_towards_the_camera_and_ninety_to_the_right_of_its_picture() -> None:
    pose = rest_pose()
    first = RIG.cameras[0]
    assert front_back_flip.yaw_deg(np.array(first.R), joints(BODY, pose)[AT]) == pytest.approx(
        0.0, abs=1.0
    )
    pose[POSE_INDEX["torso_y"]] = 90.0
    turned_m = joints(BODY, pose)[AT]
    nose_m = turned_m.mean(axis=0) + np.array([1.0, 0.0, 0.0])
    to_right = (
        project(first, nose_m[None])[0, 0] > project(first, turned_m.mean(axis=0)[None])[0, 0]
    )
    assert front_back_flip.yaw_deg(np.array(first.R), turned_m) == pytest.approx(
        90.0 if to_right else -90.0, abs=1.0
    )


def test_landmarks_of_a_lens_that_bends_are_straightened_with_the_outline() -> None:
    bent = msgspec.structs.replace(RIG.cameras[0], distortion=(-0.2, 0.05, 0.0, 0.0, 0.0))
    true_m = walking()
    seen, second_m = shown(bent, true_m), true_m[OTHER_SIDE]
    second_px = shown(bent, second_m).joints_px
    seen = msgspec.structs.replace(seen, second_px=second_px, second_confidence=seen.confidence)
    told = observation(silhouettes(standing())[0], landmarks=seen)
    straight = undistorted_observation(told, bent).landmarks
    assert straight is not None
    ideal = undistorted_camera(bent)
    assert np.array(straight.joints_px) == pytest.approx(project(ideal, true_m), abs=0.05)
    assert np.array(straight.second_px) == pytest.approx(project(ideal, second_m), abs=0.05)
    assert straight.extremities_px == ()


@given(st.floats(-180.0, 180.0), st.floats(31.0, 180.0), st.sampled_from([-1.0, 1.0]))
def test_a_picture_turned_upright_says_which_way_somebody_faces(
    yaw_deg: float, roll_deg: float, way: float
) -> None:
    """Of who leans by more than 30 degrees in it (`Landmarks.facing_deg`)."""
    pose = standing()
    pose[POSE_INDEX["torso_y"]] = yaw_deg
    joints_m = np.asarray(joints(BODY, pose))[AT]
    level = np.array(RIG.cameras[0].R)
    a = way * np.radians(roll_deg)
    rolled = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]) @ level
    off_deg = front_back_flip.yaw_deg(rolled, joints_m) - front_back_flip.yaw_deg(level, joints_m)
    assert np.cos(np.radians(off_deg)) == pytest.approx(1.0, abs=1e-3)


def drawn_rays(seed: int) -> Rays:
    """Views that see joints where they may be, and others, each as surely as it likes."""
    rng, true_m = np.random.default_rng(seed), walking()
    found = rays(true_m + rng.normal(0.0, 0.03, (15, 3)), true_m + rng.normal(0.0, 0.03, (15, 3)))
    others = rays(true_m + 0.1, true_m - 0.1).directions
    sure, second = rng.uniform(0.1, 0.9, (2, 12)), rng.uniform(0.0, 0.3, (2, 12))
    second[:, 3] = 0.9 * SECOND
    sure[0, 5] = 0.0
    return found._replace(confidence=sure, others=others, others_confidence=second)


@pytest.mark.slow
def test_each_joint_is_looked_for_with_both_sides_of_either_view() -> None:
    """`most_probable` of what is said of it, joint by joint, for all that may be exchanged."""
    seen, rng = drawn_rays(1), np.random.default_rng(2)
    confidence, wider_m = rng.uniform(0.1, 0.95, 12), rng.uniform(0.0, 0.05, 12)
    proposal = side_hypotheses.Proposal(walking()[AT], confidence, wider_m, 0.7)
    ways = np.array(list(np.ndindex(2, 2)))
    weighed = side_hypotheses.weighed(proposal, seen, 1.75, np.stack([ways, ways]))
    values, places_m, precisions = (each.reshape(12, 2, 2, *each.shape[2:]) for each in weighed)

    def share(sure: float, between: tuple[float, float]) -> float:
        return float(np.clip((sure - between[0]) / (between[1] - between[0]), LEAST, MOST))

    for joint, first, second in np.ndindex(12, 2, 2):
        at = [(view, joint ^ side) for view, side in enumerate((first, second))]
        inliers = np.zeros((2, 2))
        for view, own in at:
            sure = seen.confidence[view, own]
            inliers[view, 0] = share(sure, side_hypotheses.SHOWN_RIGHT) if sure else 0.0
            other = seen.others_confidence[view, own]
            inliers[view, 1] = min(other if other >= SECOND else 0.0, MOST - inliers[view, 0])
        sure = float(confidence[joint])
        right_m = PROPOSED.right + PROPOSED.unsure * (1.0 - sure)
        shown = [1.75 * (SHOWN.right + SHOWN.unsure * (1.0 - seen.confidence[each])) for each in at]
        witnesses = Evidence(
            proposal.joints_m[joint],
            share(sure, side_hypotheses.PROPOSED_RIGHT),
            seen.centres_m,
            np.array([[seen.directions[each], seen.others[each]] for each in at]),
            inliers,
            np.array([np.hypot(right_m, wider_m[joint]), *shown]),
            float(np.hypot(PROPOSED.roughly, wider_m[joint])),
            0.7,
            1.75,
        )
        place_m, precision = np.empty(3), np.empty(6)
        value = most_probable(witnesses, place_m, precision)
        assert values[joint, first, second] == pytest.approx(value)
        assert places_m[joint, first, second] == pytest.approx(place_m)
        assert precisions[joint, first, second] == pytest.approx(precision)


def test_the_tighter_a_joint_is_held_the_surer_it_is() -> None:
    """At FIRM_M as sure as Platt's offset says; doubt lowers odds by so many times."""
    precision = np.array([[1 / FIRM_M**2, 0.0, 0.0, 1 / FIRM_M**2, 0.0, 1 / FIRM_M**2]])
    certain, steep = PLATT
    for wider in (1.0, 3.0):
        sure = landmark_fusion._confidence(precision / wider**2)[0]
        assert np.log(sure / (1.0 - sure)) == pytest.approx(certain - steep * np.log(wider))
    doubted = landmark_fusion._doubted(0.8, 5.0)
    assert doubted / (1.0 - doubted) == pytest.approx(0.8 / 0.2 / 5.0)


@pytest.mark.parametrize("yaw_deg", [0.0, 30.0, 90.0])
def test_a_view_sees_a_profile_by_how_far_the_girdles_point_along_its_sight(
    yaw_deg: float,
) -> None:
    """0 of a front; 1 of a profile."""
    joints_m = walking(yaw_deg)[AT]
    centres_m = rays(walking(), walking()).centres_m
    found = landmark_fusion._aside(joints_m, centres_m)
    sine = abs(np.sin(np.radians(yaw_deg)))
    assert found[0] == pytest.approx(sine, abs=0.06)
    assert found[1] == pytest.approx(np.sqrt(1.0 - sine**2), abs=0.06)


def test_what_is_remembered_is_each_steps_own() -> None:
    """Two instants: the second begins with what the first left of each."""
    joints_m = walking()[AT]
    seen = rays(walking(), walking())
    one = fused(joints_m, seen, 0.6)
    turned = front_back_flip.step(None, joints_m, seen)
    assert one.memory.turned == turned
    misfit = proposal_residual.step(None, joints_m, seen, 1.75)
    for own, due in zip(one.memory.misfit, misfit, strict=True):
        assert np.array_equal(np.asarray(own), np.asarray(due))
    assert one.memory.lengths_m is not None
    assert one.memory.lengths_m == pytest.approx(limb_springs.lengths_m(None, one.joints_m, 1.75))
    two = landmark_fusion.step(one.memory, joints_m, np.full(12, 0.6), seen, 1.75)
    assert two.memory.turned == front_back_flip.step(one.memory.turned, joints_m, seen)
