"""What a view shows of somebody, held against what cannot matter: resolution, roll, room."""

import cv2
import msgspec
import numpy as np
import pytest
from glass import MIRROR, in_mirror
from hypothesis import given, settings
from hypothesis import strategies as st

from common.rig.camera import Camera, Rig, as_matrix, as_row, centre, paper_rig, project
from common.rig.rig_file import fitted
from integrator.proposal.silhouette_window import (
    ASIDE,
    BESIDE,
    CELLS,
    COLUMNS,
    DOWN,
    FAR_M,
    FINER,
    LONGEST_S,
    NEAR_M,
    NEARNESS,
    ROWS,
    STEEPEST,
    TALLEST_M,
    UP,
    _about,
    _from_a_side,
    _tell,
    _warp,
    axes_of,
    look,
    standing_m,
)

RIG = paper_rig((640, 480), (800.0, 800.0), (4.5, 4.5))
STATURE_M = 1.75
BODY_M = np.array([0.2, 0.0, -0.1])
"""Where the feet stand."""

ARM, HEAD, TRUNK = ((0.0, 0.7), (1.25, 1.45)), ((-0.1, 0.1), (1.5, 1.75)), ((-0.2, 0.2), (0.0, 1.5))


def drawn(camera: Camera, size: tuple[int, int]) -> np.ndarray:
    """A figure of boxes that face the camera: an arm to one side, head and trunk."""
    width, height = size
    mask = np.zeros((height, width), np.bool_)
    u, v = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    away = BODY_M - centre(camera)
    flat = away * [1.0, 0.0, 1.0] / np.hypot(away[0], away[2])
    right = np.cross(flat, [0.0, 1.0, 0.0])
    K, R = np.array(camera.K), np.array(camera.R)
    rays = np.stack([(u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1], np.ones_like(u)], -1) @ R
    far = (away @ flat) / (rays @ flat)
    place = centre(camera) + rays * far[..., None] - BODY_M
    across, up = place @ right, place[..., 1]
    for (left, end), (low, high) in (ARM, HEAD, TRUNK):
        mask |= (across >= left) & (across <= end) & (up >= low) & (up <= high)
    return mask


def seen(rig: Rig, *, views: tuple[bool, bool] = (True, True)) -> tuple[np.ndarray, np.ndarray]:
    first, second = (
        drawn(camera, (rig.width, rig.height)) if view else None
        for camera, view in zip(rig.cameras, views, strict=True)
    )
    found = look((first, second), rig, STATURE_M, 1 / 15)
    assert found is not None
    return found.windows, found.middle_m


def test_the_size_of_the_picture_does_not_matter() -> None:
    large, middle = seen(RIG)
    small, same = seen(fitted(RIG, (160, 120), "here"))
    assert middle == pytest.approx(same, abs=0.022)  # a pixel of the small one
    assert np.abs(large - small).mean() < 0.015


@pytest.mark.slow
@given(st.floats(-25.0, 25.0))
@settings(max_examples=15, deadline=None)
def test_a_rolled_camera_shows_the_same_window(roll_deg: float) -> None:
    c, s = np.cos(np.radians(roll_deg)), np.sin(np.radians(roll_deg))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    first, second = RIG.cameras
    rolled = msgspec.structs.replace(
        second, R=as_matrix(turn @ np.array(second.R)), t=as_row(turn @ np.array(second.t))
    )
    windows, middle = seen(RIG)
    others, same = seen(msgspec.structs.replace(RIG, cameras=(first, rolled)))
    assert middle == pytest.approx(same, abs=0.01)
    assert np.abs(windows - others).mean() < 0.01


def test_the_middle_is_where_both_views_have_it() -> None:
    _, middle = seen(RIG)
    spread = [
        np.argwhere(drawn(camera, (640, 480))).mean(axis=0)[::-1] + 0.5 for camera in RIG.cameras
    ]
    told = [project(camera, middle[None])[0] for camera in RIG.cameras]
    assert np.array(told)[:, 0] == pytest.approx(np.array(spread)[:, 0], abs=0.5)


