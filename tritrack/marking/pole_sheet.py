"""Poles on the marking page: what to click, and the result."""

import math
import string
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import msgspec
import numpy as np

from animator.marking.sheet import Mark, Number, Plan, Seen, Sheet, Size, Solved
from calibration.paper.calibration import write_rig
from calibration.paper.drawn_poles import drawn_poles
from calibration.paper.poles import (
    CameraQuality,
    Pole,
    Poles,
    camera_by_poles,
    poles,
    refuse_other_units,
)
from common.body.body import Vector
from common.body.observation import Pixel
from common.bus.messages import place_in_rig
from common.rig.rig_file import CalibrationError
from tritrack.marking.marking_method import MarkingMethod, toml_number, toml_pixels
from tritrack.marking.suspect_point import suspect_point

NUMBERS: Final = (
    Number("pole_height_m", "height of the poles", "m", True),
    Number("distance_1_m", "origin to camera 1, by tape", "m", False),
    Number("distance_2_m", "origin to camera 2, by tape", "m", False),
)
TOP: Final = "the top of the pole"
START_M: Final = ((0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, -1.0), (1.0, 1.0))
"""Default positions: A, B and C of section 4.1, D_X = D_Z = 1 m, and two more."""
VIEWS: Final = (1, 2)


def pole_method(size: Size, before: Poles | None, out: Path) -> MarkingMethod:
    """The method that calibrates by poles.

    Args:
        size: Size of the pictures.
        before: The content of the file of points.
        out: The `calibration.json` to write.
    """
    return MarkingMethod(
        name="poles",
        numbers=NUMBERS,
        hints={"pole": (TOP, TOP)},
        start=_start() if before is None else sheet_of_poles(before),
        solve=lambda sheet: solve_poles(sheet, size),
        text=lambda sheet: poles_text(poles_of(sheet, size)),
        write=lambda sheet: write_rig(out, *poles(poles_of(sheet, size))),
        rows=lambda sheet: _rows(sheet, size),
    )


def poles_of(sheet: Sheet, size: Size) -> Poles:
    """The poles on a sheet.

    Raises:
        CalibrationError: When their height is missing, or a length is in another unit.
    """
    height_m = sheet.numbers.get("pole_height_m")
    if height_m is None:
        raise CalibrationError("say how tall the poles are, from the floor to the top")
    shown = [(mark.at_m or (0.0, 0.0), mark.px) for mark in sheet.marks]
    measured = Poles(
        *size,
        height_m,
        tuple(Pole(x_m, z_m, *px) for (x_m, z_m), px in shown),
        sheet.numbers.get("distance_1_m"),
        sheet.numbers.get("distance_2_m"),
    )
    refuse_other_units(measured)
    return measured


def sheet_of_poles(measured: Poles) -> Sheet:
    """The sheet for a file's poles."""
    marks = [
        Mark("pole", (pole.cam1_px, pole.cam2_px), (pole.x_m, pole.z_m)) for pole in measured.poles
    ]
    return Sheet(tuple(marks), {each.key: getattr(measured, each.key) for each in NUMBERS})


def solve_poles(sheet: Sheet, size: Size) -> Solved:
    """Each camera as far as the tops determine it, and the room from above."""
    names = tuple(_name(n, mark) for n, mark in enumerate(sheet.marks))
    seen, known = zip(*(_seen(sheet, number, size) for number in VIEWS), strict=True)
    worst = suspect_point(sheet, VIEWS, lambda other, number: _seen(other, number, size)[0])
    return Solved(
        seen,
        names,
        _plan(known, sheet, size),
        "" if worst is None else f"{names[worst[1]]} in camera {worst[0] + 1}",
        worst,
        whole=all(known),
    )


def poles_text(measured: Poles) -> str:
    """The poles in the typed command's form (TOML), without remarks."""
    lines = [f"width = {measured.width}", f"height = {measured.height}"]
    for number in NUMBERS:
        value = getattr(measured, number.key)
        lines += [] if value is None else [f"{number.key} = {toml_number(value)}"]
    for n, pole in enumerate(measured.poles):
        lines += ["", f"[[poles]]  # {_letter(n)}"]
        lines += [f"x_m = {toml_number(pole.x_m)}", f"z_m = {toml_number(pole.z_m)}"]
        for key in ("cam1_px", "cam2_px"):
            at = getattr(pole, key)
            lines += [] if at is None else [f"{key} = {toml_pixels([at])}"]
    return "\n".join([*lines, ""])


def _start() -> Sheet:
    return Sheet(
        tuple(Mark("pole", at_m=place) for place in START_M), {each.key: None for each in NUMBERS}
    )


def _rows(sheet: Sheet, size: Size) -> Sequence[msgspec.Struct]:
    return poles(poles_of(sheet, size))[1].cameras


def _letter(n: int) -> str:
    return string.ascii_uppercase[n] if n < 26 else str(n + 1)


def _name(n: int, mark: Mark) -> str:
    x_m, z_m = mark.at_m or (0.0, 0.0)
    return f"pole {_letter(n)} at x {x_m:g}, z {z_m:g} m"


def _seen(sheet: Sheet, number: int, size: Size) -> tuple[Seen, CameraQuality | None]:
    try:
        measured = poles_of(sheet, size)
        known = camera_by_poles(measured, number)
    except CalibrationError as error:
        return Seen(False, str(error)), None
    drawn = drawn_poles(measured, number, known)
    tops = [mark.px[place_in_rig(number)] for mark in sheet.marks]
    off_px = [
        None if top is None else float(np.hypot(*(np.array(top) - expected)))
        for top, expected in zip(tops, drawn[:, 0], strict=True)
    ]
    expected = tuple(_pixel(top) for top in drawn[:, 0])
    ends = zip((_pixel(foot) for foot in drawn[:, 1]), expected, strict=True)
    lines = tuple((foot, top) for foot, top in ends if foot and top)
    return Seen(True, "", _facts(known), tuple(off_px), expected, lines), known


def _pixel(at: Vector) -> Pixel | None:
    return (float(at[0]), float(at[1])) if np.isfinite(at).all() else None


def _facts(known: CameraQuality) -> tuple[tuple[str, str], ...]:
    return (
        ("focal length", f"{known.focal_px:.1f} ± {known.focal_sd_px:.1f} px"),
        ("distance", f"{known.distance_m:.3f} ± {known.distance_sd_m:.3f} m"),
        ("height", f"{known.height_m:.3f} m"),
        ("axis off centre", f"{known.off_centre_px:+.1f} px"),
        ("misfit", f"{known.misfit_px:.2f} px"),
    )


def _plan(known: Sequence[CameraQuality | None], sheet: Sheet, size: Size) -> Plan:
    cameras = []
    for n, camera in enumerate(known):
        if camera is not None:
            width_deg = 2 * math.degrees(math.atan(size[0] / 2 / camera.focal_px))
            place = (0.0, camera.distance_m, -90.0) if n == 0 else (-camera.distance_m, 0.0, 0.0)
            cameras.append((*place, width_deg))
    places = [(*(mark.at_m or (0.0, 0.0)), n) for n, mark in enumerate(sheet.marks)]
    return Plan(tuple(cameras), tuple(places))
