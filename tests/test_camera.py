"""Cameras, held against the paper's equations, OpenCV's own projection and the rendered truth."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.rig.camera import (
    Camera,
    Rig,
    as_matrix,
    as_paper_rig,
    as_row,
    centre,
    paper_rig,
    project,
    px_per_m,
    ray,
    rays,
)
from common.rig.rig_file import CalibrationError, check_rig, fitted, load_rig

LENS = (-0.2, 0.06, 0.001, -0.002, 0.0)
places = st.tuples(st.floats(-1.5, 1.5), st.floats(0.0, 2.0), st.floats(-1.5, 1.5))


def rig_of_size(width: int = 320, height: int = 240) -> Rig:
    return paper_rig((width, height), (401.0, 380.0), (4.5, 4.0), (1.0, 1.2))


@given(places)
def test_the_papers_rig_projects_by_the_papers_equations(place: tuple[float, float, float]) -> None:
    """C1: x1 = lambda1 X / (Zc1 - Z), z2 = lambda2 Z / (X - Xc2), Y up; C8: from the centre."""
    x, y, z = place
    (u1, v1), (u2, v2) = (project(one, np.array([place]))[0] for one in rig_of_size().cameras)
    assert u1 - 160.0 == pytest.approx(401.0 * x / (4.5 - z))
    assert u2 - 160.0 == pytest.approx(380.0 * z / (x + 4.0))
    assert 120.0 - v1 == pytest.approx(401.0 * (y - 1.0) / (4.5 - z))
    assert 120.0 - v2 == pytest.approx(380.0 * (y - 1.2) / (x + 4.0))


def test_the_person_who_faces_camera_1_shows_their_right_at_its_left() -> None:
    """C2: the right side is -X; camera 2 sees them facing right."""
    first, second = rig_of_size().cameras
    right_hand, nose = np.array([[-0.5, 1.0, 0.0]]), np.array([[0.0, 1.0, 0.3]])
    assert project(first, right_hand)[0, 0] < 160.0
    assert project(second, nose)[0, 0] > 160.0


def test_the_centre_of_the_top_left_pixel_is_a_half() -> None:
    """C8: at 160x120 the optical centre is (79.5, 59.5) counted from zero, (80, 60) here, so that
    a picture of half the size shows everything at half the pixels."""
    large = rig_of_size(320, 240)
    small = fitted(large, (160, 120), "calibration.json")
    points = np.random.default_rng(8).uniform((-1, 0, -1), (1, 2, 1), (50, 3))
    for before, after in zip(large.cameras, small.cameras, strict=True):
        assert project(after, points) == pytest.approx(project(before, points) / 2)
    axis = np.array([[0.0, 1.0, 0.0]])
    assert project(small.cameras[0], axis)[0].tolist() == [80.0, 60.0]
    assert (small.width, small.height) == (160, 120)


@pytest.mark.parametrize("lens", [(), LENS], ids=["straight", "distorted"])
@given(place=places)
def test_a_ray_goes_back_to_the_point_that_the_pixel_shows(
    lens: tuple[float, ...], place: tuple[float, float, float]
) -> None:
    for camera in rig_of_size().cameras:
        bent = msgspec.structs.replace(camera, distortion=lens)
        u, v = project(bent, np.array([place]))[0].tolist()
        direction, there = ray(bent, (u, v)), np.array(place) - centre(bent)
        assert np.linalg.norm(direction) == pytest.approx(1.0)
        off_px = np.linalg.norm(np.cross(direction, there / np.linalg.norm(there))) * 401.0
        assert off_px < 0.01
        assert direction @ there > 0


def test_distortion_is_opencvs() -> None:
    """A calibration that OpenCV made projects as OpenCV projects it."""
    camera = msgspec.structs.replace(rig_of_size().cameras[1], distortion=LENS)
    points = np.random.default_rng(5).uniform((-1, 0, -1), (1, 2, 1), (40, 3))
    turn, _ = cv2.Rodrigues(np.array(camera.R))
    wanted, _ = cv2.projectPoints(
        points, turn, np.array(camera.t), np.array(camera.K), np.array(LENS)
    )
    assert project(camera, points) == pytest.approx(wanted[:, 0], abs=1e-4)
    straight = msgspec.structs.replace(camera, distortion=())
    assert np.abs(project(straight, points) - wanted[:, 0]).max() > 0.5


@pytest.mark.parametrize("lens", [(), LENS])
def test_what_is_behind_a_camera_has_no_pixel(lens: tuple[float, ...]) -> None:
    camera = msgspec.structs.replace(rig_of_size().cameras[0], distortion=lens)
    pixels = project(camera, np.array([[0.0, 1.0, 5.0], [0.0, 1.0, 4.5], [0.0, 1.0, 0.0]]))
    assert np.isnan(pixels[:2]).all()
    assert pixels[2].tolist() == pytest.approx([160.0, 120.0])


def test_the_rendered_clips_project_to_their_own_pixels(data_dir: Path) -> None:
    """The development rig is the paper's kind, and its truth in metres falls on its pixels."""
    rig = load_rig(data_dir / "dev" / "calibration.json", wanted=("cam1", "cam2"))
    truth = np.load(data_dir / "dev" / "r01_t1_01_walk_in_place" / "truth.npz")
    there = truth["present"].astype(bool)
    for n, camera in enumerate(rig.cameras, 1):
        seen = project(camera, truth["joints3d"][there].reshape(-1, 3))
        assert np.abs(seen - truth[f"joints2d_cam{n}"][there].reshape(-1, 2)).max() < 0.05
        assert centre(camera)[1] == pytest.approx(1.0)
    assert as_paper_rig(rig) == pytest.approx((401.14, 401.14, 4.5, 4.5))


