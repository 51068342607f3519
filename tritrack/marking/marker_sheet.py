"""Line markers on the marking page: what to click, and the result."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from animator.marking.sheet import Kind, Mark, Number, Plan, Seen, Sheet, Size, Solved
from calibration.paper.markers import Aim, Markers, MarkerView, fitted_lines, line_markers
from common.body.observation import Pixel
from common.bus.messages import place_in_rig
from common.rig.rig_file import CalibrationError
from tritrack.marking.marking_method import MarkingMethod, toml_number, toml_pixels
from tritrack.marking.suspect_point import suspect_point

HINTS: Final = {
    "floor": (
        "z axis on the floor: up and down the picture",
        "x axis on the floor: up and down the picture",
    ),
    "wall": (
        "x axis on the wall behind: across the picture",
        "z axis on the wall behind: across the picture",
    ),
}
KINDS: Final[tuple[Kind, ...]] = ("floor", "wall")
START: Final[tuple[Kind, ...]] = ("floor",) * 4 + ("wall",) * 4
"""Marks of a new sheet, four points per marker: with three an outlier cannot be identified."""
NOMINAL_M: Final = 4.0
"""Distance at which cameras are drawn from above, metres: markers do not determine it."""
DRAWN_DEG: Final = 40.0
"""Angle of view with which they are drawn."""


def marker_method(size: Size, before: Markers | None, views: Sequence[int]) -> MarkingMethod:
    """The method that aims cameras by line markers.

    Args:
        size: Size of the pictures.
        before: The content of the file of points.
        views: Numbers of the existing cameras.
    """
    numbers = tuple(
        Number(_key(n), f"focal length of camera {n}, by its data", "px", True) for n in views
    )
    empty = Sheet(tuple(Mark(kind) for kind in START), {each.key: None for each in numbers})
    return MarkingMethod(
        name="markers",
        numbers=numbers,
        hints=dict(HINTS),
        start=empty if before is None else sheet_of_markers(before, views),
        solve=lambda sheet: solve_markers(sheet, size, views),
        text=lambda sheet: markers_text(markers_of(sheet, size, views)),
        write=None,
        rows=lambda sheet: [
            line_markers(view, size) for view in markers_of(sheet, size, views).cameras
        ],
    )


def markers_of(sheet: Sheet, size: Size, views: Sequence[int]) -> Markers:
    """The markers on a sheet.

    Raises:
        CalibrationError: When a focal length is missing.
    """
    return Markers(*size, tuple(_view(sheet, number) for number in views))


def sheet_of_markers(measured: Markers, views: Sequence[int]) -> Sheet:
    """The sheet for a file's markers: its cameras by name, or in order."""
    named = {view.name: view for view in measured.cameras}
    ordered = dict(zip(views, measured.cameras, strict=False))
    own = {n: named.get(f"cam{n}", ordered.get(n)) for n in views}
    marks = []
    for kind in KINDS:
        lines = [getattr(own.get(n), f"{kind}_px", ()) for n in (1, 2)]
        for n in range(max(len(line) for line in lines)):
            one, other = (line[n] if n < len(line) else None for line in lines)
            marks.append(Mark(kind, (one, other)))
    return Sheet(tuple(marks), {_key(n): getattr(own[n], "focal_px", None) for n in views})


def solve_markers(sheet: Sheet, size: Size, views: Sequence[int]) -> Solved:
    """The aim of each camera, as far as the points determine it."""
    names = tuple(_name(n, sheet) for n in range(len(sheet.marks)))
    seen, aims = zip(*(_seen(sheet, number, size) for number in views), strict=True)
    worst = suspect_point(sheet, views, lambda other, number: _seen(other, number, size)[0])
    return Solved(
        seen,
        names,
        Plan(tuple(_place(n, aim) for n, aim in zip(views, aims, strict=True) if aim)),
        "" if worst is None else f"{names[worst[1]]} in camera {views[worst[0]]}",
        worst,
        whole=all(aims),
    )


