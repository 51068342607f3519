"""The fitted stick body, held against drawn bodies and against clips with truth (T9-T18)."""

from pathlib import Path

import msgspec
import numpy as np
import pytest
from stick_posing import STATURE_PX, drawn, in_profile, larger, stick_pose

from common.body.body import JOINT_NAMES, LIMBS, POSE_INDEX, rest_pose
from common.body.observation import Fit
from common.body.proportions import body_vector, thesis_bdp
from common.body.stick_body import ADULT, ANGLE, THESIS, joints_px
from common.bus.message_codec import decode, encode
from common.bus.messages import View
from common.method import DEFAULT, METHODS, Mode
from common.raster.kernel import draw_body
from common.raster.silhouette_report import silhouette_view, with_person
from common.rig.camera import PAPER_ROTATIONS
from viewer.paper.posed_model import view_at
from viewer.stick.stick_fit import Stick, expected, fit, fit_of

TWELVE = slice(3, 15)
POSES = {
    "stands": {},
    "right arm out": {"r_upper_arm": 185.0, "r_lower_arm": 180.0},
    "arms up": {name: 80.0 for name in LIMBS if name.endswith("arm")},
    "elbow": {"l_upper_arm": 300.0, "l_lower_arm": 20.0},
    "side kick": {"l_upper_leg": 315.0, "l_lower_leg": 315.0},
}


@pytest.mark.parametrize("name", POSES)
def test_a_drawn_body_is_found_again(name: str) -> None:
    """T11-T16 together: joints within 3 % of the stature, on average."""
    pose = stick_pose(POSES[name])
    stick = fit(drawn(pose), None, STATURE_PX, DEFAULT)
    off = np.linalg.norm(stick.joints_px - joints_px_of(pose), axis=1)[TWELVE] / STATURE_PX
    assert off.mean() < 0.03
    assert stick.score > 0.85


def joints_px_of(pose: np.ndarray) -> np.ndarray:
    return joints_px(ADULT, pose)


def turned_by(turn_deg: float) -> np.ndarray:
    """A stick pose of somebody who stands, turned in the picture."""
    pose = stick_pose({})
    pose[ANGLE : ANGLE + 10] += turn_deg
    return pose


@pytest.mark.parametrize("head_deg", [-20.0, 15.0, 160.0, 190.0, 200.0])
def test_who_lies_is_found_along_the_floor(head_deg: float) -> None:
    """Somebody who fell, met as such: joints within 5 % of the stature."""
    pose = turned_by(head_deg - 90.0)
    stick = fit(drawn(pose), None, STATURE_PX, DEFAULT)
    off = np.linalg.norm(stick.joints_px - joints_px_of(pose), axis=1)[TWELVE] / STATURE_PX
    assert off.mean() < 0.05
    assert stick.score > 0.8


def test_a_whole_turn_more_is_the_same_pose_before() -> None:
    """Of somebody who lies: what is remembered may count its angles from 0 or from -180."""
    mask, before = drawn(turned_by(-95.0)), turned_by(-102.0)
    one, other = fit(mask, before, STATURE_PX, DEFAULT), before.copy()
    other[ANGLE : ANGLE + 10] += 360.0
    assert one.score > 0.9
    again = fit(mask, other, STATURE_PX, DEFAULT)
    assert again.joints_px == pytest.approx(one.joints_px, abs=0.02 * STATURE_PX)


@pytest.mark.parametrize("mode", ["default", "thesis"])
def test_the_size_of_the_frame_does_not_change_the_angles(mode: Mode) -> None:
    """T9: the same frame at 1x and 4x, within a degree where the body is bent clearly."""
    mask = drawn(stick_pose({"r_upper_arm": 215.0, "r_lower_arm": 215.0, "l_upper_leg": 285.0}))
    one = fit(mask, None, STATURE_PX, METHODS[mode])
    four = fit(larger(mask, 4), None, 4 * STATURE_PX, METHODS[mode])
    turned = one.pose[ANGLE : ANGLE + 10] - four.pose[ANGLE : ANGLE + 10]
    assert np.abs(turned).max() <= 1.0
    assert four.joints_px / 4 == pytest.approx(one.joints_px, abs=0.03 * STATURE_PX)


def test_a_limb_that_points_at_the_camera_is_short() -> None:
    """T18: an arm held forwards shows half of its length."""
    arm = {"l_upper_arm": 0.45, "l_lower_arm": 0.45}
    pose = stick_pose({"l_upper_arm": 330.0, "l_lower_arm": 330.0}, arm)
    stick = fit(drawn(pose), None, STATURE_PX, DEFAULT)
    assert stick.ratios[[7, 9]].mean() == pytest.approx(0.45, abs=0.15)


def test_a_thin_trunk_is_one_in_profile() -> None:
    pose = in_profile(stick_pose({"r_upper_leg": 250.0, "l_upper_leg": 290.0}))
    assert fit(drawn(pose), None, STATURE_PX, DEFAULT).breadth < 0.6


def test_an_arm_before_the_trunk_is_hidden_and_stays_where_it_was() -> None:
    """T26: what the silhouette does not show is said, and continuity keeps it."""
    across = {"l_upper_arm": 250.0, "l_lower_arm": 200.0}
    stick = fit(drawn(stick_pose(across)), stick_pose(across), STATURE_PX, DEFAULT)
    assert stick.hidden[LIMBS.index("l_lower_arm")]
    assert not stick.hidden[LIMBS.index("r_lower_leg")]
    assert abs(stick.pose[ANGLE + 9] - 200.0) < 25.0


