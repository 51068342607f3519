"""The page of two runs: their angles laid over each other, their differences, where they part."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from animator.report.comparison import Comparison, Paired, apart_deg
from animator.report.curves import Chart, Curve, chart
from animator.report.report_page import LEAST_DEG, AngleCourse, css, is_known
from animator.scene import LEFT, RIGHT
from common.body.body import Vector
from common.templates import rendered


class ComparePart(NamedTuple):
    """What the page shows of one pair of people."""

    title: str
    told: Comparison
    charts: list[Chart]
    apart: Chart


def compare_html(first: str, second: str, parts: Sequence[ComparePart], facts: list[str]) -> str:
    """The page: one file that loads nothing from elsewhere.

    Args:
        first: Name of the first run.
        second: Name of the second run.
        parts: Each pair of people.
        facts: Lines of the head.
    """
    given = {"first": first, "second": second, "parts": list(parts), "facts": facts}
    return rendered(__package__, "compare.html", {**given, "left": css(LEFT), "right": css(RIGHT)})


def compare_part(
    title: str,
    courses: tuple[Sequence[AngleCourse], Sequence[AngleCourse]],
    told: Comparison,
    rows: Paired,
    apart_mm: Vector,
) -> ComparePart:
    """One pair of people.

    Args:
        title: Heading, where there are several.
        courses: Angles of the first and of the second run.
        told: Their differences.
        rows: Their paired rows.
        apart_mm: (k,) mean distance of the joints in these.
    """
    time_s = rows.time_s
    first_s, last_s = (float(time_s[0]), float(time_s[-1])) if len(time_s) else (0.0, 0.0)
    span_s = (first_s, max(last_s, first_s + 0.1))
    known = (both for both in zip(*courses, strict=True) if any(map(is_known, both)))
    charts = [_laid_over(*both, rows, span_s) for both in known]
    apart = chart("joints apart", "mm", [Curve(time_s, apart_mm, "trunk")], span_s, 50.0)
    return ComparePart(title, told, charts, apart)


def angle_pairs(
    first: Sequence[AngleCourse], second: Sequence[AngleCourse], rows: Paired
) -> dict[str, tuple[Vector, Vector]]:
    """Angles of two runs in their paired rows, by name and side."""
    return {
        course.name if side == "trunk" else f"{course.name}_{side[0]}": (
            values[rows.first],
            other.values_deg[side][rows.second],
        )
        for course, other in zip(first, second, strict=True)
        for side, values in course.values_deg.items()
    }


def _laid_over(
    first: AngleCourse, second: AngleCourse, rows: Paired, span_s: tuple[float, float]
) -> Chart:
    curves = []
    for side, values in first.values_deg.items():
        one, other = values[rows.first], second.values_deg[side][rows.second]
        curves.append(Curve(rows.time_s, one, side))
        curves.append(Curve(rows.time_s, one + apart_deg(one, other), f"{side} dashed"))
        alone = np.where(np.isfinite(one), np.nan, other)
        curves.append(Curve(rows.time_s, alone, f"{side} dashed"))
    return chart(first.title, "deg", curves, span_s, LEAST_DEG)
