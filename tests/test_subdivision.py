"""Algorithms 1 and 6, held against what their printed steps must cost and miss (T12, T18)."""

from collections.abc import Callable

import numpy as np
import pytest

from viewer.stick.subdivision import angle_found, ratio_found

WAIST_DEG, HIP_DEG = (45.0, 135.0), (240.0, 300.0)


def peak_at(best: float) -> Callable[[float], float]:
    """A score with one peak, never 0."""
    return lambda value: 1.0 / (1.0 + abs(value - best))


@pytest.mark.parametrize(
    ("limits_deg", "evaluations"), [(WAIST_DEG, 36), (HIP_DEG, 27)], ids=["waist", "hip"]
)
def test_an_angle_costs_what_four_and_three_passes_of_nine_do(
    limits_deg: tuple[float, float], evaluations: int
) -> None:
    """T12: nine probes a pass; 90, 22.5, 5.6, 1.4 degrees for the waist, 60, 15, 3.75 for a hip."""
    middle = sum(limits_deg) / 2
    assert angle_found(peak_at(middle + 7.3), limits_deg).matches == evaluations
    costs = [
        angle_found(peak_at(best), limits_deg).matches
        for best in np.linspace(*limits_deg, 301).tolist()
    ]
    assert max(costs) == evaluations


def test_the_waist_is_found_within_a_tenth_of_a_degree() -> None:
    """T12: the last pass steps by 0.18 degrees."""
    for best in np.linspace(*WAIST_DEG, 1001).tolist():
        assert abs(angle_found(peak_at(best), WAIST_DEG).angle_deg - best) <= 0.09


def test_a_hip_is_found_within_half_its_last_step() -> None:
    """T12: 60 / 8 / 4 / 4 degrees."""
    for best in np.linspace(*HIP_DEG, 1001).tolist():
        assert abs(angle_found(peak_at(best), HIP_DEG).angle_deg - best) <= 60 / 8 / 16 / 2 + 1e-9


def test_an_angle_without_any_match_is_the_middle() -> None:
    """T12: the best similarity starts at 0 and must be surpassed."""
    assert angle_found(lambda _: 0.0, WAIST_DEG) == (90.0, 0.0, 36)


def test_a_limb_in_the_plane_has_a_ratio_of_one() -> None:
    """M20: with `<` the ratio 1 is never tried, and 30 px would be 9 degrees out of the plane."""
    assert ratio_found(lambda ratio: ratio, 30.0).angle_deg == pytest.approx(1.0)


def test_a_ratio_is_found_within_a_hundredth_of_30_pixels() -> None:
    """T18: four passes of six probes, two of which fall together at times."""
    found = [ratio_found(peak_at(best), 30.0) for best in np.linspace(0.0, 1.0, 1001).tolist()]
    off = [abs(f.angle_deg - best) for f, best in zip(found, np.linspace(0, 1, 1001), strict=True)]
    assert max(off) <= 0.01
    assert max(f.matches for f in found) <= 24
    assert 22 <= np.median([f.matches for f in found]) <= 24


def test_a_longer_limb_is_measured_finer() -> None:
    """T18: it stops at a pixel."""
    short, long = (ratio_found(peak_at(0.613), length) for length in (8.0, 80.0))
    assert short.matches < long.matches
    assert abs(long.angle_deg - 0.613) <= 1 / 80


@pytest.mark.parametrize("best", [0.0, 80.0])
def test_a_search_at_the_end_of_a_range_does_not_go_beyond_half_a_width(best: float) -> None:
    """T12: nine probes, then five of every pass: 80, 20, 5 and 1.25 degrees, half of each."""
    asked: list[float] = []

    def score(value: float) -> float:
        asked.append(value)
        return peak_at(best)(value)

    found = angle_found(score, (0.0, 80.0))
    assert (found.angle_deg, found.matches) == (best, 9 + 3 * 5)
    assert (min(asked), max(asked)) == (0.0, 80.0)
    assert max(abs(value - best) for value in asked[9:14]) == 10.0
