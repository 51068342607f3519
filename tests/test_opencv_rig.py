"""What OpenCV's samples write, held against what OpenCV projects with it."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from calibration.foreign.imported_rig import imported_rig
from common.rig.camera import project
from common.rig.rig_file import CalibrationError

K = np.array([[600.0, 0.0, 310.0], [0.0, 602.0, 245.0], [0.0, 0.0, 1.0]])
BENT = np.array([[-0.2, 0.06, 0.001, -0.002, 0.01]])
TURN = cv2.Rodrigues(np.array([0.05, -1.2, 0.02]))[0]
SHIFT = np.array([[3.0], [0.1], [2.0]])


def write(path: Path, nodes: dict[str, object]) -> None:
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in nodes.items():
        storage.write(name, value)
    storage.release()


@pytest.mark.parametrize("kind", ["yml", "xml"])
@pytest.mark.parametrize("apart", [True, False], ids=["two files", "one file"])
def test_two_cameras_project_as_opencv_does(tmp_path: Path, kind: str, apart: bool) -> None:
    """stereo_calib's names; y up is against OpenCV's y, pixels' centres are at a half."""
    lenses = {"image_width": 640, "image_height": 480, "M1": K, "D1": BENT, "M2": K, "D2": BENT}
    places = {"R": TURN, "T": SHIFT}
    write(tmp_path / f"intrinsics.{kind}", lenses if apart else lenses | places)
    if apart:
        write(tmp_path / f"extrinsics.{kind}", places)
    rig = imported_rig(tmp_path / f"intrinsics.{kind}")
    theirs = np.random.default_rng(1).uniform(-0.5, 0.5, (20, 3)) + np.array([0.0, 0.0, 3.0])
    ours = theirs * [-1.0, -1.0, 1.0]
    for camera, turn, shift in zip(
        rig.cameras, (np.eye(3), TURN), (np.zeros(3), SHIFT), strict=True
    ):
        wanted = cv2.projectPoints(theirs, turn, shift, K, BENT)[0][:, 0]
        assert project(camera, ours) - 0.5 == pytest.approx(wanted, abs=1e-6)


def test_one_camera_is_read_as_the_calibration_sample_writes_it(tmp_path: Path) -> None:
    path = tmp_path / "camera.yml"
    write(
        path,
        {
            "image_width": 640,
            "image_height": 480,
            "camera_matrix": K,
            "distortion_coefficients": BENT.T,
        },
    )
    (camera,) = imported_rig(path).cameras
    assert camera.K[0][2] == 310.5
    assert camera.distortion == pytest.approx(BENT.ravel())


@pytest.mark.parametrize(
    ("nodes", "said"),
    [
        ({"M1": K, "M2": K, "image_width": 640, "image_height": 480}, "no extrinsics.yml beside"),
        ({"camera_matrix": K}, "does not say how large the pictures are"),
        ({"image_width": 640, "image_height": 480}, "no camera_matrix, nor M1"),
    ],
)
def test_what_a_file_lacks_is_told(tmp_path: Path, nodes: dict[str, object], said: str) -> None:
    write(tmp_path / "lenses.yml", nodes)
    with pytest.raises(CalibrationError, match=said):
        imported_rig(tmp_path / "lenses.yml")


@pytest.mark.parametrize("text", ["", "a: [", "%YAML:1.0\n---\n- 3\n", "nothing"])
def test_what_is_no_file_of_opencvs_is_told_in_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.yml").write_text(text)
    with pytest.raises(CalibrationError, match=r"a\.yml"):
        imported_rig(tmp_path / "a.yml")


@pytest.mark.parametrize(
    ("was", "told"),
    [
        ("   cols: 3\n", ""),
        ("   cols: 3\n", "   cols: 2\n"),
        ("   rows: 3\n", "   rows: 9\n"),
        ("   rows: 3\n", "   rows: -3\n"),
        ("[ 600.", "[ 1., 600."),
        ("[ 600.", "[ x, 600."),
        ("[ 600.", "[ \udcff, 600."),
        ("image_width: 640", "image_width: wide"),
        ("image_width: 640", "image_width: [ 640 ]"),
    ],
)
def test_a_matrix_of_another_size_than_it_says_is_refused(
    tmp_path: Path, was: str, told: str
) -> None:
    """OpenCV's own reader of matrices writes beyond its memory there."""
    path = tmp_path / "camera.yml"
    write(path, {"image_width": 640, "image_height": 480, "camera_matrix": K})
    text = path.read_text()
    assert was in text
    path.write_text(text.replace(was, told, 1), errors="surrogateescape")
    with pytest.raises(CalibrationError, match=r"camera\.yml"):
        imported_rig(path)
