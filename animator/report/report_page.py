"""The report page of a run: what was followed, when it was believed, its angles and cycles."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from animator.report.belief_stretches import Stretch, doubts, stretches_of
from animator.report.curves import Chart, Curve, chart
from animator.report.cycles import POINTS, Cycles, cycles_of, laid_over
from animator.scene import LEFT, RIGHT, Colour
from common.body.body import Vector
from common.npz_file import Arrays
from common.templates import rendered

LEAST_DEG: Final = 20.0
"""Smallest height of a chart of angles, degrees."""
MOST_DOUBTS: Final = 12
"""Largest number of doubted stretches in the list, the longest ones."""
SIDES: Final = ("left", "right")


class AngleCourse(NamedTuple):
    """One angle over a run, of one side or both."""

    title: str
    name: str
    """As in files, without its side."""
    values_deg: dict[str, Vector]
    """By left, right or trunk: (n,), NaN where it is not known."""
    bands_deg: dict[str, tuple[Vector, ...]]
    """Half widths of its error bands, by the same; the narrowest last."""


class Shot(NamedTuple):
    """A frame as a picture."""

    picture: str
    """A data URI."""
    caption: str


class PersonPart(NamedTuple):
    """What the page shows of one person."""

    title: str
    strip: list[Stretch]
    doubts: list[Stretch]
    charts: list[Chart]
    cycles: Cycles
    cycle_charts: list[Chart]
    shots: Sequence[Shot]


class ReportInput(NamedTuple):
    """What the page shows of the whole run."""

    name: str
    facts: list[tuple[str, str]]
    trust: list[str]
    warnings: list[str]
    video: str
    """File name of the overlay; "" where there is none."""
    plays: bool
    """Whether browsers play it."""
    command: str


def report_html(given: ReportInput, people: Sequence[PersonPart]) -> str:
    """The page: one file that loads nothing from elsewhere."""
    shown = {**given._asdict(), "people": list(people), "left": css(LEFT), "right": css(RIGHT)}
    return rendered(__package__, "report.html", shown)


def css(colour: Colour) -> str:
    """A colour for a style sheet."""
    return "#{:02x}{:02x}{:02x}".format(*colour)


def person_part(
    title: str, poses: Arrays, courses: Sequence[AngleCourse], shots: Sequence[Shot]
) -> PersonPart:
    """One person's part of the page.

    Args:
        title: Heading, where there are several.
        poses: The person's rows.
        courses: Their angles.
        shots: Their worst frames.
    """
    time_s, strip = np.asarray(poses["time_s"], float), stretches_of(poses)
    sides = [values for course in courses for values in course.values_deg.values()]
    cycles = cycles_of(np.stack(sides, axis=1), time_s)
    shown = [course for course in courses if is_known(course)]
    first_s, last_s = (float(time_s[0]), float(time_s[-1])) if len(time_s) else (0.0, 0.0)
    span_s = (first_s, max(last_s, first_s + 0.1))
    listed = sorted(doubts(strip), key=lambda one: one.from_s - one.until_s)[:MOST_DOUBTS]
    return PersonPart(
        title,
        strip,
        sorted(listed, key=lambda one: one.from_s),
        [_over_time(course, time_s, span_s) for course in shown],
        cycles,
        [_over_cycles(course, cycles, time_s) for course in shown] if cycles.spans else [],
        shots,
    )


def is_known(course: AngleCourse) -> bool:
    """Whether an angle is known in any row."""
    return any(np.isfinite(values).any() for values in course.values_deg.values())


def _over_time(course: AngleCourse, time_s: Vector, span_s: tuple[float, float]) -> Chart:
    curves = [
        Curve(time_s, values, look, course.bands_deg.get(look, ()))
        for look, values in course.values_deg.items()
    ]
    return chart(course.title, "deg", curves, span_s, LEAST_DEG)


def _over_cycles(course: AngleCourse, cycles: Cycles, time_s: Vector) -> Chart:
    """Each cycle as a thin line, their mean as a thick one."""
    share, curves = np.linspace(0.0, 100.0, POINTS), []
    for look, values in course.values_deg.items():
        laid = laid_over(values, cycles, time_s)
        curves += [Curve(share, own, f"{look} thin") for own in laid]
        curves.append(Curve(share, laid.mean(axis=0), look))
    return chart(course.title, "deg", curves, (0.0, 100.0), LEAST_DEG)
