"""A run as a table of comma-separated values: a row per row of its poses."""

import csv
import io
from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from common.body.body import ANGLE_NAMES, JOINT_NAMES
from common.body.extremities import EXTREMITY_NAMES
from common.npz_file import Arrays


def csv_text(poses: Arrays) -> str:
    """The table, with a head; metres, degrees, and empty cells where nothing is known.

    Args:
        poses: A run's arrays by name, with or without extremities.
    """
    text = io.StringIO()
    further = EXTREMITY_NAMES if "extremities_m" in poses else ()
    cameras = [str(name) for name in poses["camera_names"]]
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(
        [
            *("frame", "person", "time_s", "status"),
            *(f"seen_{camera}" for camera in cameras),
            *(f"score_{camera}" for camera in cameras),
            *(f"{joint}_{axis}_m" for joint in JOINT_NAMES for axis in "xyz"),
            *(f"{angle}_deg" for angle in ANGLE_NAMES),
            *(f"{joint}_confidence" for joint in JOINT_NAMES),
            *(f"{place}_{axis}_m" for place in further for axis in "xyz"),
            *(f"{place}_confidence" for place in further),
        ]
    )
    writer.writerows(_rows(poses))
    return text.getvalue()


def _rows(poses: Arrays) -> Iterator[list[int | str]]:
    names = ["score", "joints_m", "angles_deg", "confidence"]
    names += [name for name in ("extremities_m", "extremities_confidence") if name in poses]
    for i, frame in enumerate(poses["frame"]):
        numbers = [poses[name][i] for name in names]
        yield [
            int(frame),
            int(poses["person"][i]),
            *_cells(poses["time_s"][i], 4),
            str(poses["status"][i]),
            *(int(seen) for seen in poses["seen"][i]),
            *(cell for part in numbers for cell in _cells(part, 4)),
        ]


def _cells(values: ArrayLike, digits: int) -> list[str]:
    """Numbers for a spreadsheet; an unknown one is an empty cell."""
    return [f"{value:.{digits}f}" if np.isfinite(value) else "" for value in np.ravel(values)]
