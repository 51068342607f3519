"""Several people of a run and a truth, one by one."""

import numpy as np
from test_identity import STAY, joints_at, poses_of, truth_of

from lab.accuracy.accuracy import compare, summary
from lab.accuracy.identity import gaps_of
from lab.accuracy.people_apart import Apart, apart


def each_of(poses: dict[str, np.ndarray], truth: dict[str, np.ndarray]) -> list[Apart]:
    poses = {**poses, "confidence": np.ones(poses["joints_m"].shape[:2])}
    return [*apart(poses, truth, gaps_of(poses, truth))]


def test_each_has_the_rows_of_their_number_and_their_own_truth() -> None:
    """Number 4 is 20 mm off person 1, number 6 is 50 mm off person 0 and missing once."""
    bodies = [(i, 4, 2.02) for i in range(4)] + [(i, 6, 0.05) for i in range(3)]
    truth = {
        **STAY,
        "performer": np.array(["ann", "bob"]),
        "measures": np.array([[1.0], [2.0]]),
        "mask_cam1": np.zeros((8, 2, 1), np.uint8),
        "gain": np.ones((2, 4)),
    }
    ann, bob = each_of(poses_of(*bodies), truth)
    assert (str(ann.truth["performer"]), bob.truth["measures"].tolist()) == ("ann", [2.0])
    assert ann.poses["person"].tolist() == [6] * 3
    np.testing.assert_array_equal(bob.truth["joints3d"], joints_at(np.full(4, 2.0)))
    assert not {"mask_cam1", "frame", "person"} & set(ann.truth)
    assert ann.truth["gain"].shape == (2, 4)
    told = [summary([compare(*one)]) for one in (ann, bob)]
    assert [round(one["abs_mm"]["mean"], 6) for one in told] == [50.0, 20.0]
    assert [one["coverage"] for one in told] == [0.75, 1.0]


def test_who_was_never_tracked_has_no_rows() -> None:
    zero, one = each_of(poses_of((0, 3, 0.0)), STAY)
    assert (len(zero.poses["frame"]), len(one.poses["frame"])) == (1, 0)
    far, away = each_of(poses_of((0, 3, 9.0), (0, 4, 9.0)), STAY)
    assert len(far.poses["frame"]) == len(away.poses["frame"]) == 0
    assert summary([compare(*far)])["lost"] == 1.0


def test_one_person_and_one_number_belong_together_however_far_off() -> None:
    truth, poses = truth_of([[0.0]] * 2), poses_of((0, 0, 9.0), (1, 0, 9.0))
    del truth["person"], truth["frame"], poses["person"]
    (one,) = each_of(poses, truth)
    assert one.truth is truth
    assert len(one.poses["frame"]) == 2