@pytest.mark.parametrize(("columns", "meet"), [((5, 150), True), ((150, 5), False)])
def test_silhouettes_that_meet_behind_the_cameras_are_nobodys(
    columns: tuple[int, int], meet: bool
) -> None:
    """Cameras 30 degrees apart whose rays cross before them, or lead apart."""
    first = paper_rig((160, 120), (200.0, 200.0), (4.0, 4.0), (1.0, 1.0)).cameras[0]
    sine, cosine = 0.5, 0.75**0.5
    turn = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    R = np.array(first.R) @ turn
    t = -R @ turn.T @ centre(first)
    second = msgspec.structs.replace(first, name="cam2", R=as_matrix(R), t=as_row(t))
    masks = np.zeros((2, 120, 160), np.bool_)
    for mask, column in zip(masks, columns, strict=True):
        mask[30:100, column : column + 8] = True
    found = look((masks[0], masks[1]), Rig(160, 120, (first, second)), STATURE_M, 1 / 15)
    assert (found is not None) == meet


@given(st.floats(-np.pi, np.pi), st.floats(0.0, np.pi))
@settings(max_examples=15, deadline=None)
def test_who_lies_is_looked_at_as_if_they_stood(heading: float, over: float) -> None:
    """A room that is turned over with its cameras shows the same, given where the head is."""
    x, z = np.cos(heading), np.sin(heading)
    cross = np.array([[0.0, -z, 0.0], [z, 0.0, -x], [0.0, x, 0.0]])
    turn = np.eye(3) + np.sin(over) * cross + (1.0 - np.cos(over)) * cross @ cross
    masks = tuple(drawn(camera, (640, 480)) for camera in RIG.cameras)
    cameras = tuple(
        msgspec.structs.replace(camera, R=as_matrix(np.array(camera.R) @ turn.T))
        for camera in RIG.cameras
    )
    lies = msgspec.structs.replace(RIG, cameras=cameras)
    stood = look((masks[0], masks[1]), RIG, STATURE_M, 1 / 15)
    found = look((masks[0], masks[1]), lies, STATURE_M, 1 / 15, turn[:, 1])
    assert stood is not None
    assert found is not None
    assert found.middle_m == pytest.approx(turn @ stood.middle_m, abs=1e-6)
    assert np.abs(found.windows - stood.windows).mean() < 1e-3
    assert found.beside == pytest.approx(stood.beside, abs=0.08)
    assert found.turn == pytest.approx(stood.turn @ turn.T, abs=0.08)


@pytest.mark.parametrize(("worse", "better"), [(0, 1), (1, 0)])
def test_a_camera_that_sees_somebody_along_the_body_is_left_out(worse: int, better: int) -> None:
    """The other alone says it, from where the paper's camera of its number stands."""
    masks = tuple(drawn(camera, (640, 480)) for camera in RIG.cameras)
    along = centre(RIG.cameras[worse]) - np.array([0.2, 0.9, -0.1])
    found = look((masks[0], masks[1]), RIG, STATURE_M, 1 / 15, along / np.linalg.norm(along))
    assert found is not None
    assert found.windows[worse].sum() == 0.0
    assert found.windows[better].sum() > 50.0
    told = found.beside[5 * better + 1 : 5 * better + 4]
    assert told == pytest.approx([(0.0, 0.0, 1.0), (-1.0, 0.0, 0.0)][better], abs=0.1)
    assert np.linalg.det(found.turn) == pytest.approx(1.0)


@pytest.mark.parametrize("alone", [0, 1])
def test_one_view_alone_takes_the_feet_to_the_floor(alone: int) -> None:
    """The lowest row's ray meets y = 0 where the figure stands; the other window stays empty."""
    windows, middle = seen(RIG, views=(alone == 0, alone == 1))
    eye = centre(RIG.cameras[alone])
    far = np.hypot(*(middle - eye)[[0, 2]])
    assert far == pytest.approx(np.hypot(*(BODY_M - eye)[[0, 2]]), rel=0.02)
    assert windows[alone].sum() > 50
    assert windows[1 - alone].sum() == 0


def test_the_figure_fills_its_window_as_its_size_says() -> None:
    """1.75 m of 1.38 statures, the trunk 0.4 m of 1.12: cells are metres, not pixels."""
    windows, _ = seen(RIG)
    trunk = windows[0].reshape(48, 40)[20:40]
    assert trunk.sum(axis=1).mean() * 1.12 * STATURE_M / 40 == pytest.approx(0.4, abs=0.02)
    assert windows.shape == (2, CELLS)


