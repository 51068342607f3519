"""Two runs compared: `compare.html`, and their differences."""

from pathlib import Path
from typing import Any, Final

import numpy as np

from animator.report.compare_page import ComparePart, angle_pairs, compare_html, compare_part
from animator.report.comparison import Off, compared, paired
from common.atomic_file import replacing
from common.npz_file import Facts
from runtime.store.past_run import PastRun, PastRunError, open_run
from runtime.store.run_people import of_person, people_of
from runtime.store.runs import unwritable
from tritrack.reporting.run_angles import courses_of

COMPARED: Final = "compare.html"


def compare_runs(first: Path, second: Path) -> Facts:
    """Hold two runs against each other and write the page of it into the first one's folder.

    People of the same numbers are compared; a run of one person with the first person of another.

    Raises:
        PastRunError: When one is no run, or both are one, or they share no instant.
        RunError: When the page cannot be written.
    """
    if first.resolve() == second.resolve():
        raise PastRunError(f"{first} and {second} are one run: name two")
    runs = open_run(first), open_run(second)
    numbers = _numbers(*runs)
    parts = [_part(runs, pair, titled=len(numbers) > 1) for pair in numbers]
    if not any(part.told.both for part in parts):
        raise PastRunError(
            f"{first} and {second} have a pose at no same time: name runs of one clip"
        )
    names = _names(*runs)
    facts = [_line(part) for part in parts]
    try:
        with replacing(first / COMPARED) as new:
            new.write_bytes(compare_html(*names, parts, facts).encode(errors="replace"))
    except OSError as error:
        raise unwritable(first, error) from error
    return {
        "file": str(first / COMPARED),
        "people": [_facts(part) for part in parts],
        "lines": facts,
    }


def _numbers(first: PastRun, second: PastRun) -> list[tuple[int, int]]:
    """The people to compare: of both runs, by number."""
    one, other = people_of(first.poses), people_of(second.poses)
    shared = [(number, number) for number in one if number in other]
    return shared or [(one[0], other[0])]


def _names(first: PastRun, second: PastRun) -> tuple[str, str]:
    """Folder names, with their parents where they are alike."""
    one, other = first.folder.resolve(), second.folder.resolve()
    if one.name != other.name:
        return one.name, other.name
    return f"{one.parent.name}/{one.name}", f"{other.parent.name}/{other.name}"


def _part(runs: tuple[PastRun, PastRun], numbers: tuple[int, int], titled: bool) -> ComparePart:
    first, second = (
        of_person(run, number).poses for run, number in zip(runs, numbers, strict=True)
    )
    rows, courses = paired(first, second), (courses_of(first), courses_of(second))
    told = compared(first, second, angle_pairs(*courses, rows), rows)
    off_m = second["joints_m"][rows.second] - first["joints_m"][rows.first]
    apart_mm = 1e3 * np.linalg.norm(off_m, axis=2).mean(axis=1)
    title = f"Person {numbers[0]}" if titled else ""
    return compare_part(title, courses, told, rows, apart_mm)


def _line(part: ComparePart) -> str:
    told, title = part.told, f"{part.title}: " if part.title else ""
    if not told.both:
        return f"{title}no frame in which both have a pose"
    joints, angles = (
        [each.median for each in offs if each.frames] for offs in (told.joints, told.angles)
    )
    middle = f"joints {np.mean(joints):.0f} mm and angles {np.mean(angles):.1f} degrees apart"
    line = f"{middle} in the median, in {told.both} frames in which both have a pose"
    alone = f"; {told.one_alone} in which one alone has" if told.one_alone else ""
    where = f"; they part in {len(told.parts)} stretches" if told.parts else ""
    return f"{title}{line}{alone}{where}"


def _facts(part: ComparePart) -> dict[str, Any]:
    told = part.told
    return {
        "both": told.both,
        "one_alone": told.one_alone,
        "angles_deg": {off.name: _off(off) for off in told.angles},
        "joints_mm": {off.name: _off(off) for off in told.joints},
        "joints_beside_hips_mm": {off.name: _off(off) for off in told.joints_beside_hips},
        "parts": [
            {"from_s": round(one.from_s, 3), "until_s": round(one.until_s, 3), "why": one.why}
            for one in told.parts
        ],
    }


def _off(off: Off) -> Facts:
    numbers = {"mean": off.mean, "median": off.median, "p95": off.p95}
    return {**{name: round(value, 2) for name, value in numbers.items()}, "frames": off.frames}
