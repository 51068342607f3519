"""The shapes in the room, held against the body's own geometry and the cameras' (P55)."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from animator.scene import (
    LEFT,
    PEOPLE,
    RIGHT,
    TRUNK,
    Figure,
    Shapes,
    figure,
    frustum,
    limb_colours,
    limb_shapes,
    round_shapes,
    viewpoint,
)
from animator.solids import Mesh, unit_ball, unit_cylinder
from common.body.body import JOINT_NAMES, LIMBS, POSE_INDEX, POSE_NAMES, Vector, rest_pose
from common.body.kinematics import segments
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import Body
from common.rig.camera import Camera, Rig, centre, paper_rig, project, ray

BDP = thesis_bdp(1.75)
RIG = paper_rig((320, 240), (401.0, 401.0), (4.5, 4.5), (1.0, 1.0))

poses = st.lists(
    st.sampled_from([-180.0, -90.0, 0.0, 90.0, 180.0]) | st.floats(-360.0, 360.0),
    min_size=len(POSE_NAMES),
    max_size=len(POSE_NAMES),
).map(lambda angles: np.array([0.3, 0.9, -0.4, *angles[3:]]))


def placed(mesh: Mesh, shapes: Shapes, i: int) -> NDArray[np.float64]:
    """The vertices of one copy, in the room; turned by scipy, not by us."""
    turn = Rotation.from_quat(shapes.wxyzs[i], scalar_first=True)
    return np.asarray(turn.apply(mesh.vertices * shapes.scales[i]) + shapes.positions[i])


@settings(max_examples=50, deadline=None)
@given(poses)
def test_every_cylinder_stands_between_the_two_ends_of_its_limb(pose: Vector) -> None:
    """P55: the model is drawn from the universal BAPs, in whatever posture."""
    shapes = limb_shapes(Figure(BDP, pose))
    ends = segments(body_vector(BDP), pose)
    for i in range(len(LIMBS)):
        axis = Mesh(np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), unit_cylinder().faces)
        assert np.abs(placed(axis, shapes, i) - ends[i]).max() < 1e-6, LIMBS[i]


def test_a_trunk_is_as_wide_and_as_deep_as_its_two_radii() -> None:
    trunk = placed(unit_cylinder(), limb_shapes(Figure(BDP, rest_pose())), LIMBS.index("torso"))
    assert np.ptp(trunk[:, 0]) == pytest.approx(2 * BDP.torso.long_radius)
    assert np.ptp(trunk[:, 2]) == pytest.approx(2 * BDP.torso.short_radius, rel=0.01)


@settings(max_examples=50, deadline=None)
@given(poses)
def test_the_head_is_round_and_fills_the_way_from_neck_to_crown(pose: Vector) -> None:
    balls = round_shapes(limb_shapes(Figure(BDP, pose)))
    head = placed(unit_ball(), balls, 0)
    neck, crown = segments(body_vector(BDP), pose)[LIMBS.index("head")]
    assert np.linalg.norm(head - neck, axis=1).min() < 1e-6
    assert np.linalg.norm(head - crown, axis=1).min() < 1e-6


def test_the_hands_are_balls_at_the_arms_ends() -> None:
    pose = rest_pose()
    pose[POSE_INDEX["l_elbow_x"]] = 70.0
    ends = segments(body_vector(BDP), pose)[:, 1]
    balls = round_shapes(limb_shapes(Figure(BDP, pose)))
    hands = [ends[LIMBS.index("r_lower_arm")], ends[LIMBS.index("l_lower_arm")]]
    assert np.allclose(balls.positions[-2:], hands)
    assert np.allclose(balls.scales[-2:], BDP.r_lower_arm.radius)


def test_a_ball_closes_the_gap_at_a_bent_elbow() -> None:
    pose = rest_pose()
    pose[POSE_INDEX["r_elbow_x"]] = 90.0
    elbow = segments(body_vector(BDP), pose)[LIMBS.index("r_lower_arm"), 0]
    balls = round_shapes(limb_shapes(Figure(BDP, pose)))
    at = int(np.linalg.norm(balls.positions - elbow, axis=1).argmin())
    assert np.allclose(balls.positions[at], elbow)
    assert np.allclose(balls.scales[at], BDP.r_lower_arm.radius)


@pytest.mark.parametrize("camera", RIG.cameras, ids=["camera 1", "camera 2"])
def test_a_frustum_stands_at_its_camera_and_spans_its_picture(camera: Camera) -> None:
    """Its four corners, seen through the camera, are the corners of the picture (C1)."""
    shape = frustum(camera, (RIG.width, RIG.height))
    turn = Rotation.from_quat(shape.wxyz, scalar_first=True)
    half = np.tan(shape.fov_rad / 2)
    corners = np.array([[shape.aspect * half, half, 1.0], [-shape.aspect * half, -half, 1.0]])
    seen = project(camera, turn.apply(corners) + shape.position)
    assert np.allclose(seen, np.array([[RIG.width, RIG.height], [0, 0]]))
    assert np.allclose(turn.apply([0.0, 0.0, 1.0]), ray(camera, (160.0, 120.0)))


def test_the_papers_frusta_look_along_minus_z_and_plus_x() -> None:
    """C1."""
    looks = [
        Rotation.from_quat(frustum(camera, (320, 240)).wxyz, scalar_first=True).apply([0, 0, 1])
        for camera in RIG.cameras
    ]
    assert np.allclose(looks, [[0, 0, -1], [1, 0, 0]])


def test_the_spectator_looks_the_way_both_cameras_do() -> None:
    """From there both pictures, which hang between camera and body, show their right side."""
    view = viewpoint(RIG)
    assert np.allclose(view.look_at, [0.0, 1.0, 0.0])
    for camera in RIG.cameras:
        half_way = (centre(camera) + view.look_at) / 2
        assert np.array(camera.R[2]) @ (half_way - view.position) > 0.5
    assert view.position[1] > 2.0


def test_one_camera_alone_is_looked_at_from_the_side() -> None:
    """Else its picture would hide the body."""
    alone = viewpoint(Rig(320, 240, RIG.cameras[:1]))
    out = alone.position - alone.look_at
    assert abs(out[0]) > 1.0
    assert out[2] > 1.0


def test_left_and_right_have_their_colours_and_what_is_unsure_fades() -> None:
    sure = limb_colours()
    assert tuple(sure[LIMBS.index("l_upper_arm")]) == LEFT
    assert tuple(sure[LIMBS.index("r_lower_leg")]) == RIGHT
    assert tuple(sure[LIMBS.index("torso")]) == TRUNK
    doubt = tuple(0.0 if name == "r_wrist" else 1.0 for name in JOINT_NAMES)
    changed = (limb_colours(doubt) != sure).any(axis=1)
    assert [limb for limb, other in zip(LIMBS, changed, strict=True) if other] == ["r_lower_arm"]
    assert limb_colours(doubt)[LIMBS.index("r_lower_arm")].min() > 200


def test_a_body_without_pose_or_measures_is_not_drawn() -> None:
    nobody = Body(frame=0, captured_s=0.0, clock_s=0.0, status="empty", views="none")
    unmeasured = Body(
        frame=0, captured_s=0.0, clock_s=0.0, status="tracking", views="1", pose=tuple(rest_pose())
    )
    assert figure(None) is figure(nobody) is figure(unmeasured) is None


def test_people_are_told_apart_by_the_colour_blind_too() -> None:
    """Each pair of colours differs by CIE76 far more than is just noticed (2.3), for eyes without
    red and eyes without green cones. Source of the matrices: Machado, Oliveira & Fernandes 2009."""
    without_red = [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]]
    without_green = [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]]
    values = np.array(PEOPLE) / 255.0
    linear = np.where(values > 0.04045, ((values + 0.055) / 1.055) ** 2.4, values / 12.92)
    for eyes in (np.eye(3), np.array(without_red), np.array(without_green)):
        seen = np.clip(linear @ eyes.T, 0.0, 1.0)
        coded = np.where(seen > 0.0031308, 1.055 * seen ** (1 / 2.4) - 0.055, 12.92 * seen)
        lab = cv2.cvtColor(coded.astype(np.float32)[None], cv2.COLOR_RGB2LAB)[0]
        apart = np.linalg.norm(lab[:, None] - lab, axis=-1) + 999.0 * np.eye(len(lab))
        assert apart.min() > 15.0


def test_a_person_of_several_is_wholly_in_one_colour_and_the_seventh_as_the_first() -> None:
    assert {tuple(colour) for colour in limb_colours(person=2)} == {PEOPLE[1]}
    assert np.array_equal(limb_colours(person=len(PEOPLE) + 1), limb_colours(person=1))
    assert len({tuple(colour) for colour in limb_colours()}) == 3, "one person alone has sides"
