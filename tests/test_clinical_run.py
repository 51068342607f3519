"""A run's clinical angles as a table: a row a frame, empty where nothing is known."""

import csv
from pathlib import Path

import numpy as np
import pytest
from written_runs import body, written

from animator.clinical.clinical_angles import NAMES
from animator.clinical.clinical_run import angles_csv, clinical_run
from common.body.body import JOINT_NAMES, POSE_INDEX, rest_pose
from runtime.store.past_run import open_run


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A knee that bends over six frames, with a frame without a pose among them."""
    bodies = []
    for n in range(6):
        pose = rest_pose()
        pose[POSE_INDEX["l_knee_x"]] = -15.0 * n
        bodies.append(body(n, pose if n != 3 else None, "tracking" if n != 3 else "lost"))
    return written(tmp_path, bodies)


def test_the_table_has_a_row_a_frame_and_empty_cells(run: Path) -> None:
    rows = list(csv.DictReader(angles_csv(open_run(run).poses).splitlines()))
    assert [row["frame"] for row in rows] == ["0", "1", "2", "3", "4", "5"]
    assert rows[3]["status"] == "lost"
    knees = [row["knee_angle_l"] for row in rows]
    assert knees[3] == ""
    assert float(knees[5]) - float(knees[4]) == pytest.approx(15.0, abs=3.0)
    assert {row["pro_sup_r"] for row in rows} == {""}
    assert {row["ankle_angle_r"] for row in rows} == {""}, "nobody measured the toes"
    assert rows[1]["hip_rotation_l"] == ""
    assert rows[5]["hip_rotation_l"] != ""
    wide = {float(row["knee_angle_l_95_deg"]) for row in rows if row["knee_angle_l_95_deg"]}
    assert min(wide) > 0.0
    assert float(rows[5]["l_knee_68_mm"]) < float(rows[5]["l_knee_95_mm"]) < 300.0
    assert len(rows[0]) == 4 + 3 * len(NAMES) + 2 * len(JOINT_NAMES)


def test_a_run_from_before_there_were_extremities_has_all_but_the_ankles(run: Path) -> None:
    poses = {
        name: array
        for name, array in open_run(run).poses.items()
        if not name.startswith("extremities")
    }
    found = clinical_run(poses)
    assert np.isfinite(found.angles_deg[0, NAMES.index("knee_angle_r")])
    assert np.isnan(found.angles_deg[:, NAMES.index("ankle_angle_l")]).all()
    assert found.bands_mm.shape == (6, 15, 2)
    assert np.isnan(found.bands_mm[3]).all()


def test_a_run_that_ended_before_its_first_frame_is_a_table_without_rows(tmp_path: Path) -> None:
    (line,) = angles_csv(open_run(written(tmp_path, [])).poses).splitlines()
    assert line.startswith("frame,person,time_s,status,")