def test_a_paper_rig_is_known_again_and_a_turned_one_is_not() -> None:
    rig = rig_of_size()
    assert as_paper_rig(rig) == pytest.approx((401.0, 380.0, 4.5, 4.0))
    for yaw_deg, still in ((1e-6, True), (0.01, False)):
        assert (
            as_paper_rig(_with_second(rig, _turned(rig.cameras[1], yaw_deg))) is not None
        ) is still
    aside = msgspec.structs.replace(rig.cameras[0], t=(0.001, 1.0, 4.5))
    assert as_paper_rig(msgspec.structs.replace(rig, cameras=(aside, rig.cameras[1]))) is None
    assert as_paper_rig(msgspec.structs.replace(rig, cameras=rig.cameras[:1])) is None


def test_a_distortion_beside_the_cameras_holds_for_those_without_their_own(tmp_path: Path) -> None:
    """The calibration's contract."""
    content = _content()
    content["distortion"] = list(LENS)
    content["cameras"][1]["distortion"] = [0.1, 0.0, 0.0, 0.0]
    rig = load_rig(_written(tmp_path, content))
    assert rig.cameras[0].distortion == LENS
    assert rig.cameras[1].distortion == (0.1, 0.0, 0.0, 0.0)


def test_cameras_are_taken_by_name_in_the_order_that_is_asked_for(tmp_path: Path) -> None:
    path = _written(tmp_path, _content())
    assert [one.name for one in load_rig(path, wanted=("cam2", "cam1")).cameras] == ["cam2", "cam1"]
    with pytest.raises(CalibrationError, match="no camera 'cam3'; it has cam1, cam2"):
        load_rig(path, wanted=("cam3",))


def _camera_change(key: str, value: object) -> Callable[[dict[str, Any]], object]:
    return lambda content: content["cameras"][0].update({key: value})


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            _camera_change("R", [[1, 0, 0], [0, 1, 0], [0, 0, 1.1]]),
            "R of camera cam1 is no rot",
        ),
        (_camera_change("R", [[1, 0, 0], [0, 1, 0], [0, 0, -1]]), "determinant -1"),
        (_camera_change("R", [[1, 0, 0], [0, 1, 0]]), "cameras 1, R must have 3 entries"),
        (
            _camera_change("K", [[-400, 0, 160], [0, 400, 120], [0, 0, 1]]),
            "no positive focal",
        ),
        (_camera_change("K", [[400, 0, 0], [0, 400, 0], [160, 120, 1]]), "transposed"),
        (
            _camera_change("t", [0.0, 1e999, 4.5]),
            r"t of camera cam1 has a number that is not finite",
        ),
        (_camera_change("distortion", [0.1, 0.2, 0.3]), "3 distortion numbers"),
        (lambda content: content.update(width=0), "picture size 0x240 is not positive"),
        (lambda content: content.update(cameras=[]), "names no camera"),
        (lambda content: content.pop("height"), "height is missing"),
    ],
)
def test_a_calibration_that_no_cameras_could_form_is_refused(
    tmp_path: Path, change: Callable[[dict[str, Any]], object], says: str
) -> None:
    content = _content()
    change(content)
    with pytest.raises(CalibrationError, match=says):
        load_rig(_written(tmp_path, content))


def test_numbers_that_are_not_finite_are_refused() -> None:
    """JSON cannot say them, other imports can."""
    rig = rig_of_size()
    for field, values in (("t", (0.0, math.nan, 4.5)), ("distortion", (math.inf, 0.0, 0.0, 0.0))):
        wrong = msgspec.structs.replace(rig.cameras[0], **{field: values})
        said = f"here: {field} of camera cam1 has a number that is not finite"
        with pytest.raises(CalibrationError, match=said):
            check_rig(msgspec.structs.replace(rig, cameras=(wrong,)), "here")


