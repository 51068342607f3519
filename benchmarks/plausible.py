"""How many poses of runs without a truth are plausible: within the limits, with S of 0.6 or more.

Run from the checkout: .venv/bin/python benchmarks/plausible.py RUNS... [--frames 0-62,678-1301]

Of all frames with a pose; with --frames of all those, which show somebody by eye.
"""

import argparse
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import ANGLE_NAMES, LIMITS_DEG

FITS: Final = 0.6
ROUNDING_DEG: Final = 0.01
LOW_DEG, HIGH_DEG = np.array([LIMITS_DEG.get(name, (-np.inf, np.inf)) for name in ANGLE_NAMES]).T


def plausible(poses: dict[str, Any]) -> NDArray[np.bool_]:
    """Which frames of a run have a plausible pose, (n,)."""
    angles_deg = poses["angles_deg"]
    inside = (angles_deg >= LOW_DEG - ROUNDING_DEG) & (angles_deg <= HIGH_DEG + ROUNDING_DEG)
    found: NDArray[np.bool_] = (
        posed(poses) & inside.all(axis=1) & (poses["score"].max(axis=1) >= FITS)
    )
    return found


def posed(poses: dict[str, Any]) -> NDArray[np.bool_]:
    """Which frames have a pose, (n,)."""
    found: NDArray[np.bool_] = np.isfinite(poses["joints_m"]).all(axis=(1, 2))
    return found


def within(frames: NDArray[np.int64], ranges: str) -> NDArray[np.bool_]:
    """Which frames lie in ranges such as 0-62,678-1301, ends included."""
    ends = [[int(end) for end in each.split("-")] for each in ranges.split(",")]
    found: NDArray[np.bool_] = np.any([(frames >= a) & (frames <= b) for a, b in ends], axis=0)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", nargs="+", type=Path, help="run folders of `tritrack single`")
    parser.add_argument("--frames", help="those that show somebody; without: those with a pose")
    given = parser.parse_args()
    for run in given.runs:
        with np.load(run / "poses.npz", allow_pickle=False) as file:
            poses = dict(file)
        due = within(poses["frame"], given.frames) if given.frames else posed(poses)
        print(f"{run.name}: {plausible(poses)[due].mean():.3f} of {due.sum()} frames")


if __name__ == "__main__":
    main()
