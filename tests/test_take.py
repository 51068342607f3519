"""What a run leaves open, and what notes make of it (T21, T22, T26)."""

import numpy as np
import pytest

from animator.take import (
    Take,
    depth_of,
    doubts_at,
    hidden_of,
    leaned,
    next_doubtful,
    take_of,
    with_notes,
)
from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS, POSE_INDEX, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.notes.notes import Auto, Depth, Note, Notes, held

ARM = LIMBS.index("l_upper_arm")
WRIST = JOINT_NAMES.index("l_wrist")


def body(**angles_deg: float) -> np.ndarray:
    pose = rest_pose()
    for name, angle in angles_deg.items():
        pose[POSE_INDEX[name]] = angle
    return np.asarray(joints(body_vector(thesis_bdp(1.7)), pose))


def take(n: int = 12) -> Take:
    """Ten frames an arm lifted to the camera, every second frame of a video; sure of all."""
    poses = {
        "frame": 2 * np.arange(n),
        "joints_px": np.tile(np.arange(30.0).reshape(15, 2), (n, 2, 1, 1)),
        "joints_m": np.tile(body(l_shoulder_x=60.0), (n, 1, 1)),
        "confidence": np.ones((n, 15)),
        "orientation": np.full(n, "forward_left"),
    }
    return take_of(poses, px_scale=2.0)


def test_pixels_are_those_of_the_video() -> None:
    assert take().joints_px[0, 3].tolist() == [12.0, 14.0]


def test_a_frame_asks_about_what_is_not_sure_the_least_sure_first() -> None:
    seen = take()
    seen.orientation_confidence[3] = 0.6
    seen.depth_confidence[3, ARM] = 0.5
    seen.confidence[3, WRIST] = 0.1
    asked = [(doubt.kind, doubt.name) for doubt in doubts_at(seen, 3, Notes())]
    assert asked == [
        ("joint", "l_wrist"),
        ("depth", "l_upper_arm"),
        ("orientation", "forward_left"),
    ]
    assert doubts_at(seen, 2, Notes()) == []


def test_a_frame_whose_body_was_lost_opens_with_the_nearest_one() -> None:
    n = 6
    places = np.arange(float(n))[:, None, None, None] + np.zeros((n, 2, 15, 2))
    bodies = places[:, 0, :, [0, 0, 0]].transpose(1, 2, 0).copy()
    lost = np.array(["tracking", "lost", "lost", "lost", "tracking", "empty"])
    bodies[lost != "tracking"] = np.nan
    seen = take_of(
        {
            "frame": np.arange(n),
            "joints_px": places,
            "joints_m": bodies,
            "confidence": np.zeros((n, 15)),
            "status": lost,
        }
    )
    assert seen.joints_m[:5, 0, 0].tolist() == [0.0, 0.0, 0.0, 4.0, 4.0]
    assert seen.joints_px[:5, 0, 0].tolist() == [0.0, 0.0, 0.0, 4.0, 4.0]
    assert seen.posed.tolist() == [True] * 5 + [False]


def test_what_the_user_settled_is_not_asked_again() -> None:
    seen = take()
    seen.orientation_confidence[:] = seen.depth_confidence[:] = 0.5
    seen.confidence[:, WRIST] = 0.1
    lifted: dict[str, Depth | Auto] = {"l_upper_arm": "toward", "l_lower_arm": "toward"}
    notes = Notes(note=(Note(6, "left", lifted, {"l_wrist": (1.0, 1.0)}),))
    assert doubts_at(seen, 3, notes) == []
    assert len(doubts_at(seen, 2, notes)) == 4


def test_a_segment_in_the_pictures_plane_is_no_question() -> None:
    """T19: near the plane the direction moves nobody, and a pixel changes it."""
    seen = take()
    seen.depth_confidence[:] = 0.5
    assert {doubt.name for doubt in doubts_at(seen, 0, Notes())} == {"l_upper_arm", "l_lower_arm"}


def test_a_frame_without_a_pose_asks_nothing() -> None:
    seen = take()
    seen.joints_m[4] = np.nan
    seen.orientation_confidence[4] = 0.0
    assert doubts_at(seen, 4, Notes()) == []


def test_the_next_uncertain_frame_is_the_first_with_another_question() -> None:
    seen = take()
    seen.depth_confidence[3:6, ARM] = 0.5
    seen.orientation_confidence[5:8] = 0.5
    seen.confidence[10, WRIST] = 0.0
    visited = [0]
    while (row := next_doubtful(seen, visited[-1], Notes())) is not None:
        visited.append(row)
    assert visited == [0, 3, 5, 6, 10]
    assert next_doubtful(seen, 10, Notes(), -1) == 7
    assert next_doubtful(seen, 3, Notes(), -1) is None
    settled = Notes(note=(Note(0, "left", {"l_upper_arm": "toward"}),))
    assert next_doubtful(seen, 0, settled) == 10


