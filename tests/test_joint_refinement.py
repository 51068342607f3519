"""A body of one view turned to its outline, against bodies that are drawn here (3.1.4)."""

import msgspec
import numpy as np
import pytest
from test_single_view import CAMERA, HEIGHT, WIDTH, report_of

from common.body.body import JOINT_NAMES, LIMB_ENDS, POSE_INDEX, Vector, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.body.stick_body import ADULT, POSE_SIZE, STATURE
from common.bus.message_codec import pack
from common.bus.messages import Report
from common.raster.bits import unpack_words
from common.raster.stick_raster import ALL_SEGMENTS, draw_segments
from common.rig.camera import project
from integrator.fit.joint_refinement import GOOD, Match, PosedBody, matched

BDP = thesis_bdp(1.75)
BODY = body_vector(BDP)
TALL_PX = 80.0
AT = {name: i for i, name in enumerate(JOINT_NAMES)}


def posed(**angles_deg: float) -> Vector:
    pose = rest_pose()
    pose[1] = 0.9
    for name, angle_deg in angles_deg.items():
        pose[POSE_INDEX[name]] = angle_deg
    return pose


def report_on(pose: Vector) -> Report:
    """What the camera shows of a body in a pose."""
    places = project(CAMERA, joints(BODY, pose))
    lines = [[AT["r_shoulder"], AT["l_shoulder"]], [AT["r_hip"], AT["l_hip"]]]
    ends = places[np.concatenate([LIMB_ENDS, lines])].reshape(12, 4)
    stick = np.ones(POSE_SIZE)
    stick[STATURE] = TALL_PX
    bits = np.zeros((HEIGHT, (WIDTH + 63) // 64), np.uint64)
    draw_segments(ends, stick, ADULT.parts, ADULT.depth, ALL_SEGMENTS, WIDTH, bits)
    mask = unpack_words(bits, WIDTH)
    return msgspec.structs.replace(report_of(ADULT), silhouette=pack(mask))


def fitted(seen: Vector, start: Vector, turning: bool = True) -> Match:
    report = report_on(seen)
    return matched(CAMERA, BDP, ADULT, report, PosedBody(start, joints(BODY, start)), turning)


def test_the_body_that_was_drawn_fits_and_is_left_alone() -> None:
    """S is 1 where model and silhouette are one (eq. 1)."""
    pose = posed(r_shoulder_z=80.0, l_hip_z=200.0)
    found = fitted(pose, pose)
    assert found.score == pytest.approx(1.0, abs=0.02)
    assert np.array_equal(found.pose, pose)


def test_a_body_that_fits_badly_is_turned_to_its_outline() -> None:
    seen = posed(r_shoulder_z=80.0, l_shoulder_z=270.0, l_hip_z=215.0)
    start = posed(r_shoulder_z=110.0, l_shoulder_z=245.0, l_hip_z=200.0)
    as_it_was, found = fitted(seen, start, turning=False), fitted(seen, start)
    assert as_it_was.score < GOOD < found.score
    assert np.array_equal(as_it_was.pose, start)
    for name in ("r_elbow", "l_elbow", "l_knee"):
        off, was = (
            np.linalg.norm((joints(BODY, pose) - joints(BODY, seen))[AT[name]])
            for pose in (found.pose, start)
        )
        assert off < 0.5 * was
    assert found.joints_m == pytest.approx(joints(BODY, found.pose))


def test_it_is_turned_no_further_than_joints_go() -> None:
    """A knee that the outline wants bent forwards stays straight."""
    seen = posed(torso_y=90.0, r_hip_x=-20.0, l_hip_x=-20.0, r_shoulder_x=60.0)
    start = posed(torso_y=90.0)
    found = fitted(seen, start)
    assert found.pose[POSE_INDEX["r_knee_x"]] <= 0.0
    assert found.pose[POSE_INDEX["r_shoulder_z"]] <= 180.0
