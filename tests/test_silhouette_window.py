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
from integrator.proposal.silhouette_window import BESIDE, CELLS, axes_of, look, standing_m

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
