"""Clinical angles against the truth: errors, and how often the bands hold.

    .venv/bin/python benchmarks/clinical_bands.py RUNS CLIPS [RUNS CLIPS ...] [--fit]

RUNS has a run folder for each clip of CLIPS with its `truth.npz`. With --fit the reaches of
`animator/clinical/error_bands.py` are fitted to them by quantile regression (Koenker & Bassett
1978): of |error| on the spread. Frames weigh alike; with --alike each pair of folders does.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from animator.clinical.clinical_angles import NAMES, clinical_angles, defined
from animator.clinical.clinical_run import ClinicalRun, clinical_run
from animator.clinical.error_bands import angle_spreads_deg, sideless, spreads_m
from common.body.body import JOINT_NAMES, Floats, Vector
from common.body.extremities import ALL_JOINT_NAMES
from lab.accuracy.intervals import intervals
from runtime.store.joint_arrays import all_joints_m
from runtime.store.past_run import open_run

MOST = 2_000
"""Values that are fitted, drawn of all."""


class Errors(NamedTuple):
    """One clip: absolute errors, NaN where not known, half widths of bands, and spreads."""

    angles: tuple[Floats, Floats, Floats]
    joints: tuple[Floats, Floats, Floats]


def errors_of(folder: Path, clip: Path) -> Errors:
    run = open_run(folder)
    poses = run.poses
    told: ClinicalRun = clinical_run(poses)
    with np.load(clip / "truth.npz") as truth:
        names = [str(name) for name in truth["joint_names"]]
        rows = truth["frames_cam1"][poses["frame"]]
        real_m = np.full((len(rows), len(ALL_JOINT_NAMES), 3), np.nan)
        for n, name in enumerate(ALL_JOINT_NAMES):
            if name in names:
                real_m[:, n] = truth["joints3d"][rows, names.index(name)]
        due = truth["present"][rows] & np.isin(poses["status"], ("tracking", "measuring"))
    joints_m = all_joints_m(poses)
    confidence = np.concatenate([poses["confidence"], poses["extremities_confidence"]], axis=1)
    spread_m = spreads_m(joints_m, confidence, poses["time_s"])
    real_deg = clinical_angles(real_m)
    known = defined(real_deg, np.ones((len(rows), 2), bool)) & due[:, None]
    off_deg = np.abs((told.angles_deg - real_deg + 180.0) % 360.0 - 180.0)
    off_mm = 1e3 * np.linalg.norm(joints_m - real_m, axis=2)[:, : len(JOINT_NAMES)]
    return Errors(
        (
            np.where(known, off_deg, np.nan),
            told.bands_deg,
            angle_spreads_deg(joints_m, spread_m),
        ),
        (
            np.where(due[:, None], off_mm, np.nan),
            told.bands_mm,
            1e3 * spread_m[:, : len(JOINT_NAMES)],
        ),
    )


def by_name(names: tuple[str, ...]) -> dict[str, list[int]]:
    """Columns of each name, both sides together."""
    found: dict[str, list[int]] = {}
    for n, name in enumerate(names):
        found.setdefault(sideless(name), []).append(n)
    return found


def table(sets: dict[str, list[Errors]]) -> Iterator[str]:
    for part, names in (("angles", NAMES), ("joints", JOINT_NAMES)):
        for name, columns in [*by_name(names).items(), ("all", [*range(len(names))])]:
            line = f"{name:16}"
            for place, clips in sets.items():
                own = [getattr(clip, part) for clip in clips]
                off = [each[0][:, columns] for each in own]
                values = [each[np.isfinite(each)] for each in off]
                if sum(map(len, values)) < 10:
                    continue
                low, high = intervals(values).get("mean", (np.nan, np.nan))
                held = [
                    np.concatenate(
                        [
                            (o <= each[1][:, columns, n])[np.isfinite(o)]
                            for o, each in zip(off, own, strict=True)
                        ]
                    ).mean()
                    for n in range(2)
                ]
                mean = np.concatenate(values).mean()
                line += f" | {place} {mean:.1f} ({low:.1f}-{high:.1f}) {held[0]:.2f} {held[1]:.2f}"
            yield line


def fitted(
    sets: dict[str, list[Errors]], part: str, columns: list[int], alike: bool
) -> list[float]:
    """Floor and spreads of both bands."""
    rng, values = np.random.default_rng(0), []
    for clips in sets.values():
        own = [getattr(clip, part) for clip in clips]
        off, spread = (
            np.concatenate([each[n][:, columns].ravel() for each in own]) for n in (0, 2)
        )
        known = np.isfinite(off) & np.isfinite(spread)
        weight = np.full(known.sum(), 1.0 / max(known.sum(), 1) if alike else 1.0)
        values.append(np.stack([spread[known], off[known], weight]))
    x, y, w = np.concatenate(values, axis=1)
    if not len(x):
        return []
    drawn = rng.choice(len(x), min(MOST, len(x)), replace=False, p=w / w.sum())
    pairs = [quantile(x[drawn], y[drawn], q) for q in (0.68, 0.95)]
    return [round(float(value), 2) for pair in pairs for value in pair]


def quantile(x: Vector, y: Vector, q: float) -> Vector:
    """Floor and slope of a quantile, none below 0."""
    n = len(x)
    ones = sparse.eye(n)
    design = sparse.hstack([np.ones((n, 1)), x[:, None], ones, -ones]).tocsr()
    cost = np.concatenate([[0.0, 0.0], np.full(n, q), np.full(n, 1 - q)])
    solved = linprog(cost, A_eq=design, b_eq=y, bounds=[(0, None)] * len(cost), method="highs")
    return np.asarray(solved.x[:2])


def main() -> None:
    """Print a row for each angle and joint; with --fit their reaches."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--only", default="", help="Beginnings of clips' names, with commas.")
    parser.add_argument("--fit", action="store_true")
    parser.add_argument("--alike", action="store_true")
    given = parser.parse_args()
    sets: dict[str, list[Errors]] = {}
    for runs, clips in zip(given.folders[::2], given.folders[1::2], strict=True):
        for run in sorted(runs.iterdir()):
            if run.name.startswith(tuple(given.only.split(","))):
                sets.setdefault(str(runs.name), []).append(errors_of(run, clips / run.name))
    for line in table(sets):
        print(line)
    for part, names in (("angles", NAMES), ("joints", JOINT_NAMES)) if given.fit else ():
        for name, columns in by_name(names).items():
            reach = fitted(sets, part, columns, given.alike)
            print(f'    "{name}": Reach({", ".join(map(str, reach))}),')


if __name__ == "__main__":
    main()
