"""A run as a file for other programs: BVH for Blender, a table for spreadsheets."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from common.atomic_file import replacing
from common.body.body import ANGLE_NAMES, JOINT_NAMES
from tritrack.store.past_run import PastRun, open_run

Format = Literal["bvh", "csv"]
OWN_NAMES: Final[dict[Format, str]] = {"bvh": "body.bvh", "csv": "poses.csv"}
"""The file in the run folder where no other is asked for."""


class ExportError(RuntimeError):
    """A run that cannot be exported: the text says why and what to do."""


def export_run(folder: Path, to: Format, out: Path | None) -> dict[str, Any]:
    """Write a run in another format.

    Args:
        folder: That of the run.
        to: Which format.
        out: The file to write; None: that of OWN_NAMES in the run folder.

    Returns:
        The file, its frames, and for BVH how far its joints are from the run's.

    Raises:
        PastRunError: When there is no such run.
        ExportError: When it has no poses, or the file cannot be written.
    """
    run = open_run(folder)
    path = out or folder / OWN_NAMES[to]
    text, facts = _bvh(run) if to == "bvh" else _csv(run)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as new:
            new.write_text(text, "utf-8")
    except OSError as error:
        reason = error.strerror or str(error)
        raise ExportError(
            f"cannot write {path}: {reason}; free some space or name another --out"
        ) from error
    return {"file": str(path), **facts}


def _bvh(run: PastRun) -> tuple[str, dict[str, Any]]:
    from animator.bones import joints_of
    from animator.bvh import NoMotion, bvh_text, steady

    joints_m, time_s = run.poses["joints_m"], run.poses["time_s"]
    try:
        skeleton, motion, step_s = steady(joints_m, time_s)
    except NoMotion as error:
        raise ExportError(
            f"{run.folder} cannot be animated: {error}; export another run"
        ) from error
    posed = np.flatnonzero(np.isfinite(joints_m).all(axis=(1, 2)))
    rows = np.rint((time_s[posed] - time_s[posed[0]]) / step_s).astype(np.int64)
    off_mm = 1e3 * np.linalg.norm(joints_of(skeleton, motion)[rows] - joints_m[posed], axis=2)
    return bvh_text(skeleton, motion, step_s), {
        "frames": len(motion.root_m),
        "first_frame": int(run.poses["frame"][posed[0]]),
        "filled": int(len(motion.root_m) - len(posed)),
        "off_mm": {
            "median": round(float(np.median(off_mm)), 2),
            "p95": round(float(np.percentile(off_mm, 95)), 2),
        },
    }


def _csv(run: PastRun) -> tuple[str, dict[str, Any]]:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(
        [
            *("frame", "time_s", "status", "views", "score_1", "score_2"),
            *(f"{joint}_{axis}_m" for joint in JOINT_NAMES for axis in "xyz"),
            *(f"{angle}_deg" for angle in ANGLE_NAMES),
            *(f"{joint}_confidence" for joint in JOINT_NAMES),
        ]
    )
    writer.writerows(_csv_rows(run.poses))
    return text.getvalue(), {"frames": len(run.poses["frame"])}


def _csv_rows(poses: dict[str, Any]) -> Iterator[list[Any]]:
    for i, frame in enumerate(poses["frame"]):
        numbers = [poses[name][i] for name in ("score", "joints_m", "angles_deg", "confidence")]
        yield [
            int(frame),
            *_cells(poses["time_s"][i], 4),
            str(poses["status"][i]),
            str(poses["views"][i]),
            *(cell for part in numbers for cell in _cells(part, 4)),
        ]


def _cells(values: Any, digits: int) -> list[str]:
    """Numbers as a spreadsheet takes them; one that is not known is an empty cell."""
    return [f"{value:.{digits}f}" if np.isfinite(value) else "" for value in np.ravel(values)]
