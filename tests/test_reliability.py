"""What confidence is worth, held against counts by hand and the laws of the ROC curve."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tritrack.accuracy.reliability import auc, gap, reliability, roc

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