@pytest.mark.parametrize("field", ["K", "R", "t", "distortion"])
def test_what_is_not_finite_in_a_file_is_named_with_its_camera(tmp_path: Path, field: str) -> None:
    """JSON has no NaN, though many programs write it."""
    content = _content()
    camera = dict(content["cameras"][1]) | {"distortion": [0.0, 0.0, 0.0, 0.0]}
    values = np.array(camera[field])
    values[..., 0] = np.nan
    content["cameras"][1] = camera | {field: values.tolist()}
    said = rf"calibration\.json: {field} of camera cam2 has a number that is not finite"
    with pytest.raises(CalibrationError, match=said):
        load_rig(_written(tmp_path, content))


@pytest.mark.parametrize("content", [b"", b"[]", b"\xff\xfe", b"[" * 100_000])
def test_bytes_that_are_no_calibration_are_refused_with_the_files_name(
    tmp_path: Path, content: bytes
) -> None:
    path = tmp_path / "calibration.json"
    path.write_bytes(content)
    with pytest.raises(CalibrationError, match=r"calibration\.json"):
        load_rig(path)
    with pytest.raises(
        CalibrationError, match=r"cannot read the calibration .*tritrack calibrate person"
    ):
        load_rig(tmp_path / "absent.json")


@pytest.mark.parametrize("size", [(320, 320), (240, 320), (160, 100)])
def test_pictures_of_another_shape_are_refused(size: tuple[int, int]) -> None:
    with pytest.raises(CalibrationError, match="320x240 pictures, the clip has"):
        fitted(rig_of_size(), size, "calibration.json")


def _content() -> dict[str, Any]:
    content: dict[str, Any] = msgspec.to_builtins(rig_of_size())
    content["cameras"] = list(content["cameras"])
    del content["distortion"]
    return content


def _written(folder: Path, content: dict[str, Any]) -> Path:
    path = folder / "calibration.json"
    path.write_text(json.dumps(content).replace("Infinity", "1e999"))
    return path


def _turned(camera: Camera, yaw_deg: float) -> Camera:
    turn, _ = cv2.Rodrigues(np.array([0.0, math.radians(yaw_deg), 0.0]))
    R = turn @ np.array(camera.R)
    return msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(-R @ centre(camera)))


def _with_second(rig: Rig, camera: Camera) -> Rig:
    return msgspec.structs.replace(rig, cameras=(rig.cameras[0], camera))


def test_a_metre_is_the_focal_length_over_the_depth() -> None:
    rig = paper_rig((160, 120), (150.0, 180.0), (4.0, 5.0))
    assert px_per_m(rig.cameras[0], np.array([0.3, 1.0, 1.0])) == pytest.approx(150.0 / 3.0)
    assert px_per_m(rig.cameras[1], np.array([1.0, 1.0, 0.3])) == pytest.approx(180.0 / 6.0)
    assert math.isnan(px_per_m(rig.cameras[0], np.array([0.0, 1.0, 4.5])))


def test_rays_of_many_pixels_are_those_of_each() -> None:
    for camera in rig_of_size().cameras:
        pixels = np.random.default_rng(4).uniform(0.0, 320.0, (9, 2))
        each = [ray(camera, (float(u), float(v))) for u, v in pixels]
        assert rays(camera, pixels) == pytest.approx(np.array(each), abs=1e-12)


@pytest.mark.parametrize(("width", "well"), [(314, True), (313, False), (326, True), (327, False)])
def test_pictures_may_differ_by_two_hundredths_in_their_shape(width: int, well: bool) -> None:
    """Of 320x240; each way is scaled by itself."""
    if not well:
        with pytest.raises(
            CalibrationError, match=f"^it is for 320x240 pictures, .* {width}x240: "
        ):
            fitted(rig_of_size(), (width, 240), "it")
        return
    rig = fitted(rig_of_size(), (2 * width, 480), "it")
    assert (rig.width, rig.height) == (2 * width, 480)
    for camera, focal_px in zip(rig.cameras, (401.0, 380.0), strict=True):
        across = width / 160
        due = ((focal_px * across, 0, 160 * across), (0, 2 * focal_px, 240), (0, 0, 1))
        assert np.array(camera.K) == pytest.approx(np.array(due))


@pytest.mark.parametrize("change", ["turned", "aside 1", "aside 2", "three", "one"])
def test_a_rig_that_nearly_stands_as_the_papers_is_none(change: str) -> None:
    rig = rig_of_size()
    one, two = rig.cameras
    slight = np.eye(3) + 1e-5 * np.array([[0.0, 0, 1], [0, 0, 0], [-1, 0, 0]])
    cameras = {
        "turned": (one, msgspec.structs.replace(two, R=as_matrix(slight @ np.array(two.R)))),
        "aside 1": (msgspec.structs.replace(one, t=(1e-5, *one.t[1:])), two),
        "aside 2": (one, msgspec.structs.replace(two, t=(1e-5, *two.t[1:]))),
        "three": (one, two, two),
        "one": (one,),
    }[change]
    assert as_paper_rig(rig) == (401.0, 380.0, 4.5, 4.0)
    assert as_paper_rig(msgspec.structs.replace(rig, cameras=cameras)) is None
