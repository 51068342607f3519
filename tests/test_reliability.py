"""What confidence is worth, held against counts by hand and the laws of the ROC curve."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lab.accuracy.accuracy import JOINTS, Compared
from lab.accuracy.reliability import auc, gap, reliability, roc, trust

said_and_came = st.lists(
    st.tuples(st.integers(0, 20).map(lambda n: n / 20), st.booleans()), min_size=1, max_size=60
).map(lambda pairs: (np.array([p[0] for p in pairs]), np.array([p[1] for p in pairs])))


def test_five_joints_counted_by_hand() -> None:
    """Of 3 near and 2 far ones, 6 pairs: 4 in order, 1 tied, 1 reversed."""
    sure = np.array([0.9, 0.6, 0.3, 0.6, 0.1])
    near = np.array([True, True, True, False, False])
    assert auc(sure, near) == pytest.approx(4.5 / 6)


def test_bins_counted_by_hand() -> None:
    """0.25 and 0.29 share a bin, 1.0 falls into the last; one promise of four is not kept."""
    bins = reliability(np.array([0.25, 0.29, 1.0, 0.95]), np.array([True, False, True, True]))
    assert [one["count"] for one in bins] == [0, 0, 2, 0, 0, 0, 0, 0, 0, 2]
    assert (bins[2]["confidence"], bins[2]["near"]) == pytest.approx((0.27, 0.5))
    assert (bins[9]["confidence"], bins[9]["near"]) == pytest.approx((0.975, 1.0))
    assert gap(bins, 4) == pytest.approx(0.23)


def test_a_bin_of_few_says_nothing() -> None:
    sure, near = np.full(1000, 0.95), np.ones(1000, np.bool_)
    sure[0] = 0.05
    assert gap(reliability(sure, near), 1000) == pytest.approx(0.05)


def test_a_confidence_that_keeps_its_promise_has_no_gap() -> None:
    chance = np.random.default_rng(1)
    sure = chance.random(200_000)
    near = chance.random(200_000) < sure
    assert gap(reliability(sure, near), 200_000) < 0.02
    assert auc(sure, near) == pytest.approx(5 / 6, abs=0.005)  # of a uniform, by integration


def test_a_constant_is_worth_nothing_and_no_miss_leaves_nothing_to_tell() -> None:
    assert auc(np.full(7, 0.8), np.arange(7) < 3) == 0.5
    assert np.isnan(auc(np.full(7, 0.8), np.ones(7, np.bool_)))
    assert np.isnan(auc(np.empty(0), np.empty(0, np.bool_)))


@given(said_and_came)
def test_the_area_is_that_beneath_the_curve(given_: tuple[np.ndarray, np.ndarray]) -> None:
    sure, near = given_
    far, found = roc(sure, near)
    assert (np.diff(far) >= 0).all()
    assert (np.diff(found) >= 0).all()
    if 0 < near.sum() < near.size:
        assert auc(sure, near) == pytest.approx(float(np.trapezoid(found, far)))


@given(said_and_came)
def test_only_the_order_counts_and_the_reverse_order_has_the_rest(
    given_: tuple[np.ndarray, np.ndarray],
) -> None:
    sure, near = given_
    area = auc(sure, near)
    assert auc(sure**3 / 2, near) == pytest.approx(area, nan_ok=True)
    assert auc(1 - sure, near) == pytest.approx(1 - area, nan_ok=True)


@given(said_and_came)
def test_every_joint_is_in_one_bin(given_: tuple[np.ndarray, np.ndarray]) -> None:
    bins = reliability(*given_)
    assert sum(one["count"] for one in bins) == given_[0].size
    kept = sum(one["count"] * one["near"] for one in bins if one["count"])
    assert kept == pytest.approx(given_[1].sum())


def compared(off_mm: list[list[float]], confidence: list[list[float]]) -> Compared:
    n, joints = len(off_mm), len(JOINTS)
    true_m, off_m = np.zeros((n, joints, 3)), np.zeros((n, joints, 3))
    off_m[:, :, 1] = 900.0
    off_m[:, : len(off_mm[0]), 1] = 1e-3 * np.array(off_mm)
    sure = np.full((n, joints), 0.05)
    sure[:, : len(confidence[0])] = confidence
    return Compared(np.arange(n), np.arange(n), off_m, true_m, sure, n, 0, 0)


def test_trust_is_in_joints_nearer_than_five_centimetres_of_all_clips() -> None:
    """Of three frames the first two joints count by hand; the other ten are far and unsure."""
    clips = [
        compared([[49.0, 51.0], [10.0, 70.0]], [[0.95, 0.15], [0.65, 0.75]]),
        compared([[60.0, 20.0]], [[0.75, 0.85]]),
    ]
    told = trust(clips)
    assert told["near_mm"] == 50.0
    assert told["near"] == pytest.approx(3 / 36)
    assert told["auc"][JOINTS[0]] == pytest.approx(1 / 2)
    assert told["auc"][JOINTS[1]] == pytest.approx(1.0)
    assert np.isnan(told["auc"][JOINTS[2]])
    assert told["auc"]["all"] == pytest.approx((33 + 33 + 31) / (3 * 33))
    counts = {i: one["count"] for i, one in enumerate(told["bins"]) if one["count"]}
    assert counts == {0: 30, 1: 1, 6: 1, 7: 2, 8: 1, 9: 1}
    assert told["gap"] == pytest.approx(0.75)
    for i, one in enumerate(told["bins"]):
        assert (one["from"], one["to"]) == pytest.approx((i / 10, (i + 1) / 10))


def test_the_curve_of_joints_that_are_all_near_or_all_far_is_an_edge() -> None:
    sure = np.array([0.9, 0.2])
    far, found = roc(sure, np.array([True, True]))
    assert (far.tolist(), found.tolist()) == ([0, 0, 0], [0, 0.5, 1])
    far, found = roc(sure, np.array([False, False]))
    assert (far.tolist(), found.tolist()) == ([0, 0.5, 1], [0, 0, 0])
