"""What the outputs of the network of landmarks mean: joints in a window, and how sure they are."""

import math
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats, Vector
from common.compiled import KERNEL, compiled
from viewer.landmarks.landmark_looks import BINS, CELLS, SHIPPED, seen, seen_twice
from viewer.landmarks.landmark_window import PLANES, SIDE, Planes

FARTHEST: Final = 0.8
"""Largest distance of a peak from the middle of its highest cell, cells."""
LEAST: Final = np.float32(math.exp(-16.0))
"""Share of a cell, the highest 1, below which it is left out: all cells of a map together would
add a thousandth."""
APART: Final = 4
"""Distance of a map's second peak from its highest, down or across, cells: it is larger than
this."""
PLATT: Final = (0.75, 0.94, 0.57)
"""Platt scaling of a joint's confidence: weights of the network's own logit, of the logit of the
share of the map about the peak, and the offset; the target is a joint less than 0.03 statures
off."""
PLATT_OF_SECOND: Final = (-0.08, 1.52, 0.54)
"""Platt scaling of the second place of a joint: how often it was there and not at the highest
place."""


class Found(NamedTuple):
    """What the network makes of a window."""

    joints: NDArray[np.float64]
    """(15, 2) JOINT_NAMES order; pixels of the planes, the first's centre at 0.5."""
    confidence: Vector
    """(15,) how probably each is less than 0.03 statures off."""
    facing_deg: float
    facing_confidence: float
    nobody: float
    """How probably there is no person in the window."""
    second: NDArray[np.float64]
    """(15, 2) where else each joint may be, as `joints`."""
    second_confidence: Vector
    """(15,) probability that the joint is at its second place instead."""
    mask: NDArray[np.float32]
    """(CELLS, CELLS) logits that a cell shows the person."""


def find(planes: Planes, network: Path = SHIPPED, twice: bool = False) -> Found:
    """The joints in a window.

    Args:
        planes: (1, PLANES, SIDE, SIDE)
        network: A file of ours.
        twice: As they are, and in the mirror: what the two looks do not agree on is less sure.
    """
    assert planes.shape == (1, PLANES, SIDE, SIDE)
    maps, told, mask = seen_twice(planes, network) if twice else seen(planes, network)
    joints, about = _peaks(maps)
    bins, nobody, sure = told[:BINS], told[BINS], told[BINS + 1 :]
    first, second = (
        _probable(np.ascontiguousarray(near), sure, *platt)
        for near, platt in zip(about.T, (PLATT, PLATT_OF_SECOND), strict=True)
    )
    facing_deg, facing_confidence = _facing(bins)
    return Found(
        joints[:, 0],
        first,
        facing_deg,
        facing_confidence,
        _sigmoid(nobody),
        joints[:, 1],
        second,
        mask,
    )


def _peaks(maps: Floats | NDArray[np.float32]) -> tuple[Floats, Floats]:
    """Where each map of logits (15, CELLS, CELLS) is highest, and next to that, (15, 2, 2), and
    its shares about there, (15, 2).

    Between cells a peak is that of the bell through the three sums of cells about the highest:
    maps are taught to be bells, and a mean over few cells would lean to the middle one.
    """
    flat, every = maps.reshape(len(maps), -1), np.arange(len(maps))
    highest = flat.argmax(axis=1)
    shares = np.exp(flat - flat[every, highest, None])  # all at once takes a tenth of one by one
    apart, totals = shares.copy(), np.empty(len(maps))
    _leave_out(shares.reshape(maps.shape), apart.reshape(maps.shape), highest, totals)
    cells = np.stack([highest, apart.argmax(axis=1)], axis=1)
    joints, about = np.empty((len(maps), 2, 2)), np.empty((len(maps), 2))
    _fill_peaks(shares.reshape(maps.shape), cells, joints, about)
    return joints, about / totals[:, None]


@KERNEL
def _leave_out(
    shares: NDArray[np.float32], apart: NDArray[np.float32], highest: NDArray[np.intp], out: Vector
) -> None:
    """Leave out cells (n, CELLS, CELLS) below LEAST, in `apart` those about the highest; `out` (n,)
    gets the sums."""
    for j in range(len(shares)):
        total, own = 0.0, shares[j]
        for i in range(CELLS):
            for k in range(CELLS):
                share = own[i, k] if own[i, k] >= LEAST else np.float32(0.0)
                own[i, k] = share
                total += float(share)
        out[j] = total
        row, column = divmod(highest[j], CELLS)
        rows = slice(max(row - APART, 0), row + APART + 1)
        apart[j, rows, max(column - APART, 0) : column + APART + 1] = -1.0


@compiled
def _fill_peaks(
    shares: NDArray[np.float32], cells: NDArray[np.intp], joints: Floats, about: Floats
) -> None:
    for j in range(len(shares)):
        for n in range(2):
            row, column = divmod(cells[j, n], CELLS)
            about[j, n] = _peak(shares[j], row, column, joints[j, n])


@compiled
def _peak(shares: Floats | NDArray[np.float32], row: int, column: int, place: Vector) -> float:
    """What lies about a cell; `place` (2,) gets where the bell about it has its peak."""
    near = 0.0
    rows, columns = np.full(3, 1e-9), np.full(3, 1e-9)
    for i in range(max(row - 1, 0), min(row + 2, CELLS)):
        for k in range(max(column - 1, 0), min(column + 2, CELLS)):
            near += shares[i, k]
            rows[i - row + 1] += shares[i, k]
            columns[k - column + 1] += shares[i, k]
    place[0] = (column + 0.5 + _between(columns)) * SIDE / CELLS
    place[1] = (row + 0.5 + _between(rows)) * SIDE / CELLS
    return near


@compiled
def _between(three: Vector) -> float:
    """Where a bell through three neighbours has its peak, from the middle one, in cells."""
    low, middle, high = np.log(three[0]), np.log(three[1]), np.log(three[2])
    bent = min(low - 2.0 * middle + high, -1e-3)
    return min(max(0.5 * (low - high) / bent, -FARTHEST), FARTHEST)


@compiled
def _facing(bins: NDArray[np.float32] | Vector) -> tuple[float, float]:
    """The direction and how probably it is less than 45 degrees off, of BINS logits."""
    share, best = np.empty(BINS), bins.argmax()
    for i in range(BINS):
        share[i] = np.exp(float(bins[i]) - float(bins[best]))
    turn = 2.0 * np.pi / BINS
    across, along = 0.0, 0.0
    for i in range(BINS):
        if np.cos(turn * (i - best)) > 0.9:
            across += share[i] * np.sin(turn * i)
            along += share[i] * np.cos(turn * i)
    mean, near = np.arctan2(across, along), 0.0
    for i in range(BINS):
        if np.cos(turn * i - mean) > np.sqrt(0.5):
            near += share[i]
    return np.degrees(mean), near / share.sum()


@compiled
def _probable(
    near: Vector, sure: NDArray[np.float32] | Vector, slope: float, share: float, offset: float
) -> Floats:
    """(15,) how probable joints are, of what of their maps lies near, and of logits."""
    found = np.empty(len(near))
    for j in range(len(near)):
        kept = min(max(near[j], 1e-4), 1.0 - 1e-4)
        found[j] = _sigmoid(slope * sure[j] + share * np.log(kept / (1.0 - kept)) + offset)
    return found


@compiled
def _sigmoid(value: float | np.float32) -> float:
    return 1.0 / (1.0 + np.exp(-min(max(float(value), -60.0), 60.0)))
