"""Two runs held against each other: differences by hand, and the stretches in which they part."""

import numpy as np
import pytest

from animator.report.comparison import apart_deg, compared, paired
from common.npz_file import Arrays


def run(n: int = 30, rate_hz: float = 10.0) -> Arrays:
    joints_m = np.random.default_rng(5).normal(0, 0.4, (1, 15, 3)).repeat(n, axis=0)
    return {"time_s": np.arange(n) / rate_hz, "joints_m": joints_m}


def test_a_run_beside_another_is_off_by_that_and_not_beside_the_hips() -> None:
    one, other = run(), run()
    other["joints_m"] = other["joints_m"] + [0.03, 0.0, 0.04]
    told = compared(one, other, {}, paired(one, other))
    assert [off.median for off in told.joints] == pytest.approx([50.0] * 15)
    assert [off.p95 for off in told.joints_beside_hips] == pytest.approx([0.0] * 15, abs=1e-9)
    assert (told.both, told.one_alone, told.parts) == (30, 0, [])


def test_angles_differ_the_shorter_way_round_second_minus_first() -> None:
    assert apart_deg(np.array([179.0, -10.0]), np.array([-179.0, 10.0])).tolist() == [2.0, 20.0]
    one = run()
    angles = {"knee_angle_r": (np.full(30, 179.0), np.full(30, -176.0))}
    (off,) = compared(one, one, angles, paired(one, one)).angles
    assert (off.mean, off.median, off.frames) == (5.0, 5.0, 30)


def test_runs_part_where_joints_are_far_apart_or_one_has_no_pose() -> None:
    one, other = run(), run()
    other["joints_m"][5:9] += [0.2, 0.0, 0.0]
    other["joints_m"][20:25] = np.nan
    told = compared(one, other, {}, paired(one, other))
    assert [(part.first, part.last) for part in told.parts] == [(5, 8), (20, 24)]
    assert (told.parts[0].from_s, told.parts[0].until_s) == pytest.approx((0.5, 0.9))
    assert "200 mm" in told.parts[0].why
    assert "alone" in told.parts[1].why
    assert (told.both, told.one_alone) == (25, 5)


def test_runs_of_two_rates_meet_where_their_times_do() -> None:
    """At 10 and at 30 a second, by hand: every row of the slower with every third."""
    rows = paired(run(10, 10.0), run(30, 30.0))
    assert rows.first.tolist() == list(range(10))
    assert rows.second.tolist() == list(range(0, 30, 3))
    later = run(10, 10.0)
    later["time_s"] = later["time_s"] + 0.5
    assert paired(run(10, 10.0), later).first.tolist() == [5, 6, 7, 8, 9]
    assert paired(run(10, 10.0), later).second.tolist() == [0, 1, 2, 3, 4]
    assert len(paired(run(10), run(0)).first) == 0
