"""The cameras' pictures on the page: golden pictures of three poses, from geometry (P55)."""

import subprocess
import sys

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from animator.page.inset import (
    NIGHT,
    SEEN,
    TINT,
    Image,
    draw_contours,
    inset,
    limb_contours,
    limb_ends,
)
from animator.scene import Figure, limb_colours
from common.body.body import LIMBS, POSE_INDEX, Vector, rest_pose
from common.body.kinematics import segments
from common.body.proportions import body_vector, stature, thesis_bdp
from common.bus.messages import Picture, View
from common.raster.kernel import draw_body, view_of
from common.raster.silhouette_report import silhouette_view
from common.rig.camera import Camera, paper_rig, project

BDP = thesis_bdp(1.75)
FOCAL_PX, DISTANCE_M = 401.0, 4.5
RIG = paper_rig((320, 240), (FOCAL_PX, FOCAL_PX), (DISTANCE_M, DISTANCE_M), (1.0, 1.0))
LEG_M = BDP.r_upper_leg.height + BDP.r_lower_leg.height
PX_PER_M = FOCAL_PX / DISTANCE_M
"""Of what stands in the middle of the room."""


def standing(**angles_deg: float) -> Vector:
    """A pose on the floor in the middle of the room, legs straight unless told."""
    pose = rest_pose()
    pose[POSE_INDEX["y"]] = LEG_M
    for name, angle_deg in angles_deg.items():
        pose[POSE_INDEX[name]] = angle_deg
    return pose


T_POSE = standing(r_shoulder_z=90.0, l_shoulder_z=270.0)
ARMS_UP = standing(r_shoulder_z=0.0, l_shoulder_z=360.0)
SQUAT = standing(y=LEG_M / 2, r_hip_x=60.0, l_hip_x=60.0, r_knee_x=-120.0, l_knee_x=-120.0)


def report(mask: np.ndarray) -> View:
    return silhouette_view(1, mask)


def drawn(pose: Vector) -> Image:
    """The fitted outline alone, as camera 1 shows it."""
    image = inset(report(np.zeros((120, 160), bool)), None)
    draw_contours(image, limb_contours(RIG.cameras[0], limb_ends(Figure(BDP, pose))), RIG.width)
    return image


def extent_m(pose: Vector) -> tuple[float, float, float]:
    """Width, height and top of the drawn outline, metres at the middle of the room."""
    rows, columns = np.nonzero((drawn(pose) != NIGHT.astype(np.uint8)).any(axis=2))
    top = 1.0 - (rows.min() + 0.5 - RIG.height / 2) / PX_PER_M
    return float(np.ptp(columns) / PX_PER_M), float(np.ptp(rows) / PX_PER_M), float(top)


def test_the_t_pose_is_as_wide_as_its_arms_and_trunk() -> None:
    """P55, first golden picture: arms end round, a radius beyond their axes; a line has 3 px."""
    width_m, _, top_m = extent_m(T_POSE)
    arm = BDP.r_lower_arm
    span_m = 2 * (BDP.torso.long_radius + BDP.r_upper_arm.height + arm.height + arm.radius)
    assert width_m == pytest.approx(span_m, abs=3 / PX_PER_M)
    assert width_m > 0.8 * stature(BDP)
    assert top_m == pytest.approx(stature(BDP), abs=0.06)


def test_a_squat_is_lower_than_standing_by_half_the_legs() -> None:
    """P55, second golden picture: the navel sinks by half a leg, and so does the crown."""
    standing_m, squatting_m = extent_m(standing())[2], extent_m(SQUAT)[2]
    assert standing_m - squatting_m == pytest.approx(LEG_M / 2, abs=0.05)


def test_raised_arms_reach_above_the_crown() -> None:
    """P55, third golden picture: shoulder height plus the arm's length."""
    top_m = extent_m(ARMS_UP)[2]
    shoulder_m = segments(body_vector(BDP), ARMS_UP)[LIMBS.index("r_upper_arm"), 0, 1]
    arm = BDP.r_lower_arm
    reach_m = shoulder_m + BDP.r_upper_arm.height + arm.height + arm.radius
    assert top_m == pytest.approx(reach_m, abs=0.05)
    assert top_m > stature(BDP) + 0.1


