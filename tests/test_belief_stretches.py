"""When a body was believed: stretches by hand, what is listed, which frames are worth least."""

import numpy as np
import pytest

from animator.report.belief_stretches import doubts, stretches_of, worst_rows
from common.npz_file import Arrays

STATES = ["empty"] * 2 + ["tracking"] * 3 + ["predicted"] + ["lost"] * 3 + ["tracking"]


def run() -> Arrays:
    n = len(STATES)
    confidence, joints_m = np.full((n, 15), 0.9), np.zeros((n, 15, 3))
    confidence[[0, 1, 5, 6, 7, 8]] = 0.0
    confidence[4] = 0.3
    joints_m[[0, 1, 6, 7, 8]] = np.nan
    seen = np.ones((n, 2), bool)
    seen[:2] = False
    seen[5:9, 1] = False
    return {
        "status": np.array(STATES),
        "confidence": confidence,
        "joints_m": joints_m,
        "time_s": np.arange(n) / 10,
        "seen": seen,
        "score": np.where(seen, 0.8, 0.0),
        "camera_names": np.array(["cam1", "door"]),
    }


def test_the_run_is_cut_where_its_state_changes() -> None:
    found = stretches_of(run())
    assert [(one.state, one.first, one.last) for one in found] == [
        *(("empty", 0, 1), ("tracking", 2, 3), ("doubted", 4, 4), ("predicted", 5, 5)),
        *(("lost", 6, 8), ("tracking", 9, 9)),
    ]
    assert sum(one.wide for one in found) == pytest.approx(100.0)
    assert [one.left for one in found] == pytest.approx([0.0, 20.0, 40.0, 50.0, 60.0, 90.0])


def test_a_doubt_says_why_and_which_camera_did_not_show_the_person() -> None:
    (lost,) = doubts(stretches_of(run()))
    assert (lost.from_s, lost.until_s) == pytest.approx((0.6, 0.9))
    assert "no pose fits" in lost.why
    assert lost.why.endswith("door did not show the person")


def test_frames_without_a_pose_are_the_worst_and_those_without_a_person_do_not_count() -> None:
    assert worst_rows(run(), 1, 0.5) == [5]
    assert worst_rows(run(), 9, 0.25) == [2, 5, 8]
    assert worst_rows(run(), 2, 0.05) == [5, 6]
    assert worst_rows({**run(), "status": np.array(["empty"] * 10)}, 3, 0.1) == []


def test_a_run_without_a_frame_has_no_stretch() -> None:
    nothing = {name: array[:0] for name, array in run().items() if name != "camera_names"}
    assert stretches_of(nothing) == []
