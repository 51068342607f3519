"""Two runs compared: the page beside the first, the numbers, and runs that cannot be compared."""

import os
from pathlib import Path

import pytest
from written_runs import body, written

from common.body.body import POSE_INDEX, Vector, rest_pose
from common.bus.messages import Status
from runtime.store.past_run import PastRunError
from tritrack.reporting.comparing import compare_runs


def bent(folder: Path, knee_deg: float, aside_m: float = 0.0) -> Path:
    pose = rest_pose()
    pose[POSE_INDEX["r_knee_x"]] = -knee_deg
    pose[0] = aside_m
    return written(folder, [body(n, pose) for n in range(5)])


def test_a_knee_that_is_bent_further_is_told_in_degrees_and_a_place_in_mm(tmp_path: Path) -> None:
    one, other = bent(tmp_path / "a", 40.0), bent(tmp_path / "b", 55.0, aside_m=0.06)
    facts = compare_runs(one, other)
    (told,) = facts["people"]
    knee = next(own for name, own in told["angles_deg"].items() if name.startswith("knee"))
    right = {name: own for name, own in told["angles_deg"].items() if name.endswith("_r")}
    assert knee["frames"] == 5
    assert abs(next(v["mean"] for n, v in right.items() if "knee" in n)) == pytest.approx(
        15.0, abs=1
    )
    assert told["joints_mm"]["pelvis"]["median"] == pytest.approx(60.0)
    assert told["joints_beside_hips_mm"]["l_knee"]["median"] == pytest.approx(0.0, abs=0.01)
    page = (one / "compare.html").read_text()
    assert "a/run and b/run" in page
    assert Path(facts["file"]) == one / "compare.html"


def test_runs_that_cannot_be_compared_are_refused(tmp_path: Path) -> None:
    one = bent(tmp_path / "a", 40.0)
    with pytest.raises(PastRunError, match="are one run"):
        compare_runs(one, one)
    nobody = written(tmp_path / "c", [body(n, None, "empty") for n in range(3)])
    with pytest.raises(PastRunError, match="no same time"):
        compare_runs(one, nobody)


def test_a_page_is_utf_8_wherever_it_is_written_and_whatever_runs_are_called(
    tmp_path: Path,
) -> None:
    named = os.fsdecode(b"caf\xe9")
    one = bent(tmp_path / "a", 40.0).parent.rename(tmp_path / named) / "run"
    compare_runs(one, bent(tmp_path / "größe", 55.0))
    assert "caf?/run and größe/run" in (one / "compare.html").read_text("utf-8")


def test_a_person_whom_one_run_alone_has_a_pose_of_is_told_without_a_number(
    tmp_path: Path,
) -> None:
    def two(folder: Path, second: Vector | None) -> Path:
        rows = [(n, person) for n in range(5) for person in (1, 2)]
        poses: dict[int, Vector | None] = {1: rest_pose(), 2: second}
        status: dict[bool, Status] = {True: "lost", False: "tracking"}
        return written(
            folder, [body(n, poses[p], status[poses[p] is None], person=p) for n, p in rows]
        )

    facts = compare_runs(two(tmp_path / "a", rest_pose()), two(tmp_path / "b", None))
    assert facts["lines"][1] == "Person 2: no frame in which both have a pose"