@pytest.mark.parametrize("pose", [T_POSE, ARMS_UP, SQUAT], ids=["t pose", "arms up", "squat"])
@pytest.mark.parametrize("camera", RIG.cameras, ids=["camera 1", "camera 2"])
def test_what_is_drawn_is_what_was_matched(pose: Vector, camera: Camera) -> None:
    """The kernel's own pixels but for 3 at the border: to it a section has one depth."""
    matched = draw_body(body_vector(BDP), pose, view_of(camera), (RIG.width, RIG.height))
    filled = np.zeros(matched.shape, np.uint8)
    for outline in limb_contours(camera, limb_ends(Figure(BDP, pose))):
        cv2.fillConvexPoly(filled, np.rint(outline - 0.5).astype(np.int32), 1)
    square = np.ones((7, 7), np.uint8)
    border = cv2.dilate(filled, square) - cv2.erode(filled, square)
    assert not (matched != filled.astype(bool))[border == 0].any()
    assert np.count_nonzero(filled) == pytest.approx(np.count_nonzero(matched), rel=0.13)


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(-180.0, 180.0), min_size=22, max_size=22), st.sampled_from([0, 1]))
def test_the_outline_of_a_limb_contains_its_axis(angles_deg: list[float], n: int) -> None:
    pose = np.array([0.2, 0.9, -0.3, *angles_deg])
    camera = RIG.cameras[n]
    outlines = limb_contours(camera, limb_ends(Figure(BDP, pose)))
    for outline, ends in zip(outlines, segments(body_vector(BDP), pose), strict=True):
        axis = project(camera, np.linspace(ends[0], ends[1], 5))
        hull = outline.astype(np.float32)
        assert all(cv2.pointPolygonTest(hull, point.tolist(), True) > -1e-2 for point in axis)


def test_a_sideways_cylinder_is_drawn_as_wide_as_two_radii() -> None:
    """Worked by hand: a hanging lower arm at the camera's distance, f times 2 r over z."""
    pose = standing()
    outline = limb_contours(RIG.cameras[0], limb_ends(Figure(BDP, pose)))[
        LIMBS.index("r_lower_arm")
    ]
    expected_px = 2 * BDP.r_lower_arm.radius * PX_PER_M
    assert np.ptp(outline[:, 0]) == pytest.approx(expected_px, rel=0.03)


def test_a_limb_behind_the_camera_has_no_outline_and_is_not_drawn() -> None:
    pose = standing(z=DISTANCE_M)
    outlines = limb_contours(RIG.cameras[0], limb_ends(Figure(BDP, pose)))
    assert all(len(outline) == 0 for outline in outlines)
    assert (drawn(pose) == NIGHT.astype(np.uint8)).all()


def test_without_a_picture_only_the_silhouette_is_shown() -> None:
    """Privacy: nothing but person and not-person can be read from it."""
    mask = np.zeros((120, 160), bool)
    mask[20:100, 60:90] = True
    image = inset(report(mask), None)
    assert image.shape == (240, 320, 3)
    assert (image[120, 150] == SEEN.astype(np.uint8)).all()
    assert (image[10, 10] == NIGHT.astype(np.uint8)).all()


def test_a_picture_is_shown_beneath_the_silhouette_where_one_is_sent() -> None:
    red = np.zeros((60, 80, 3), np.uint8)
    red[:, :, 2] = 200
    jpeg = cv2.imencode(".jpg", red)[1].tobytes()
    mask = np.zeros((120, 160), bool)
    mask[:, :80] = True
    image = inset(report(mask), picture(jpeg))
    assert np.abs(image[120, 300].astype(int) - [200, 0, 0]).max() < 6
    assert image[120, 20, 1] > 30


@pytest.mark.parametrize("jpeg", [b"", b"no picture at all"], ids=["empty", "garbage"])
def test_a_picture_that_is_none_is_left_out(jpeg: bytes) -> None:
    blank = report(np.zeros((120, 160), bool))
    assert (inset(blank, picture(jpeg)) == inset(blank, None)).all()


