"""The kept calibrations: what each is of, and what its command said of it."""

import time
from pathlib import Path
from typing import Final

from animator.start.sections import Calibrations, ShownCalibration
from common.rig.rig_file import CalibrationError, load_rig
from tritrack.starting.job_plan import CALIBRATIONS, NAME, kept_calibration, kept_points

BOARD: Final = "board.pdf"
MOST_SHOWN: Final = 50


def calibration_names(runs: Path) -> list[str]:
    """Names of the kept calibrations, newest first."""
    found = [
        (-path.stat().st_mtime, path.stem)
        for path in (runs / CALIBRATIONS).glob("*.json")
        if NAME.fullmatch(path.stem) and path.is_file()
    ]
    return [name for _, name in sorted(found)]


def calibration_file(runs: Path, file: str) -> Path | None:
    """A kept file by its name, to download: a calibration, or the board; None: there is none."""
    name = file.removesuffix(".json")
    known = file == BOARD or (file.endswith(".json") and NAME.fullmatch(name) is not None)
    path = runs / CALIBRATIONS / file
    return path if known and path.is_file() and not path.is_symlink() else None


def shown_calibrations(runs: Path) -> Calibrations:
    """In the form for browsers."""
    shown = []
    for name in calibration_names(runs)[:MOST_SHOWN]:
        path = kept_calibration(runs, name)
        when = time.strftime("%Y-%m-%d %H:%M", time.localtime(path.stat().st_mtime))
        try:
            cameras, fault = len(load_rig(path).cameras), ""
        except CalibrationError as error:
            cameras, fault = 0, str(error)
        report = path.with_suffix(".txt")
        told = fault or (report.read_text(errors="replace") if report.is_file() else "")
        shown.append(ShownCalibration(name, when, cameras, told, f"calibration/{name}.json"))
    board = f"calibration/{BOARD}" if calibration_file(runs, BOARD) else ""
    return Calibrations(shown, board)


def remove_calibration(runs: Path, name: str) -> bool:
    """Delete a calibration and what was said of it; False where there is none."""
    if name not in calibration_names(runs):
        return False
    path = kept_calibration(runs, name)
    path.unlink()
    path.with_suffix(".txt").unlink(missing_ok=True)
    kept_points(runs, name).unlink(missing_ok=True)
    return True
