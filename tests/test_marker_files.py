"""TRC and C3D, read back: markers are the run's joints in OpenSim's axes, gaps are gaps."""

import struct
from pathlib import Path

import numpy as np
import pytest
from moving import random_joints

from animator.exchange.marker_files import c3d_bytes, forward_x, trc_text
from common.body.body import JOINT_NAMES


def with_a_gap() -> np.ndarray:
    joints_m = random_joints(2, 12)
    joints_m[5] = np.nan
    return joints_m


def test_who_faces_camera_1_faces_forward() -> None:
    """OpenSim: +x forward, +y up, +z to the right; here +z is forward and +x to the left."""
    assert forward_x(np.array([0.0, 0.0, 1.0])).tolist() == [1.0, 0.0, 0.0]
    assert forward_x(np.array([0.0, 1.0, 0.0])).tolist() == [0.0, 1.0, 0.0]
    assert forward_x(np.array([-1.0, 0.0, 0.0])).tolist() == [0.0, 0.0, 1.0]


def test_a_trc_file_holds_every_joint_in_millimetres() -> None:
    joints_m = with_a_gap()
    lines = trc_text(joints_m, 1 / 15, "walk.trc").splitlines()
    assert lines[0].split("\t") == ["PathFileType", "4", "(X/Y/Z)", "walk.trc"]
    facts = dict(zip(lines[1].split("\t"), lines[2].split("\t"), strict=True))
    assert (facts["NumFrames"], facts["NumMarkers"], facts["Units"]) == ("12", "15", "mm")
    assert lines[3].split("\t")[2::3][:15] == list(JOINT_NAMES)
    assert lines[4].split("\t") == [
        "",
        "",
        *(f"{axis}{n + 1}" for n in range(15) for axis in "XYZ"),
    ]
    assert facts["DataRate"] == facts["CameraRate"] == facts["OrigDataRate"] == "15.000000"
    assert (facts["OrigDataStartFrame"], facts["OrigNumFrames"]) == ("1", "12")
    table = [line.split("\t") for line in lines[6:]]
    assert [row[0] for row in table] == [str(n) for n in range(1, 13)]
    read = np.array([[float(cell) for cell in row[2:]] for row in table])
    assert np.isnan(read[5]).all()
    assert read == pytest.approx(1e3 * forward_x(joints_m).reshape(12, 45), abs=0.001, nan_ok=True)
    assert float(table[11][1]) == pytest.approx(11 / 15, abs=1e-6)


def test_a_c3d_file_opens_in_ezc3d(tmp_path: Path) -> None:
    ezc3d = pytest.importorskip("ezc3d", reason="pip install 'tritrack[export]'")
    joints_m = with_a_gap()
    (tmp_path / "walk.c3d").write_bytes(c3d_bytes(joints_m, 1 / 15))
    read = ezc3d.c3d(str(tmp_path / "walk.c3d"))
    point = read["parameters"]["POINT"]
    assert point["LABELS"]["value"] == list(JOINT_NAMES)
    assert point["UNITS"]["value"] == ["mm"]
    assert point["RATE"]["value"][0] == pytest.approx(15.0)
    places_mm = read["data"]["points"][:3].transpose(2, 1, 0)
    assert np.isnan(places_mm[5]).all()
    off_mm = np.delete(places_mm - 1e3 * forward_x(joints_m), 5, axis=0)
    assert np.abs(off_mm).max() < 1.0


def test_what_was_not_seen_is_an_invalid_point_for_every_reader_of_c3d() -> None:
    """As the format has it, read by hand: place 0 and residual -1, no number that is none."""
    pytest.importorskip("ezc3d", reason="pip install 'tritrack[export]'")
    content = c3d_bytes(with_a_gap(), 1 / 15)
    (block,) = struct.unpack_from("<H", content, 16)
    points = np.frombuffer(content, "<f4", 12 * 15 * 4, (block - 1) * 512).reshape(12, 15, 4)
    assert np.array_equal(points[5], np.tile([0.0, 0.0, 0.0, -1.0], (15, 1)))
    assert (np.delete(points, 5, axis=0)[..., 3] >= 0.0).all()