def markers_text(measured: Markers) -> str:
    """The markers in the typed command's form (TOML), without remarks."""
    lines = [f"width = {measured.width}", f"height = {measured.height}"]
    for view in measured.cameras:
        lines += ["", "[[cameras]]", f'name = "{view.name}"']
        lines += [f"focal_px = {toml_number(view.focal_px)}"]
        lines += [f"floor_px = [{toml_pixels(view.floor_px)}]"]
        lines += [f"wall_px = [{toml_pixels(view.wall_px)}]"]
    return "\n".join([*lines, ""])


def _key(number: int) -> str:
    return f"focal_{number}_px"


def _view(sheet: Sheet, number: int) -> MarkerView:
    focal_px = sheet.numbers.get(_key(number))
    if focal_px is None:
        raise CalibrationError(
            f"say the focal length of camera {number}, in pixels of these pictures"
        )
    floor, wall = (_points(sheet, number, kind) for kind in ("floor", "wall"))
    return MarkerView(f"cam{number}", focal_px, floor, wall)


def _points(sheet: Sheet, number: int, kind: str) -> tuple[Pixel, ...]:
    points = [mark.px[place_in_rig(number)] for mark in sheet.marks if mark.kind == kind]
    return tuple(at for at in points if at is not None)


def _name(n: int, sheet: Sheet) -> str:
    kind = sheet.marks[n].kind
    return f"{kind} marker, point {sum(mark.kind == kind for mark in sheet.marks[: n + 1])}"


def _seen(sheet: Sheet, number: int, size: Size) -> tuple[Seen, Aim | None]:
    try:
        view = _view(sheet, number)
        aim = line_markers(view, size)
    except CalibrationError as error:
        return Seen(False, str(error)), None
    lines = dict(zip(("floor", "wall"), fitted_lines(view, size), strict=True))
    points = [mark.px[place_in_rig(number)] for mark in sheet.marks]
    feet, off_px = [], []
    for mark, at in zip(sheet.marks, points, strict=True):
        off = None if at is None else float(lines[mark.kind] @ (*at, 1.0))
        off_px.append(None if off is None else abs(off))
        foot = None if at is None or off is None else np.array(at) - off * lines[mark.kind][:2]
        feet.append(None if foot is None else (float(foot[0]), float(foot[1])))
    ends = [_ends(lines["floor"], size[1], 1), _ends(lines["wall"], size[0], 0)]
    drawn = tuple(each for each in ends if each is not None)
    return Seen(True, "", _facts(aim), tuple(off_px), tuple(feet), drawn), aim


def _ends(line: np.ndarray, far_px: int, along: int) -> tuple[Pixel, Pixel] | None:
    """Intersections of a line with both borders of the picture; None where it meets neither."""
    across = 1 - along
    if abs(line[across]) < 1e-9:
        return None
    ends = []
    for at_px in (0.0, float(far_px)):
        point = [at_px, at_px]
        point[across] = float(-(line[along] * at_px + line[2]) / line[across])
        ends.append((point[0], point[1]))
    return ends[0], ends[1]


def _facts(aim: Aim) -> tuple[tuple[str, str], ...]:
    return (
        ("yaw", f"{abs(aim.yaw_deg):.2f}° too far {'right' if aim.yaw_deg > 0 else 'left'}"),
        ("pitch", f"{abs(aim.pitch_deg):.2f}° too far {'up' if aim.pitch_deg > 0 else 'down'}"),
        ("roll", f"{abs(aim.roll_deg):.2f}° {'' if aim.roll_deg > 0 else 'counter'}clockwise"),
        ("markers off square", f"{aim.skew_deg:.2f}°"),
    )


def _place(number: int, aim: Aim) -> tuple[float, float, float, float]:
    place = (0.0, NOMINAL_M, -90.0) if number == 1 else (-NOMINAL_M, 0.0, 0.0)
    return (place[0], place[1], place[2] + aim.yaw_deg, DRAWN_DEG)