def picture(jpeg: bytes) -> Picture:
    return Picture(frame=0, captured_s=0.0, clock_s=0.0, viewer=1, jpeg=jpeg)


REHEARSED = """
from animator.__main__ import warm_up
from common.body import kinematics, proportions
from common.rig import camera
warm_up()
for compiled in (camera._on_plane, kinematics.place_limbs, proportions.attached):
    print(len(compiled.signatures))
"""


@pytest.mark.slow
def test_a_rehearsal_compiles_what_draws_a_body() -> None:
    """In a process of its own: the first body of a live run is shown in time."""
    told = subprocess.run(
        [sys.executable, "-c", REHEARSED], capture_output=True, text=True, check=True, timeout=300
    )
    assert told.stdout.split() == ["1", "1", "1"]


def covered(left_half: bool = True) -> View:
    mask = np.zeros((60, 320), np.bool_)
    mask[:, :160] = left_half
    return silhouette_view(1, mask)


def test_a_silhouette_tints_the_picture_and_is_painted_over_nothing_without_one() -> None:
    """A share of its colour over a grey picture; all of it over the night."""
    grey = np.full((30, 160, 3), 100, np.uint8)
    jpeg = cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, 98])[1].tobytes()
    picture = Picture(frame=0, captured_s=0.0, clock_s=0.0, viewer=1, jpeg=jpeg)
    over = inset(covered(), picture).astype(float)
    assert over[30, 40] == pytest.approx(100 + TINT * (SEEN - 100.0), abs=3)
    assert over[30, 280] == pytest.approx([100] * 3, abs=3)
    alone = inset(covered(), None).astype(float)
    assert alone[30, 40] == pytest.approx(np.array(SEEN, float), abs=1)
    assert alone[30, 280] == pytest.approx(np.array(NIGHT, float), abs=1)


@pytest.mark.parametrize("times", [1, 2])
def test_a_contour_is_drawn_at_its_places_in_the_colour_of_its_limb(times: int) -> None:
    """A pixel's centre is at a half; the first limb's, and no other's."""
    image = np.zeros((60 * times, 60 * times, 3), np.uint8)
    square = np.array([[10.5, 20.5], [40.5, 20.5], [40.5, 50.5], [10.5, 50.5]])
    draw_contours(image, [square, *[np.empty((0, 2))] * (len(LIMBS) - 1)], 60)
    drawn = np.argwhere(image.any(axis=2))
    colour = limb_colours()[0].astype(float)
    strong = np.argwhere((image >= 0.45 * colour).all(axis=2))
    assert np.corrcoef(image.max(axis=(0, 1)), colour)[0, 1] > 0.99
    low, high = 10.5 * times - 0.5, 40.5 * times - 0.5
    assert strong[:, 1].min() == pytest.approx(low, abs=0.5)
    assert strong[:, 1].max() == pytest.approx(high, abs=0.5)
    assert strong[:, 0].min() == pytest.approx(20.5 * times - 0.5, abs=0.5)
    assert drawn[:, 0].max() == pytest.approx(50.5 * times - 0.5, abs=1.5)


def test_a_limb_in_a_ball_and_a_section_are_hulls_as_broad_as_they_are() -> None:
    """Pixels of a contour are of both axes: an arm's end is round."""
    ends = limb_ends(Figure(BDP, T_POSE))
    contours = limb_contours(RIG.cameras[0], ends)
    assert [contour.shape[1] for contour in contours] == [2] * len(LIMBS)
    arm = contours[LIMBS.index("l_lower_arm")]
    broad_px = np.ptp(arm[:, 1])
    assert broad_px == pytest.approx(2 * BDP.l_lower_arm.radius * PX_PER_M, rel=0.1)
    behind = ends + np.array([0.0, 0.0, 9.0])
    assert [len(contour) for contour in limb_contours(RIG.cameras[0], behind)] == [0] * len(LIMBS)
