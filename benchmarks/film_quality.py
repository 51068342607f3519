"""How calm, how rigid and how alternating the bodies are that `tritrack single` finds in films.

Run from the checkout: .venv/bin/python benchmarks/film_quality.py RUNS... [--landmarks FILE]

Needs no truth, and proves none: a body that stands still is calm. Of each run, and of the other
tracker's landmarks of the same film where a file of them is named (`landmarks_mediapipe.npz`):

* jitter: 95th percentile, over joints and frames, of the second difference of their places, in
  the picture and in space, % of the stature;
* steps: how often the feet part, and after how many of these the other foot leads;
* lengths: how much the limb whose length varies most does, 95th less 5th percentile, % of median.
"""

import argparse
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from scipy.signal import find_peaks

from common.body.body import JOINT_NAMES, LIMB_ENDS
from runtime.live.table import table_of_rows
from runtime.store.past_run import open_run

Floats = NDArray[np.float64]

UPRIGHT: Final = 0.78
"""Trunk, thigh and shank are so much of the stature (as `score_landmarks.py` has it)."""
AROUND: Final = 12
"""Frames to either side over which a stature in the picture is the median."""
PARTED: Final = 0.1
"""Feet this far apart, in statures, and together again before, are a step."""
AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}
TWELVE: Final = [name for name in JOINT_NAMES if name[1] == "_"]


class Course(NamedTuple):
    """Joints over time, of one dimension or another."""

    frame: NDArray[np.int64]
    """(n,)"""
    places: Floats
    """(n, 12, 2 or 3), TWELVE order; NaN where there is no pose."""


def statures(places: Floats) -> Floats:
    """(n,) of the frames, in the places' unit: of a second's median, so that who bends is tall."""

    def length(near: str, far: str) -> Floats:
        ends = [[TWELVE.index(f"{side}_{name}") for side in "lr"] for name in (near, far)]
        apart: Floats = np.linalg.norm(places[:, ends[0]] - places[:, ends[1]], axis=2).mean(axis=1)
        return apart

    own = (length("shoulder", "hip") + length("hip", "knee") + length("knee", "ankle")) / UPRIGHT
    around = [_median(own[max(0, i - AROUND) : i + AROUND + 1]) for i in range(len(own))]
    seen = own[np.isfinite(own)]
    return np.fmax(around, 0.6 * np.percentile(seen, 75)) if len(seen) else own


def _median(values: Floats) -> float:
    seen = values[np.isfinite(values)]
    return float(np.median(seen)) if len(seen) else np.nan


def jitter(course: Course) -> float:
    """95th percentile of joints' second difference, % of the stature; NaN without three in a row.

    What is in a row has frames in even steps, and a pose in each.
    """
    step = int(np.median(np.diff(course.frame))) if len(course.frame) > 1 else 1
    even = (np.diff(course.frame)[1:] == step) & (np.diff(course.frame)[:-1] == step)
    second = np.linalg.norm(np.diff(course.places, 2, axis=0), axis=2)
    share = (second / statures(course.places)[1:-1, None])[even]
    seen = share[np.isfinite(share)]
    return 100 * float(np.percentile(seen, 95)) if len(seen) else np.nan


def steps(course: Course) -> tuple[int, int]:
    """How often the feet part, and how often the other foot leads than the time before.

    Along the direction in which they part most: that of the walk, or upwards where somebody walks
    on the spot before the camera. Where they are together in between, or a frame has no pose, the
    count begins anew.
    """
    apart = course.places[:, TWELVE.index("l_ankle")] - course.places[:, TWELVE.index("r_ankle")]
    apart = apart / statures(course.places)[:, None]
    posed = np.isfinite(apart).all(axis=1)
    if not posed.any():
        return 0, 0
    # about the mean, so that where feet stand apart all the time is not the direction
    varies = apart[posed] - apart[posed].mean(axis=0)
    along: Floats = np.linalg.svd(varies, full_matrices=False)[2][0]
    found = alternating = 0
    for stretch in np.split(apart, np.flatnonzero(np.diff(posed.astype(int))) + 1):
        lead = stretch @ along
        if not np.isfinite(lead).all():
            continue
        wide = np.concatenate([[0.0], np.abs(lead), [0.0]])
        peaks = find_peaks(wide, height=PARTED, prominence=PARTED)[0] - 1
        found += max(0, len(peaks) - 1)
        alternating += int(np.count_nonzero(np.diff(np.sign(lead[peaks]))))
    return found, alternating


def spread(joints_m: Floats) -> float:
    """Of the limb whose length varies most, 95th less 5th percentile, % of its median.

    Args:
        joints_m: (n, 15, 3)
    """
    posed = joints_m[np.isfinite(joints_m).all(axis=(1, 2))]
    if not len(posed):
        return np.nan
    length_m = np.linalg.norm(posed[:, LIMB_ENDS[:, 1]] - posed[:, LIMB_ENDS[:, 0]], axis=2)
    low, middle, high = np.percentile(length_m, (5, 50, 95), axis=0)
    return 100 * float(((high - low) / middle).max())


def row_of(run: Path) -> dict[str, Any]:
    """The figures of a run."""
    poses = open_run(run).poses
    twelve = [AT[name] for name in TWELVE]
    seen = Course(poses["frame"], poses["joints_px"][:, 0, twelve])
    told = steps(seen)
    return {
        "name": run.name,
        "jitter in picture %": jitter(seen),
        "jitter in space %": jitter(Course(poses["frame"], poses["joints_m"][:, twelve])),
        "steps": told[0],
        "alternating": told[1],
        "lengths %": spread(poses["joints_m"]),
    }


def row_of_landmarks(key: str, landmarks: dict[str, Any]) -> dict[str, Any]:
    """The same of another tracker's landmarks, which has no lengths."""
    names = [str(name) for name in landmarks["joint_names"]]
    places = landmarks[key][:, [names.index(name) for name in TWELVE], :2].astype(np.float64)
    course = Course(np.arange(len(places)), places)
    told = steps(course)
    return {
        "name": f"landmarks of {key}",
        "jitter in picture %": jitter(course),
        "jitter in space %": np.nan,
        "steps": told[0],
        "alternating": told[1],
        "lengths %": np.nan,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", nargs="+", type=Path, help="run folders of `tritrack single`")
    parser.add_argument("--landmarks", type=Path, help="another tracker's, of the same films")
    given = parser.parse_args()
    rows = [row_of(run) for run in given.runs]
    if given.landmarks is not None:
        landmarks = dict(np.load(given.landmarks))
        films = {run.name for run in given.runs}
        keys = [key for key in landmarks if Path(key).stem in films and f"{key}__size" in landmarks]
        rows += [row_of_landmarks(key, landmarks) for key in keys]
    Console(width=140).print(table_of_rows(rows))
    for kind in (rows[: len(given.runs)], rows[len(given.runs) :]):
        if kind:
            told = sum(row["alternating"] for row in kind), sum(row["steps"] for row in kind)
            print(f"alternating steps of {len(kind)} films: {told[0]} of {told[1]}")


if __name__ == "__main__":
    main()