def test_notes_are_laid_over_the_stick_and_the_body() -> None:
    notes = Notes(note=(Note(4, None, {"l_upper_arm": "away"}, {"l_wrist": (5.0, 6.0)}),))
    joints_px, joints_m = with_notes(take(), 2, held(notes, 4))
    assert joints_px[WRIST].tolist() == [5.0, 6.0]
    assert joints_m[WRIST, 2] < 0.0
    before = with_notes(take(), 1, held(notes, 2))
    assert np.array_equal(before[0], take().joints_px[1])
    assert np.array_equal(before[1], take().joints_m[1])


@pytest.mark.parametrize("limb", LIMBS)
def test_a_segment_that_leans_the_other_way_keeps_its_length_and_its_place_in_the_picture(
    limb: str,
) -> None:
    """T21: two solutions a segment, that differ by the sign of the depth alone (eq. 2.2)."""
    bent = body(l_shoulder_x=50.0, r_hip_x=40.0, r_knee_x=-60.0, torso_x=20.0, l_elbow_x=40.0)
    away = leaned(bent, {limb: "away"})
    near, far = LIMB_ENDS[LIMBS.index(limb)]
    assert np.array_equal(away[:, :2], bent[:, :2])
    assert away[far, 2] <= away[near, 2]
    for start, end in LIMB_ENDS:
        assert np.linalg.norm(away[end] - away[start]) == pytest.approx(
            np.linalg.norm(bent[end] - bent[start])
        )
    assert np.allclose(leaned(away, {limb: "toward"}), leaned(bent, {limb: "toward"}))


def test_what_hangs_on_a_segment_moves_with_it() -> None:
    bent = body(torso_x=30.0, l_shoulder_x=60.0)
    away = leaned(bent, {"torso": "away"})
    elbow, neck = JOINT_NAMES.index("l_elbow"), JOINT_NAMES.index("neck")
    assert away[elbow, 2] - away[neck, 2] == pytest.approx(bent[elbow, 2] - bent[neck, 2])


@pytest.mark.parametrize(("confidence", "asked"), [(0.69, True), (0.71, False)])
def test_seven_tenths_are_sure_enough(confidence: float, asked: bool) -> None:
    seen = take()
    seen.orientation_confidence[3] = seen.depth_confidence[3, ARM] = confidence
    kinds = [doubt.kind for doubt in doubts_at(seen, 3, Notes())]
    assert kinds == (["orientation", "depth"] if asked else [])


def test_a_joint_is_hidden_that_keeps_less_than_three_tenths_of_the_one_before_it() -> None:
    near = int(LIMB_ENDS[LIMBS.index("l_lower_arm"), 0])
    confidence = np.full((2, 15), 0.8)
    confidence[:, near] = 0.5
    confidence[:, WRIST] = 0.149, 0.151
    hidden = hidden_of(confidence)
    assert np.argwhere(hidden).tolist() == [[0, LIMBS.index("l_lower_arm")]]


@pytest.mark.parametrize(("lean_deg", "sign"), [(14.0, 0.0), (16.0, 1.0), (-16.0, -1.0)])
def test_fifteen_degrees_out_of_the_picture_are_a_lean(lean_deg: float, sign: float) -> None:
    joints_m = np.zeros((1, 15, 3))
    near, far = LIMB_ENDS[ARM]
    joints_m[0, far] = joints_m[0, near] + (
        0.3 * np.cos(np.radians(lean_deg)),
        0.0,
        0.3 * np.sin(np.radians(lean_deg)),
    )
    assert depth_of(joints_m)[0, ARM] == sign


def test_a_run_is_told_as_its_camera_sees_it() -> None:
    """A camera on +x that looks along -x: its right is -z, what comes nearer goes along +x."""
    poses = {
        "frame": np.arange(1),
        "joints_px": np.arange(60.0).reshape(1, 2, 15, 2),
        "joints_m": np.tile([1.0, 2.0, 3.0], (1, 15, 1)),
        "confidence": np.ones((1, 15)),
    }
    turn = ((0.0, 0.0, -1.0), (0.0, -1.0, 0.0), (-1.0, 0.0, 0.0))
    seen = take_of(poses, 3.0, turn)
    assert seen.joints_m[0, 4].tolist() == [-3.0, 2.0, 1.0]
    assert seen.joints_px[0, 4].tolist() == [24.0, 27.0], "camera 1's"
    assert seen.orientation.tolist() == [""]
    assert (seen.orientation_confidence == 1).all()
    assert seen.depth_confidence.tolist() == [[1.0] * len(LIMBS)]
