"""Joints and extremities on disk: one behind the other, and apart again when they are read."""

import numpy as np

from common.body.body import JOINT_NAMES
from common.body.extremities import ALL_JOINT_NAMES
from runtime.store.joint_arrays import all_joints_m, on_disk, parted

N = 4


def arrays() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    return {
        "joints_m": rng.random((N, 15, 3)),
        "joints_px": rng.random((N, 2, 15, 2)),
        "confidence": rng.random((N, 15)),
        "joint_names": np.array(JOINT_NAMES),
        "extremities_m": rng.random((N, 7, 3)),
        "extremities_px": rng.random((N, 2, 7, 2)),
        "extremities_confidence": rng.random((N, 7)),
        "score": rng.random((N, 2)),
    }


def test_the_15_joints_stay_first_on_disk_and_the_rest_follows() -> None:
    told = arrays()
    held = on_disk(told)
    assert held["joint_names"].tolist() == list(ALL_JOINT_NAMES)
    assert (held["joints_m"][:, :15] == told["joints_m"]).all()
    assert (held["joints_m"][:, 15:] == told["extremities_m"]).all()
    assert held["joints_px"].shape == (N, 2, 22, 2)
    assert held["confidence"].shape == (N, 22)
    assert set(held) == {"joints_m", "joints_px", "confidence", "joint_names", "score"}


def test_what_was_written_is_read_as_it_was_told() -> None:
    told = arrays()
    again = parted(on_disk(told))
    assert set(again) == set(told)
    for name, array in told.items():
        assert (again[name] == array).all()
    assert (all_joints_m(again) == on_disk(told)["joints_m"]).all()


def test_a_run_without_extremities_is_left_as_it_is() -> None:
    old = {name: each for name, each in arrays().items() if not name.startswith("extremities")}
    assert on_disk(old).keys() == old.keys()
    assert parted(old) is old
    assert (all_joints_m(old) == old["joints_m"]).all()


def test_arrays_that_do_not_fit_their_names_are_left_to_be_refused() -> None:
    damaged = on_disk(arrays()) | {"confidence": np.zeros(3)}
    assert parted(damaged) is damaged
