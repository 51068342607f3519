"""Drawn hands and feet, held against the arms and legs that they hang on."""

import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from show_page import ANKLE_M, snapshot_at

from animator.hands_and_feet import FOOT_THICK, HAND_THICK, hands_and_feet
from animator.scene import LEFT, UNSURE, Figure, Shapes, limb_shapes
from common.body.body import LIMBS
from common.body.extremities import ALL_JOINT_NAMES
from common.body.kinematics import segments
from common.body.proportions import body_vector
from common.bus.messages import Body


def drawn(body: Body) -> tuple[Shapes, np.ndarray]:
    """Hands and feet, and both ends of the limbs, (10, 2, 3)."""
    assert body.bdp is not None
    pose = np.array(body.pose)
    shapes = hands_and_feet(body, limb_shapes(Figure(body.bdp, pose)))
    return shapes, np.asarray(segments(body_vector(body.bdp), pose))


def standing() -> Body:
    body = snapshot_at(0).body
    assert body is not None
    return body


def test_an_arm_goes_on_into_its_hand() -> None:
    """The hand's axis begins at the wrist and has the forearm's direction."""
    shapes, limbs = drawn(standing())
    for row, name in ((0, "r_lower_arm"), (1, "l_lower_arm")):
        elbow, wrist = limbs[LIMBS.index(name)]
        turn = Rotation.from_quat(shapes.wxyzs[row], scalar_first=True)
        along = turn.apply((0.0, shapes.scales[row, 1], 0.0))
        assert shapes.positions[row] - along == pytest.approx(wrist, abs=1e-6)
        assert np.dot(along, wrist - elbow) > 0.99 * np.linalg.norm(along) * np.linalg.norm(
            wrist - elbow
        )


def test_feet_point_ahead_above_the_floor() -> None:
    """A body at rest faces +z."""
    shapes, limbs = drawn(standing())
    for row, name in ((2, "r_lower_leg"), (3, "l_lower_leg")):
        ankle = limbs[LIMBS.index(name), 1]
        assert shapes.positions[row, 2] > ankle[2] + 0.05
        assert 0.0 < shapes.positions[row, 1] < ANKLE_M


def test_limbs_that_are_drawn_beside_the_joints_take_their_ends_along() -> None:
    body = standing()
    there, _ = drawn(body)
    pose = np.array(body.pose)
    pose[0] += 0.02
    beside, _ = drawn(msgspec.structs.replace(body, pose=tuple(pose.tolist())))
    assert beside.positions - there.positions == pytest.approx(np.tile((0.02, 0.0, 0.0), (4, 1)))


def test_what_nobody_measured_is_pale() -> None:
    shapes, _ = drawn(standing())
    assert shapes.colours[1].tolist() == list(UNSURE)
    faint = np.abs(shapes.colours[3].astype(int) - LEFT).max()
    assert 0 < faint < 60, "a toe that is 0.8 sure"


def test_a_hand_and_a_foot_are_as_thick_as_their_lengths_say() -> None:
    """Eggs that are round about their axis; half a foot is longer than half a hand."""
    shapes, _ = drawn(standing())
    wide, half, deep = shapes.scales.T
    assert wide == pytest.approx(deep)
    assert wide[:2] / half[:2] == pytest.approx([HAND_THICK] * 2)
    assert wide[2:] / half[2:] == pytest.approx([FOOT_THICK] * 2)
    assert (half > 0.05).all()
    assert (half < 0.2).all()


def test_a_hand_reaches_beyond_its_knuckle_and_a_foot_begins_above_its_heel() -> None:
    body = standing()
    places = dict(
        zip(ALL_JOINT_NAMES, np.array((*body.joints_m, *body.extremities_m)), strict=True)
    )
    shapes, _ = drawn(body)
    lengths = 2 * shapes.scales[:, 1]
    for row, side in ((0, "r"), (1, "l")):
        knuckle = places[f"{side}_knuckle"] - places[f"{side}_wrist"]
        assert lengths[row] == pytest.approx(1.7 * np.linalg.norm(knuckle))
        above_heel = (places[f"{side}_ankle"] + places[f"{side}_heel"]) / 2
        foot = places[f"{side}_toe"] - above_heel
        assert lengths[2 + row] == pytest.approx(np.linalg.norm(foot))