def test_gaps_and_cameras_are_said_beside() -> None:
    masks = tuple(drawn(camera, (640, 480)) for camera in RIG.cameras)
    found = look((masks[0], masks[1]), RIG, STATURE_M, 2 / 15)
    assert found is not None
    assert len(found.beside) == BESIDE
    assert found.beside[-1] == pytest.approx(1.0)
    assert found.beside[[0, 5]].tolist() == [1.0, 1.0]
    assert found.beside[1:4] == pytest.approx([0.0, 0.0, 1.0], abs=0.08)
    assert found.beside[6:9] == pytest.approx([-1.0, 0.0, 0.0], abs=0.08)


def test_a_rig_the_other_way_round_shows_the_same_in_a_mirror() -> None:
    """Camera 2 stands to the left of camera 1 in all that is looked at."""
    other = in_mirror(RIG)
    masks = [drawn(camera, (640, 480)) for camera in RIG.cameras]
    found = look((masks[0], masks[1]), RIG, STATURE_M, 1 / 15)
    flipped = [np.ascontiguousarray(mask[:, ::-1]) for mask in masks]
    same = look((flipped[0], flipped[1]), other, STATURE_M, 1 / 15)
    assert found is not None
    assert same is not None
    assert same.mirrored
    assert not found.mirrored
    assert same.middle_m == pytest.approx(found.middle_m * MIRROR, abs=1e-6)
    assert same.beside == pytest.approx(found.beside, abs=1e-5)
    assert np.abs(same.windows - found.windows).mean() < 1e-3
    assert same.turn == pytest.approx(found.turn * MIRROR)


@given(st.floats(-180.0, 180.0), st.floats(-50.0, 50.0))
@settings(max_examples=40, deadline=None)
def test_the_axes_are_upright_whatever_the_camera_does(yaw_deg: float, tilt_deg: float) -> None:
    a, b = np.radians([yaw_deg, tilt_deg])
    yaw = np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])
    tilt = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    R = tilt @ np.array(RIG.cameras[0].R) @ yaw
    turned = msgspec.structs.replace(RIG.cameras[0], R=as_matrix(R))
    axes = axes_of(turned, RIG.cameras[1])
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-9)
    assert abs(np.linalg.det(axes)) == pytest.approx(1.0)
    assert axes[1].tolist() == [0.0, 1.0, 0.0]
    assert axes[2] @ -R[2] > 0


@pytest.mark.parametrize("deg", range(-45, 50, 15))
def test_one_outline_stands_where_its_feet_are_however_the_camera_is_rolled(deg: int) -> None:
    """A post of 40 cm by 1.8 m, 0.5 m aside and 0.6 m nearer than the middle of the room."""
    camera = rolled(RIG.cameras[0], deg)
    corners = np.array([[x, y, 0.6] for x, y in ((0.3, 0.0), (0.7, 0.0), (0.7, 1.8), (0.3, 1.8))])
    mask = np.zeros((RIG.height, RIG.width), np.uint8)
    cv2.fillPoly(mask, [np.rint(8 * (project(camera, corners) - 0.5)).astype(int)], 1, shift=3)
    found = standing_m(mask.astype(np.bool_), camera)
    assert found == pytest.approx([0.5, 0.9, 0.6], abs=0.15)


def rolled(camera: Camera, deg: float) -> Camera:
    turn = cv2.Rodrigues(np.array([0.0, 0.0, np.radians(deg)]))[0]
    R, t = turn @ np.array(camera.R), turn @ np.array(camera.t)
    return msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(t))


@pytest.mark.parametrize("deg", range(-45, 50, 15))
def test_the_axes_are_where_the_camera_looks_however_it_is_rolled(deg: int) -> None:
    """Also where it looks down, so that its picture's right is not level."""
    down = cv2.Rodrigues(np.array([np.radians(-30.0), 0.0, 0.0]))[0]
    first = RIG.cameras[0]
    tilted = msgspec.structs.replace(first, R=as_matrix(down @ np.array(first.R)))
    axes = axes_of(rolled(tilted, deg), RIG.cameras[1])
    assert axes == pytest.approx(np.eye(3), abs=1e-9)


