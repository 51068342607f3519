"""Two runs held against each other: how far angles and joints differ, and where they part."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from animator.report.belief_stretches import Stretch
from animator.report.curves import stretches
from common.body.body import JOINT_NAMES, Floats, Vector
from common.npz_file import Arrays

APART_MM: Final = 100.0
"""Mean distance of the joints above which two runs part: a body is elsewhere or posed otherwise."""
SHORTEST_S: Final = 0.1
"""Shortest such stretch, seconds."""
HIPS: Final = [JOINT_NAMES.index("l_hip"), JOINT_NAMES.index("r_hip")]


class Paired(NamedTuple):
    """The rows of two runs at the same instants."""

    first: NDArray[np.intp]
    """(k,) rows of the first run."""
    second: NDArray[np.intp]
    """(k,) rows of the second run."""
    time_s: Vector
    """(k,) by the first run."""


class Off(NamedTuple):
    """Difference of one quantity, absolute."""

    name: str
    mean: float
    """Signed mean, second minus first; of places the mean."""
    median: float
    p95: float
    frames: int


class Comparison(NamedTuple):
    """Two runs, held against each other."""

    angles: list[Off]
    """Degrees."""
    joints: list[Off]
    """Millimetres, in the world."""
    joints_beside_hips: list[Off]
    """Millimetres, with the middles of the hips laid on each other."""
    parts: list[Stretch]
    """Where both have a pose and they are far apart, or one alone has a pose."""
    both: int
    """Rows in which both have a pose."""
    one_alone: int
    """Rows in which one alone has a pose."""


def paired(first: Arrays, second: Arrays) -> Paired:
    """Rows of the same instants: each row of the first run with the nearest of the second, where
    that is no farther than half a frame."""
    one_s, other_s = (np.asarray(run["time_s"], float) for run in (first, second))
    if not len(one_s) or not len(other_s):
        return Paired(np.zeros(0, np.intp), np.zeros(0, np.intp), np.zeros(0))
    after = np.minimum(np.searchsorted(other_s, one_s), len(other_s) - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.where(one_s - other_s[before] < other_s[after] - one_s, before, after)
    half_s = 0.5 * max(_period_s(one_s), _period_s(other_s))
    close = np.abs(other_s[nearest] - one_s) <= half_s + 1e-6
    return Paired(np.flatnonzero(close), nearest[close], one_s[close])


def _period_s(time_s: Vector) -> float:
    return float(np.median(np.diff(time_s))) if len(time_s) > 1 else 0.1


def compared(
    first: Arrays, second: Arrays, angles: dict[str, tuple[Vector, Vector]], rows: Paired
) -> Comparison:
    """The differences of two runs.

    Args:
        first: Rows of the first run.
        second: Rows of the second run.
        angles: By name, (k,) degrees of both in the paired rows; NaN where not known.
        rows: The paired rows.
    """
    one_m, other_m = first["joints_m"][rows.first], second["joints_m"][rows.second]
    off_mm = 1e3 * np.linalg.norm(other_m - one_m, axis=2)
    beside_mm = 1e3 * np.linalg.norm(_beside_hips(other_m) - _beside_hips(one_m), axis=2)
    posed = [np.isfinite(each).all(axis=(1, 2)) for each in (one_m, other_m)]
    return Comparison(
        [_off(name, apart_deg(*both)) for name, both in angles.items()],
        [_off(name, off_mm[:, n]) for n, name in enumerate(JOINT_NAMES)],
        [_off(name, beside_mm[:, n]) for n, name in enumerate(JOINT_NAMES)],
        _parts(off_mm.mean(axis=1), posed[0] != posed[1], rows.time_s),
        int((posed[0] & posed[1]).sum()),
        int((posed[0] != posed[1]).sum()),
    )


def apart_deg(first: Vector, second: Vector) -> Vector:
    """Second minus first the shorter way round, degrees, in [-180, 180)."""
    found: Vector = (second - first + 180.0) % 360.0 - 180.0
    return found


def _beside_hips(joints_m: Floats) -> Floats:
    found: Floats = joints_m - joints_m[:, HIPS].mean(axis=1, keepdims=True)
    return found


def _off(name: str, values: Vector) -> Off:
    known = values[np.isfinite(values)]
    if not len(known):
        return Off(name, float("nan"), float("nan"), float("nan"), 0)
    size = np.abs(known)
    return Off(
        name,
        float(known.mean()),
        float(np.median(size)),
        float(np.percentile(size, 95)),
        len(known),
    )


def _parts(apart_mm: Vector, alone: NDArray[np.bool_], time_s: Vector) -> list[Stretch]:
    if not len(time_s):
        return []
    step_s, first_s = _period_s(time_s), float(time_s[0])
    whole_s = max(float(time_s[-1]) + step_s - first_s, 1e-9)
    found = []
    for a, b in stretches(alone | (apart_mm > APART_MM)):
        from_s, until_s = float(time_s[a]), float(time_s[b - 1]) + step_s
        if until_s - from_s < SHORTEST_S:
            continue
        if alone[a:b].mean() > 0.5:
            why = "one of them alone has a pose"
        else:
            why = f"joints up to {np.nanmax(apart_mm[a:b]):.0f} mm apart in the mean"
        left, wide = 100 * (from_s - first_s) / whole_s, 100 * (until_s - from_s) / whole_s
        found.append(Stretch("apart", a, b - 1, from_s, until_s, left, wide, why))
    return found
