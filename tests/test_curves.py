"""Curves for a page: round ticks, gaps that stay gaps, and no extreme lost in a long one."""

import re

import numpy as np
import pytest

from animator.report.curves import HIGH, MOST_POINTS, WIDE, Curve, chart, stretches, thinned, ticks


@pytest.mark.parametrize(
    ("span", "texts"),
    [
        ((0.0, 4.5), ["0", "2", "4"]),
        ((-13.0, 52.0), ["0", "20", "40"]),
        ((0.0, 100.0), ["0", "50", "100"]),
        ((0.0, 0.1), ["0", "0.05", "0.1"]),
    ],
)
def test_ticks_are_round_numbers_at_their_places(
    span: tuple[float, float], texts: list[str]
) -> None:
    found = ticks(*span)
    assert [tick.text for tick in found] == texts
    for tick in found:
        assert tick.at == pytest.approx(100 * (float(tick.text) - span[0]) / (span[1] - span[0]))


def test_a_gap_in_what_is_known_is_a_gap_in_the_curve() -> None:
    """By hand: two stretches, the second of one point, at a quarter and at the end of the frame."""
    y = np.array([0.0, 10.0, np.nan, 20.0])
    drawn = str(chart("knee", "deg", [Curve(np.arange(4.0), y, "left")], (0.0, 3.0), 1.0).drawing)
    line = re.search(r'class="line left" d="([^"]+)"', drawn)
    assert line is not None
    first, second = line[1].split("M")[1:]
    assert first.startswith("0.0 ")
    assert [point.split()[0] for point in first.split("L")] == ["0.0", f"{WIDE / 3:.1f}"]
    assert second.startswith(f"{WIDE:.1f} ")
    assert "nan" not in drawn


def test_more_is_higher_and_a_band_lies_on_both_sides() -> None:
    flat = Curve(np.arange(3.0), np.array([0.0, 5.0, 10.0]), "right", (np.full(3, 2.0),))
    drawn = str(chart("hip", "deg", [flat], (0.0, 2.0), 1.0).drawing)
    line, band = (
        [tuple(map(float, point.split())) for point in found.split("L")]
        for found in re.findall(r'd="M([\d. L-]+)Z?"/>', drawn)[-1:-3:-1]
    )
    assert line[0][1] > line[1][1] > line[2][1], "down the picture is less"
    upper, lower = band[:3], band[:2:-1]
    for (x, y), (_, above), (_, below) in zip(line, upper, lower, strict=True):
        assert 0.0 <= x <= WIDE
        assert above <= y <= below <= HIGH + 1.0
    assert upper[1][1] - line[1][1] == pytest.approx(line[1][1] - lower[1][1], abs=0.02)


def test_the_narrower_band_is_within_the_frame() -> None:
    y = np.array([0.0, 10.0])
    wide = Curve(np.arange(2.0), y, "left", (np.full(2, 90.0), np.full(2, 30.0)))
    drawn = chart("hip", "deg", [wide], (0.0, 1.0), 1.0)
    assert {"-20", "0", "20", "40"} <= {tick.text for tick in drawn.up}


def test_of_a_long_curve_the_extremes_stay() -> None:
    y = np.zeros(100_000)
    y[77_777], y[33_333] = 9.0, -5.0
    y[50_000:50_100] = np.nan
    kept = thinned(y)
    assert len(kept) <= 2 * MOST_POINTS
    assert {0, 33_333, 77_777, 99_999} <= {*kept.tolist()}
    assert np.isnan(y[kept]).any(), "the gap is still there"
    assert (np.diff(kept) > 0).all()


def test_stretches_are_from_a_first_to_beyond_a_last() -> None:
    assert stretches(np.array([True, True, False, True])) == [(0, 2), (3, 4)]
    assert stretches(np.zeros(3, bool)) == []