@given(st.floats(-180.0, 180.0), st.floats(20.0, 200.0))
@settings(max_examples=30, deadline=None)
def test_the_window_reaches_so_many_statures_from_the_middle(up_deg: float, size_px: float) -> None:
    """Its sides as upright as the body in the picture, whatever the roll; centres of samples."""
    way = np.array([np.sin(np.radians(up_deg)), -np.cos(np.radians(up_deg))])
    right = np.array([-way[1], way[0]])
    middle = np.array([33.0, 71.0])
    warp = _warp(np.stack([middle, middle + 7.0 * way]), size_px)
    wide, high = FINER * COLUMNS, FINER * ROWS

    def place(column: float, row: float) -> np.ndarray:
        """Of a point in the window, in continuous pixels of the picture."""
        return np.asarray(warp @ [column - 0.5, row - 0.5, 1.0] + 0.5)

    for column, row, due in (
        (wide / 2, high * UP / (UP + DOWN), middle),
        (wide / 2, 0.0, middle + UP * size_px * way),
        (wide / 2, high, middle - DOWN * size_px * way),
        (wide, 0.0, middle + size_px * (UP * way + ASIDE * right)),
        (0.0, high, middle - size_px * (DOWN * way + ASIDE * right)),
    ):
        assert place(column, row) == pytest.approx(due, abs=1e-6)


@pytest.mark.parametrize("masked", [(True, True), (True, False), (False, True)])
def test_axes_about_who_leans_point_to_the_head_and_to_a_camera(masked: tuple[bool, bool]) -> None:
    """To camera 1 where it sees, x to the side where camera 2 does not stand; to the right of
    camera 2's sight where that alone sees."""
    up = np.array([0.6, 0.8, 0.0])
    middle_m = np.array([0.1, 1.0, -0.2])
    mask = np.ones((2, 2), np.bool_)
    masks = mask if masked[0] else None, mask if masked[1] else None
    axes = _about(masks, RIG, middle_m, up)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-9)
    assert axes[1] == pytest.approx(up)
    first, second = (centre(camera) - middle_m for camera in RIG.cameras)
    if masked[0]:
        assert axes[2] @ first > 0.9 * np.linalg.norm(first - (first @ up) * up)
        if masked[1]:
            assert axes[0] @ second < 0.0
    else:
        assert axes[0] @ second < 0.0
        assert np.linalg.det(axes) == pytest.approx(1.0)
    assert not masked[0] or np.linalg.det(axes) > 0.0


def test_in_a_room_the_other_way_round_the_axes_about_who_leans_are_left_handed() -> None:
    mask, up = np.ones((2, 2), np.bool_), np.array([0.0, 0.6, 0.8])
    middle_m = np.array([0.1, 1.0, -0.2])
    plain = _about((mask, mask), RIG, middle_m, up)
    glass = _about((mask, mask), in_mirror(RIG), middle_m * MIRROR, up * MIRROR)
    assert glass == pytest.approx(plain * MIRROR, abs=1e-9)
    assert np.linalg.det(glass) == pytest.approx(-1.0)
    one = _about((mask, None), in_mirror(RIG), middle_m * MIRROR, up * MIRROR)
    assert np.linalg.det(one) == pytest.approx(1.0)


@pytest.mark.parametrize("lean_deg", [0.0, 40.0])
@pytest.mark.parametrize("steeper", [0, 1])
def test_a_view_along_the_body_is_left_out_where_it_is_the_steeper_and_too_steep(
    steeper: int, lean_deg: float
) -> None:
    masks = np.ones((2, 2), np.bool_), np.ones((2, 2), np.bool_)
    middle_m = np.array([0.0, 1.0, 0.0])
    away = centre(RIG.cameras[steeper]) - middle_m
    away /= np.linalg.norm(away)
    side = np.array([0.0, 1.0, 0.0])
    side = side - (side @ away) * away
    for rise, out in ((STEEPEST - 0.02, False), (STEEPEST + 0.02, True)):
        up = rise * away + np.sqrt(1.0 - rise**2) * side / np.linalg.norm(side)
        first, second = _from_a_side(masks, RIG, middle_m, up)
        assert (first is None) == (out and steeper == 0)
        assert (second is None) == (out and steeper == 1)
    alone = (masks[0], None) if steeper == 0 else (None, masks[1])
    assert _from_a_side(alone, RIG, middle_m, up) == alone


