"""A run's clinical angles with their bands, and as a table for spreadsheets."""

import csv
import io
import math
from typing import Final, NamedTuple

import numpy as np

from animator.clinical.clinical_angles import NAMES, clinical_angles, continuous, defined
from animator.clinical.error_bands import angle_bands_deg, joint_bands_mm, spreads_m
from common.body.body import JOINT_NAMES, Floats
from common.body.extremities import ALL_JOINT_NAMES, EXTREMITY_NAMES
from common.npz_file import Arrays

SHARES: Final = ("68", "95")
"""The bands, percent."""
_FEET: Final = [
    [ALL_JOINT_NAMES.index(f"{side}_{part}") for part in ("heel", "toe")] for side in "rl"
]


class ClinicalRun(NamedTuple):
    """The clinical angles of a run's rows."""

    angles_deg: Floats
    """(n, len(NAMES)), NaN where one is not defined."""
    bands_deg: Floats
    """(n, len(NAMES), 2) half widths of the bands that hold with 68 and with 95 %."""
    bands_mm: Floats
    """(n, 15, 2) the same of the joints."""


def clinical_run(poses: Arrays) -> ClinicalRun:
    """The clinical angles of a run.

    Args:
        poses: As `open_run` gives them: joints and extremities apart; a run from before there were
            extremities has no ankle angles.
    """
    joints_m, confidence = _all_joints(poses)
    angles_deg = clinical_angles(joints_m)
    feet_seen = np.stack([(confidence[:, feet] > 0).all(axis=1) for feet in _FEET], axis=1)
    known = defined(angles_deg, feet_seen)
    spread_m = spreads_m(joints_m, confidence, np.asarray(poses["time_s"], float))
    bands_deg = np.where(known[..., None], angle_bands_deg(joints_m, spread_m), np.nan)
    posed = np.asarray(np.isfinite(joints_m[:, : len(JOINT_NAMES)]).all(axis=(1, 2)))
    bands_mm = joint_bands_mm(spread_m[:, : len(JOINT_NAMES)])
    bands_mm = np.where(posed[:, None, None], bands_mm, np.nan)
    return ClinicalRun(continuous(angles_deg, known), bands_deg, bands_mm)


def _all_joints(poses: Arrays) -> tuple[Floats, Floats]:
    """Places (n, 22, 3) and confidence (n, 22) of joints and extremities."""
    joints_m, confidence = np.asarray(poses["joints_m"]), np.asarray(poses["confidence"])
    n, more = len(joints_m), len(EXTREMITY_NAMES)
    further_m = poses.get("extremities_m", np.full((n, more, 3), np.nan))
    sure = poses.get("extremities_confidence", np.zeros((n, more)))
    return np.concatenate([joints_m, further_m], axis=1), np.concatenate([confidence, sure], axis=1)


def angles_csv(poses: Arrays) -> str:
    """A row for each of the run's: its angles, the half widths of their bands, those of the joints.

    What is not known is empty.
    """
    run, out = clinical_run(poses), io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    bands = [f"{name}_{share}_deg" for name in NAMES for share in SHARES]
    places = [f"{name}_{share}_mm" for name in JOINT_NAMES for share in SHARES]
    table.writerow(["frame", "person", "time_s", "status", *NAMES, *bands, *places])
    numbers = [part.reshape(len(part), math.prod(part.shape[1:])) for part in run]
    for n, values in enumerate(np.concatenate(numbers, axis=1).tolist()):
        head = [int(poses["frame"][n]), int(poses["person"][n]), f"{poses['time_s'][n]:.4f}"]
        cells = ["" if math.isnan(value) else f"{value:.2f}" for value in values]
        table.writerow([*head, str(poses["status"][n]), *cells])
    return out.getvalue()