def test_the_thesis_counts_a_match_for_every_probe() -> None:
    """T12, T18: two searches of 36, two of 27, ten of at most 24."""
    stick = fit(drawn(stick_pose({}), THESIS), None, STATURE_PX, METHODS["thesis"])
    assert 100 < stick.evaluations <= 2 * 36 + 2 * 27 + 10 * 24


@pytest.mark.parametrize("yaw_deg", [0.0, 180.0, 70.0])
def test_what_is_expected_of_a_posed_body_is_where_its_picture_has_it(yaw_deg: float) -> None:
    """T10: r is on the left of the picture, whichever way the person faces."""
    pose = rest_pose()
    pose[POSE_INDEX["torso_y"]], pose[POSE_INDEX["r_elbow_x"]] = yaw_deg, 40.0
    body, size = body_vector(thesis_bdp(1.75)), (320, 240)
    view = view_at(np.array(PAPER_ROTATIONS[0]), 100.0, (160.0, 120.0))
    found = joints_px(ADULT, expected(body, pose, view, 175.0))
    rows = np.flatnonzero(draw_body(body, pose, view, size).any(axis=1))
    assert found[0, 0] == pytest.approx(160.0)
    assert found[:, 1].min() == pytest.approx(rows[0], abs=8.0)
    assert found[:, 1].max() == pytest.approx(rows[-1], abs=8.0)
    right, left = (found[JOINT_NAMES.index(f"{side}_shoulder"), 0] for side in "rl")
    assert right <= left
    elsewhere = pose + np.eye(len(pose))[:3].T @ (0.4, 0.9, -0.7)  # the view says where it is seen
    np.testing.assert_allclose(joints_px(ADULT, expected(body, elsewhere, view, 175.0)), found)


@pytest.mark.parametrize(
    ("yaw_deg", "limb", "angle_deg"), [(0.0, "r_upper_arm", 180.0), (180.0, "l_upper_arm", 0.0)]
)
def test_who_shows_the_back_has_the_right_arm_on_the_right_of_the_picture(
    yaw_deg: float, limb: str, angle_deg: float
) -> None:
    """T10: the right arm is out; r is what is on the left, whoever's it is."""
    pose = rest_pose()
    pose[POSE_INDEX["torso_y"]], pose[POSE_INDEX["r_shoulder_z"]] = yaw_deg, 90.0
    view = view_at(np.array(PAPER_ROTATIONS[0]), 100.0, (160.0, 120.0))
    found = expected(body_vector(thesis_bdp(1.75)), pose, view, 175.0)
    out = [angle for angle in found[ANGLE + 6 : ANGLE + 10] if abs(angle - 270.0) > 30.0]
    assert (found[ANGLE + LIMBS.index(limb)] - angle_deg + 180.0) % 360.0 == pytest.approx(180.0)
    assert len(out) == 2


def test_nobody_is_refused() -> None:
    with pytest.raises(ValueError, match="no body to fit"):
        fit(np.zeros((120, 160), np.bool_), None, 100.0, DEFAULT)
    with pytest.raises(ValueError, match="no body to fit"):
        fit(drawn(stick_pose({})), None, 0.0, DEFAULT)


def test_a_speck_is_fitted_without_complaint_or_refused_in_words() -> None:
    mask = np.zeros((120, 160), np.bool_)
    mask[50:54, 50:53] = True
    assert 0.0 <= fit(mask, None, 100.0, DEFAULT).score <= 1.0
    with pytest.raises(ValueError, match="no body to fit"):
        fit(mask, None, 1e6, DEFAULT)


def test_a_fit_travels_in_a_report() -> None:
    mask = drawn(stick_pose({}))
    stick = fit(mask, None, STATURE_PX, DEFAULT)
    view = silhouette_view(1, mask)
    (person,) = view.people
    person = msgspec.structs.replace(person, stick=fit_of(stick))
    (heard,) = decode(encode(with_person(view, person)), View).people
    assert isinstance(heard.stick, Fit)
    assert np.allclose(heard.stick.joints_px, stick.joints_px)


@pytest.mark.parametrize(("mode", "most"), [("default", 0.04), ("thesis", 0.07)])
def test_joints_of_a_rendered_walk_lie_where_they_are(
    data_dir: Path, mode: Mode, most: float
) -> None:
    """Single view: 12 joints in camera 1, exact masks, a share of the height (asked: 6 %).

    Without algorithm 2 the thesis is at 0.093, and a standing body that fits nothing at 0.082.
    Algorithms 1 and 6 this walk does not show: tests/test_thesis_fit.py does.
    """
    with np.load(data_dir / "dev" / "r07_t1_01_walk_in_place" / "truth.npz") as truth:
        names = truth["joint_names"].tolist()
        bits, places = truth["mask_cam1"], truth["joints2d_cam1"]
    masks = np.unpackbits(bits, axis=2)[:, :, :320].astype(np.bool_)
    before: Stick | None = None
    off = []
    rows = [names.index(name) for name in JOINT_NAMES]
    tall = float(np.flatnonzero(masks[9].any(axis=1)).size)
    for frame in range(9, 49):
        before = fit(masks[frame], None if before is None else before.pose, tall, METHODS[mode])
        off.append(np.linalg.norm(before.joints_px - places[frame][rows], axis=1)[TWELVE])
    assert np.mean(off) / tall <= most