def test_a_view_says_where_its_camera_is_and_how_large_the_person_is_there() -> None:
    turn, away_m, said = (
        np.linalg.qr(np.arange(9.0).reshape(3, 3) ** 2)[0],
        np.array([1, 2, -2.0]),
        np.zeros(5, np.float32),
    )
    _tell(turn, away_m, 1.5, said)
    assert said[0] == 1.0
    assert said[1:4] == pytest.approx(turn @ away_m / 3.0, abs=1e-6)
    assert said[4] == pytest.approx(NEARNESS * 1.5 / 3.0)


@pytest.mark.parametrize("since_s", [0.0, 0.1, LONGEST_S, 9.0])
def test_a_gap_is_said_in_frames_and_no_longer_than_it_may_be(since_s: float) -> None:
    mask = drawn(RIG.cameras[0], (640, 480))
    found = look((mask, None), RIG, STATURE_M, since_s)
    assert found is not None
    assert found.beside[-1] == pytest.approx(min(since_s, LONGEST_S) * 15.0 - 1.0, abs=1e-6)
    assert found.beside[5:10].tolist() == [0.0] * 5


def test_who_seems_to_stand_too_near_or_too_far_is_looked_for_at_the_bounds() -> None:
    """A level camera; the feet just under its horizon, or at its own."""
    camera = RIG.cameras[0]
    for rows, far_m in (
        ((200, 242), TALLEST_M * 800.0 / 42.0),
        ((100, 200), TALLEST_M * 800.0 / 100.0),
        ((2, 478), None),
    ):
        mask = np.zeros((480, 640), np.bool_)
        mask[rows[0] : rows[1], 310:330] = True
        found = standing_m(mask, camera)
        flat_m = float(np.hypot(*(found - centre(camera))[[0, 2]]))
        lens_m = centre(camera)[1]
        due = lens_m * 800.0 / (rows[1] - 240.0) if far_m is None else far_m
        assert flat_m == pytest.approx(max(due, NEAR_M), rel=0.01)


def test_who_is_forty_metres_off_in_a_long_lens_stands_where_their_feet_are() -> None:
    """Twelve metres were the bound once: there the same silhouette is of a child of half a metre,
    metres above the floor. The perspective that is said beside is that of FAR_M."""
    camera = paper_rig((640, 480), (5200.0, 5200.0), (40.0, 40.0)).cameras[0]
    mask = np.zeros((480, 640), np.bool_)
    (column, top), (_, bottom) = project(camera, np.array([[0.3, 1.8, 0.0], [0.3, 0.0, 0.0]]))
    mask[round(top) : round(bottom), round(column) - 20 : round(column) + 20] = True
    assert standing_m(mask, camera) == pytest.approx([0.3, 0.9, 0.0], abs=0.2)
    said = np.zeros(5, np.float32)
    _tell(np.eye(3), np.array([0.0, 0.0, 40.0]), 1.5, said)
    assert said[4] == pytest.approx(NEARNESS * 1.5 / FAR_M)


@pytest.mark.parametrize("roll_deg", [0.0, 65.0])
def test_a_camera_that_looks_straight_down_has_its_own_right(roll_deg: float) -> None:
    """Its picture's right is level; a little of height in it is left out."""
    roll, tilt = np.radians([roll_deg, 1.0])
    right = np.array([np.cos(roll), np.sin(tilt), np.sin(roll)])
    level = right * [1.0, 0.0, 1.0]
    R = np.stack([right, np.cross([0.0, -1.0, 0.0], right), [0.0, -1.0, 0.0]])
    above = Camera(
        "above",
        ((200.0, 0.0, 80.0), (0.0, 200.0, 60.0), (0.0, 0.0, 1.0)),
        as_matrix(R),
        (0.0, 0.0, 0.0),
    )
    other = paper_rig((160, 120), (200.0, 200.0), (4.0, 4.0)).cameras[0]
    found = axes_of(above, other)
    assert found == pytest.approx(
        np.stack([level, [0.0, 1.0, 0.0], np.cross(level, [0.0, 1.0, 0.0])])
    )
