"""Calibrations of other programs, held against what these project and against their own files."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from calibration.foreign.imported_rig import imported_rig
from calibration.foreign.toml_rig import TomlKind, toml_text
from calibration.tracks.rig_guess import rotation
from common.rig.camera import Camera, Rig, as_matrix, as_row, centre, project
from common.rig.rig_file import CalibrationError

BENT = (-0.05, 0.14, 0.0006, 0.0007)


def tilted() -> Rig:
    cameras = []
    for n, (yaw, at) in enumerate(((0.1, (0.2, 1.4, 4.0)), (-1.4, (-4.1, 1.8, 0.3)))):
        R = rotation(yaw, -0.1, 0.05 * n)
        K = ((900.0, 0.0, 500.5), (0.0, 905.0, 380.5), (0.0, 0.0, 1.0))
        t = as_row(-R @ np.array(at))
        cameras.append(Camera(f"cam{n + 1}", K, as_matrix(R), t, BENT))
    return Rig(1000, 760, tuple(cameras))


@pytest.mark.parametrize("kind", ["pose2sim", "caliscope"])
def test_what_is_written_for_another_program_comes_back_the_same(
    tmp_path: Path, kind: TomlKind
) -> None:
    path = tmp_path / "Calib.toml"
    path.write_text(toml_text(tilted(), kind))
    found = imported_rig(path)
    points = np.random.default_rng(1).uniform(-0.7, 1.2, (20, 3))
    for one, other in zip(found.cameras, tilted().cameras, strict=True):
        assert project(one, points) == pytest.approx(project(other, points), abs=1e-6)


def test_a_file_of_pose2sim_projects_as_opencv_does(tmp_path: Path) -> None:
    """Its world has z up; OpenCV's pixels have their centres at whole numbers: within 0.01 px."""
    turn, shift = (1.2, 1.3, -1.1), (0.1, 0.9, 3.5)
    path = tmp_path / "Calib.toml"
    path.write_text(
        "".join(
            f'[cam{n}]\nname = "cam{n}"\nsize = [1088.0, 1920.0]\nrotation = {list(turn)}\n'
            f"matrix = [[1600.0, 0.0, 530.0], [0.0, 1601.0, 950.0], [0.0, 0.0, 1.0]]\n"
            f"translation = {list(shift)}\ndistortions = {list(BENT)}\nfisheye = false\n"
            for n in (1, 2)
        )
    )
    found = imported_rig(path)
    K = np.array([[1600.0, 0.0, 530.0], [0.0, 1601.0, 950.0], [0.0, 0.0, 1.0]])
    theirs = np.random.default_rng(2).uniform(-0.5, 0.5, (10, 3))
    wanted, _ = cv2.projectPoints(theirs, np.array(turn), np.array(shift), K, np.array(BENT))
    ours = theirs[:, [1, 2, 0]]  # y is their z
    assert project(found.cameras[0], ours) - 0.5 == pytest.approx(wanted[:, 0], abs=0.01)


def test_qualisys_cameras_stand_where_their_laboratory_has_them(data_dir: Path) -> None:
    folder = data_dir / "real" / "pose2sim_balancing"
    found = imported_rig(folder / "Calib.qca.txt", ("cam01", "cam04"))
    told = {c["name"]: c for c in json.loads((folder / "cameras.json").read_text())["cameras"]}
    assert (found.width, found.height) == (1088, 1920)
    for camera in found.cameras:
        there = told[camera.name]
        assert centre(camera)[[2, 0, 1]] == pytest.approx(there["centre_world_m"], abs=1e-6)
        turned_back = np.array(camera.R)[:, [2, 0, 1]]
        assert turned_back == pytest.approx(np.array(there["R_world_to_cam"]), abs=1e-6)
        K = np.array(there["K_calib"])
        K[:2, 2] += 0.5
        assert np.array(camera.K) == pytest.approx(K, abs=1e-3)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.toml", "[cam1]\nmatrix = [[1]]\n", r"\[cam1\] has no rotation"),
        ("a.toml", "x = ", "no calibration in TOML"),
        (
            "a.toml",
            "[cam1]\nmatrix = [[1]]\nrotation = [0, 0, 0]\ntranslation = [0, 0, 0]\n"
            "size = [640, nan]\n",
            r"size of \[cam1\] is no size: \[640, nan\]",
        ),
        ("a.toml", "", r"a\.toml holds no camera in a form that is known: TOML of"),
        ("a.txt", "<a>", "no calibration of Qualisys"),
        ("a.csv", "", "known are .toml"),
    ],
)
def test_what_is_no_calibration_is_told_in_one_line(
    tmp_path: Path, name: str, text: str, said: str
) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(CalibrationError, match=said):
        imported_rig(tmp_path / name)


def turned(rig: Rig, deg: float) -> Rig:
    """The cameras rolled clockwise where they stand."""
    cos, sin = np.cos(np.radians(deg)), np.sin(np.radians(deg))
    roll = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    cameras = [
        Camera(
            *(one.name, one.K, as_matrix(roll @ np.array(one.R)), as_row(roll @ np.array(one.t)))
        )
        for one in rig.cameras
    ]
    return Rig(rig.width, rig.height, tuple(cameras))


@pytest.mark.parametrize("deg", [0, 80, 100, 180, 270, 280])
def test_caliscopes_quarter_turns_tell_which_way_is_up(tmp_path: Path, deg: int) -> None:
    """Its cameras are those of the pictures as they were filmed; it shows them turned."""
    path, rolled = tmp_path / "camera_array.toml", turned(tilted(), deg)
    text = toml_text(rolled, "caliscope")
    assert f"rotation_count = {round(deg / 90) % 4}" in text
    path.write_text(text.replace("rotation_count = 3", "rotation_count = -1"))
    points = np.random.default_rng(1).uniform(-0.7, 1.2, (20, 3))
    for one, other in zip(imported_rig(path).cameras, rolled.cameras, strict=True):
        assert project(one, points) == pytest.approx(project(other, points), abs=1e-6)


@pytest.mark.parametrize("deg", [85, 180, 275])
def test_rolled_cameras_of_which_nothing_is_told_need_the_axis_that_is_up(
    tmp_path: Path, deg: int
) -> None:
    path, rolled = tmp_path / "Calib.toml", turned(tilted(), deg)
    path.write_text(toml_text(rolled, "pose2sim"))
    with pytest.raises(CalibrationError, match=r"seem rolled by 90 degrees or more.*--up z"):
        imported_rig(path)
    points = np.random.default_rng(1).uniform(-0.7, 1.2, (20, 3))
    for one, other in zip(imported_rig(path, up="z").cameras, rolled.cameras, strict=True):
        assert project(one, points) == pytest.approx(project(other, points), abs=1e-6)
    upside_down = imported_rig(path, up="-z")
    heights_m = [centre(camera)[1] for camera in upside_down.cameras]
    assert heights_m == pytest.approx([-1.4, -1.8])


def test_a_quarter_turn_that_is_none_is_named(tmp_path: Path) -> None:
    path = tmp_path / "camera_array.toml"
    text = toml_text(tilted(), "caliscope")
    path.write_text(text.replace("rotation_count = 0", "rotation_count = 0.5", 1))
    with pytest.raises(CalibrationError, match=r"rotation_count of \[cam_0\] is no whole number"):
        imported_rig(path)
