"""Search by repeated division: the thesis's algorithms 1 (an angle) and 6 (a foreshortening)."""

from collections.abc import Callable
from typing import Final

from viewer.paper.tritree import Found

ANGLE_DIVISIONS: Final = 8
LEAST_STEP_DEG: Final = 1.0
RATIO_DIVISIONS: Final = 5
EDGE: Final = 1e-9
"""Tolerance with which sums of steps still reach the end of the range."""


def divided(
    score_at: Callable[[float], float],
    bounds: tuple[float, float],
    divisions: int,
    least: float,
) -> Found:
    """The best value in a range: first probed at equal steps; each later pass probes the interval
    of one step on either side of the winner.

    The best score is kept from pass to pass and starts at 0, so a range without any match gives its
    middle (T12).

    Args:
        score_at: Matching score of a value.
        bounds: Range of the search, both ends included (M20).
        divisions: Number of steps of a pass.
        least: Width at which to stop.

    Source: Demir 2006, algorithms 1 and 6, in floating point.
    """
    low, high = bounds
    width = high - low
    best, best_score, matches = (low + high) / 2, 0.0, 0
    while width > least:
        step = width / divisions
        begin, end = max(low, best - width / 2), min(high, best + width / 2)
        for k in range(divisions + 1):
            value = begin + k * step
            if value > end + EDGE:
                break
            score = score_at(value)
            matches += 1
            if score > best_score:
                best, best_score = value, score
        width *= 2 / divisions
    return Found(best, best_score, matches)


def angle_found(score_at: Callable[[float], float], limits_deg: tuple[float, float]) -> Found:
    """Algorithm 1: the turn of segments in the picture's plane, degrees (T12)."""
    return divided(score_at, limits_deg, ANGLE_DIVISIONS, LEAST_STEP_DEG)


def ratio_found(score_at: Callable[[float], float], length_px: float) -> Found:
    """Algorithm 6: the visible share of a segment's length, 0 to 1, to a pixel (T18, M19, M20)."""
    return divided(score_at, (0.0, 1.0), RATIO_DIVISIONS, 1.0 / length_px)
