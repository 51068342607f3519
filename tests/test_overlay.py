"""The overlay: what is drawn where, read back from the pixels (thesis, figures 4.1 and 4.2)."""

import numpy as np
import pytest

from animator.overlay import (
    BELOW_M,
    LEAST_HEIGHT_PX,
    SEEN,
    TALL_M,
    TINT,
    draw_stick,
    overlay,
    side_view,
)
from animator.scene import LEFT, RIGHT
from common.body.body import JOINT_NAMES, POSE_INDEX, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp

SURE = np.ones(15)
NOBODY_PX, NOBODY_M = np.full((15, 2), np.nan), np.full((15, 3), np.nan)
GREY = np.full((120, 160, 3), 90, np.uint8)


def body(**angles_deg: float) -> np.ndarray:
    pose = rest_pose()
    for name, angle in {"y": 1.0, **angles_deg}.items():
        pose[POSE_INDEX[name]] = angle
    return np.asarray(joints(body_vector(thesis_bdp(1.75)), pose))


def where(image: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """Columns and rows of the pixels of about a colour, (n, 2)."""
    near = np.abs(image.astype(int) - colour[::-1]).max(axis=2) < 12
    rows, columns = np.nonzero(near)
    return np.stack([columns, rows], axis=1)


def in_picture(joints_m: np.ndarray) -> np.ndarray:
    """As a camera that looks along -z has them, 60 px a metre, in 160x120."""
    return np.stack([80.0 + 60.0 * joints_m[:, 0], 115.0 - 60.0 * joints_m[:, 1]], axis=1)


def test_small_pictures_are_enlarged_and_the_body_stands_beside_them() -> None:
    image = overlay(GREY, None, NOBODY_PX, NOBODY_M, SURE)
    assert image.shape == (LEAST_HEIGHT_PX, 480 + 252, 3)
    assert (image[:, :480] == 90).all()


@pytest.mark.parametrize("size", [(144, 180), (480, 720), (1080, 1920)])
def test_every_frame_of_a_film_has_one_even_size(size: tuple[int, int]) -> None:
    picture = np.zeros((*size, 3), np.uint8)
    with_body = overlay(picture, None, in_picture(body()), body(), SURE, "frame 3")
    without = overlay(picture, None, NOBODY_PX, NOBODY_M, SURE)
    assert with_body.shape == without.shape
    assert with_body.shape[0] >= LEAST_HEIGHT_PX


def test_the_stick_lies_on_its_joints() -> None:
    image = np.repeat(np.repeat(GREY, 4, axis=0), 4, axis=1)
    joints_px = 4 * in_picture(body(l_shoulder_z=270.0))
    draw_stick(image, joints_px, SURE)
    elbow, wrist = joints_px[[JOINT_NAMES.index("l_elbow"), JOINT_NAMES.index("l_wrist")]]
    middle = (elbow + wrist) / 2
    assert np.linalg.norm(where(image, LEFT) - middle, axis=1).min() < 3.0
    assert where(image, LEFT)[:, 0].min() > where(image, RIGHT)[:, 0].max()


def test_what_is_not_sure_is_pale() -> None:
    sure, unsure = (np.zeros((480, 640, 3), np.uint8) for _ in range(2))
    draw_stick(sure, 4 * in_picture(body()), SURE)
    draw_stick(unsure, 4 * in_picture(body()), 0.0 * SURE)
    assert len(where(unsure, LEFT)) < 0.5 * len(where(sure, LEFT))


def test_the_silhouette_is_tinted_whatever_its_size() -> None:
    mask = np.zeros((60, 80), bool)
    mask[20:40, 30:50] = True
    image = overlay(GREY, mask, NOBODY_PX, NOBODY_M, SURE)
    assert (image[180, 240] != 90).any()
    assert (image[75, 75] == 90).all()


def test_a_picture_of_odd_size_loses_its_last_row_and_column() -> None:
    """Encoders take whole pairs."""
    picture = np.zeros((361, 641, 3), np.uint8)
    mask = np.ones((361, 641), bool)
    assert overlay(picture, mask, NOBODY_PX, NOBODY_M, SURE).shape == (360, 640 + 252, 3)


def test_from_the_side_the_camera_is_at_the_left() -> None:
    """An arm that is lifted to the camera points to the left; the person's left is nearer."""
    hanging = where(side_view(body(), SURE, 480), LEFT)[:, 0].min()
    lifted = where(side_view(body(l_shoulder_x=90.0), SURE, 480), LEFT)[:, 0].min()
    assert lifted < hanging - 60
    assert len(where(side_view(body(), SURE, 480), LEFT)) > 20 * len(
        where(side_view(body(), SURE, 480), RIGHT)
    )


@pytest.mark.parametrize("up_m", [-2.0, 3.0])
def test_who_leaves_the_view_from_the_side_is_shown_on_its_floor(up_m: float) -> None:
    """As before a camera that looks down, whose floor is not where it is taken to be."""
    gone, on_floor = body(), body()
    gone[:, 1] += up_m
    on_floor[:, 1] -= on_floor[:, 1].min()
    assert np.array_equal(side_view(gone, SURE, 480), side_view(on_floor, SURE, 480))


def test_a_joint_far_outside_the_picture_is_no_fault() -> None:
    joints_px = in_picture(body())
    joints_px[3] = (1e12, -1e12)
    assert overlay(GREY, None, joints_px, body(), SURE).shape[0] == LEAST_HEIGHT_PX


@pytest.mark.parametrize("times", [1, 2, 4])
def test_lines_are_as_broad_as_the_picture_is_large(times: int) -> None:
    """Two pixels in one of 240 rows, within a white one of three; both scale together."""
    image = np.full((240 * times, 320 * times, 3), 90, np.uint8)
    joints_px = np.tile([160.0 * times, 20.0 * times], (15, 1))
    ends = [JOINT_NAMES.index(name) for name in ("l_elbow", "l_wrist")]
    joints_px[ends] = np.array([[100.0, 200.0], [300.0, 200.0]]) * times
    draw_stick(image, joints_px, SURE)
    column = image[:, 200 * times].astype(int)
    coloured = (np.abs(column - LEFT[::-1]).max(axis=1) < 60).sum()
    touched = (column != 90).any(axis=1).sum()
    assert coloured == pytest.approx(2 * times, abs=1)
    assert touched == pytest.approx(3 * times + 3.5, abs=1.5), "and what is soft at its edges"
    disc = (image[:, 300 * times].astype(int) != 90).any(axis=1).sum()
    assert disc == pytest.approx(5 * times + 2, abs=2), "a joint's"
    assert (image == 255).all(axis=2).any(), "white beside it"


def test_from_the_side_the_body_stands_in_the_middle_and_limbs_have_their_breadth() -> None:
    """What is before the pelvis is to its left; the trunk is a tenth of the height broad."""
    high = 480
    view = side_view(body(l_shoulder_x=90.0, l_shoulder_z=180.0), SURE, high)
    empty = side_view(NOBODY_M, SURE, high)
    changed = (view != empty).any(axis=2)
    px = high / TALL_M
    trunk_row = round(high * (1 - BELOW_M / TALL_M) - px * 1.15)
    columns = np.flatnonzero(changed[trunk_row])
    assert columns.mean() == pytest.approx(view.shape[1] / 2, abs=4)
    tall_px = px * float(np.ptp(body()[:, 1]))
    assert np.ptp(columns) + 1 == pytest.approx(2 * 0.05 * tall_px + 3, abs=4)
    hand = where(view, LEFT)
    assert hand[:, 0].min() < view.shape[1] / 2 - 0.4 * px


def test_the_breadth_of_limbs_follows_the_height_of_the_joints_half_a_metre_at_least() -> None:
    """Joints within 0.4 m of height are drawn as those of a body of half a metre."""
    broad = []
    for tall_m in (0.4, 0.5, 1.0):
        joints_m = np.tile([0.0, 1.0, 0.0], (15, 1))
        joints_m[JOINT_NAMES.index("head_top")] = (0.0, 1.0 + tall_m / 2, 0.0)
        joints_m[JOINT_NAMES.index("l_ankle")] = (0.0, 1.0 - tall_m / 2, 0.0)
        view = side_view(joints_m, SURE, 960)
        changed = (view != side_view(NOBODY_M, SURE, 960)).any(axis=2)
        row = round(960 * (1 - BELOW_M / TALL_M) - 960 / TALL_M * 0.9)
        broad.append(int(changed[row].sum()))
    assert abs(broad[0] - broad[1]) <= 1
    assert broad[2] > 1.5 * broad[1]


def test_from_the_side_what_is_nearest_to_the_viewer_is_drawn_last() -> None:
    """The viewer stands at the right of the camera's picture: +x hides -x, whichever side it is."""
    joints_m = body()
    assert joints_m[JOINT_NAMES.index("l_knee"), 0] > joints_m[JOINT_NAMES.index("r_knee"), 0]
    mirrored = joints_m * (-1.0, 1.0, 1.0)
    for given, seen, hidden in ((joints_m, LEFT, RIGHT), (mirrored, RIGHT, LEFT)):
        view = side_view(given, SURE, 480)
        assert len(where(view, seen)) > 20 * len(where(view, hidden))


def test_a_stroke_takes_the_sureness_of_its_far_end() -> None:
    image = np.full((240, 320, 3), 90, np.uint8)
    joints_px = np.tile([20.0, 20.0], (15, 1))
    elbow, wrist = (JOINT_NAMES.index(f"l_{name}") for name in ("elbow", "wrist"))
    joints_px[elbow], joints_px[wrist] = (100.0, 200.0), (200.0, 200.0)
    for unsure, pale in ((elbow, False), (wrist, True)):
        confidence = SURE.copy()
        confidence[unsure] = 0.0
        drawn = image.copy()
        draw_stick(drawn, joints_px, confidence)
        painted = drawn[196:204, 140:160].reshape(-1, 3).astype(int)
        nearest = np.abs(painted - np.array(LEFT[::-1])).max(axis=1).min()
        assert bool(nearest > 30) is pale


def test_the_tint_covers_the_silhouette_and_its_contour_is_opaque() -> None:
    """Rows 20 to 39 and columns 30 to 49 of 60 x 80, in 360 x 480: 6 times as large."""
    mask = np.zeros((60, 80), bool)
    mask[20:40, 30:50] = True
    left = overlay(GREY, mask, NOBODY_PX, NOBODY_M, SURE)[:, :480]
    changed = (left != 90).any(axis=2)
    rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
    assert (rows[0], rows[-1], columns[0], columns[-1]) == pytest.approx(
        (120, 239, 180, 299), abs=1
    )
    assert changed[121:238, 181:298].all()
    inside, border = left[180, 240].astype(int), left[120, 240].astype(int)
    assert inside == pytest.approx(90 + TINT * (np.array(SEEN) - 90), abs=1)
    assert border == pytest.approx(np.array(SEEN), abs=20), "softened at its edge"
