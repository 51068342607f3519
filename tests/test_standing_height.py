"""The standing height, held against people who squat, raise their arms and come nearer (T20)."""

import numpy as np
import pytest

from viewer.stick.standing_height import standing_of, standing_rows


def drawn(tall: int, arms_up: bool = False) -> np.ndarray:
    """A trunk of some height on row 110, with arms beside the head or not."""
    mask = np.zeros((120, 160), np.bool_)
    mask[110 - tall : 110, 74:86] = True
    if arms_up:
        mask[max(0, 90 - tall) : 110 - tall // 2, 66:70] = True
        mask[max(0, 90 - tall) : 110 - tall // 2, 90:94] = True
    return mask


def test_raised_arms_are_no_height() -> None:
    assert standing_rows(drawn(80, arms_up=True)) == standing_rows(drawn(80)) == (30.0, 110.0)


def test_two_legs_without_what_joins_them_have_a_height() -> None:
    """An hour of film had such a silhouette: the median of its columns lies where nothing is."""
    mask = np.zeros((120, 160), np.bool_)
    mask[50:90, 20:26] = mask[50:90, 60:66] = True
    assert standing_rows(mask) == (50.0, 90.0)


def test_a_squat_does_not_shrink_the_scale() -> None:
    """T20: the height of standing frames holds for the squats between them."""
    rows = [standing_rows(drawn(tall)) for tall in (80, 80, 79, 60, 50, 60, 80, 81)]
    found = standing_of(rows, [True] * 8)
    assert found is not None
    assert (found.tall_px, found.at(110.0)) == pytest.approx((80.0, 80.0), abs=1.0)


def test_who_comes_nearer_grows_with_their_feet() -> None:
    soles = np.linspace(60.0, 110.0, 30)
    true = 0.6 * (soles - 10.0)
    crowns = soles - true
    crowns[::6] += 15.0  # bows
    found = standing_of(list(zip(crowns, soles, strict=True)), [True] * 30)
    assert found is not None
    assert [found.at(sole) for sole in soles] == pytest.approx(true.tolist(), rel=0.03)
    assert (found.sole_row, found.tall_px) == pytest.approx((85.0, 45.0), rel=0.03)


def test_who_is_partly_outside_tells_no_height() -> None:
    found = standing_of([(30.0, 110.0), (0.0, 60.0), (30.0, 110.0)], [True, False, True])
    assert found is not None
    assert [found.at(sole) for sole in (110.0, 60.0)] == pytest.approx([80.0, 80.0])


def test_nobody_has_no_height() -> None:
    assert standing_of([], []) is None


@pytest.mark.filterwarnings("error")
def test_a_few_frames_of_which_one_is_odd_still_have_a_height() -> None:
    rows = [(20.0, 110.0)] * 3 + [(50.0, 51.0)] + [(20.0, 110.0)] * 2
    found = standing_of(rows, [True] * 6)
    assert found is not None
    assert all(np.isfinite(found))
    assert min(found.at(110.0), found.at(51.0)) > 0.0


def test_heights_by_hand() -> None:
    """Four heights on one row: three quarters are at most 80.5, a tenth at most 71; soles that
    move by less than 0.15 of the height tell no slope."""
    rows = [(30.0, 110.0), (31.0, 110.0), (28.0, 110.0), (43.0, 110.0)]
    found = standing_of(rows, [True] * 4)
    assert found is not None
    assert found == pytest.approx((110.0, 80.5, 80.5, 0.0, 70.6))
    near = [(30.0 + 0.1 * n, 104.0 + 0.9 * n) for n in range(12)]
    found = standing_of(near, [True] * 12)
    assert found is not None
    assert found.slope == 0.0
    nearer = [(30.0 + 0.1 * n, 104.0 + 1.6 * n) for n in range(12)]
    found = standing_of(nearer, [True] * 12)
    assert found is not None
    assert found.slope == pytest.approx(1.5 / 1.6)


def test_where_all_are_cut_all_count() -> None:
    found = standing_of([(0.0, 60.0), (2.0, 64.0)], [False, False])
    assert found is not None
    assert found.sole_row == 62.0
    assert found.tall_px == pytest.approx(61.5)


def test_the_head_is_looked_for_near_the_median_column() -> None:
    """A twentieth of 100 rows to either side of column 50: an arm at 56 is none, at 55 it is."""
    mask = np.zeros((120, 160), np.bool_)
    mask[15:110, 40:61] = True
    mask[10, 56] = True
    assert standing_rows(mask) == (15.0, 110.0)
    mask[10, 55] = True
    assert standing_rows(mask) == (10.0, 110.0)
