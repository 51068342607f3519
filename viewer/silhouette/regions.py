"""Regions of a coarse picture in which somebody may be, and those that are one person's."""

import math
from typing import Any, Final

import numba
import numpy as np

from viewer.silhouette.difference import Bytes

APART_SHARE: Final = 0.2
"""Regions this share of the picture's height apart can still be one body."""
LEFT, TOP, RIGHT, BOTTOM, AREA, ALONG, DOWN = range(7)
"""What is counted of a region: its box, the last ones excluded, its cells, sums of their places."""
NOWHERE: Final = (math.nan, math.nan)


@numba.njit(cache=True)
def chosen(
    found: Bytes, least_share: float, near: tuple[float, float] = NOWHERE
) -> tuple[Bytes, int]:
    """The cells around the person's region, and how many regions could be a person.

    Args:
        found: (rows, columns) 1 where something is.
        least_share: Of the picture's height, as tall as a person is at least.
        near: Column and row where the middle of the person is expected; NOWHERE: the largest
            region is taken.
    """
    joined = _widened(found)
    labels, regions = _labelled(joined)
    rows = len(found)
    # joining made every region two cells taller
    large = regions[:, BOTTOM] - regions[:, TOP] - 2 >= least_share * rows
    if not large.any():
        return joined, 0
    own = same_body(regions, _best(regions, large, near), rows)
    for i in range(rows):
        for j in range(found.shape[1]):
            joined[i, j] = labels[i, j] > 0 and own[labels[i, j] - 1]
    return joined, 1 + int(np.count_nonzero(large & ~own))


@numba.njit(cache=True)
def _widened(found: Bytes) -> Bytes:
    """All cells around those that are found, too."""
    rows, columns = found.shape
    out = np.zeros_like(found)
    for i in range(rows):
        for j in range(columns):
            if found[i, j]:
                out[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2] = 1
    return out


@numba.njit(cache=True)
def _labelled(cells: Bytes) -> tuple[Any, Any]:
    """Numbers of the regions of cells that touch, from 1 on, and (n, 7) what is counted of each."""
    rows, columns = cells.shape
    labels = np.zeros(cells.shape, np.int32)
    waiting = np.empty((cells.size, 2), np.int32)
    regions = np.empty((cells.size, 7), np.int64)
    count = 0
    for i in range(rows):
        for j in range(columns):
            if cells[i, j] and not labels[i, j]:
                waiting[0, 0], waiting[0, 1] = i, j
                labels[i, j] = count + 1
                _fill(cells, labels, waiting, regions[count])
                count += 1
    return labels, regions[:count]


@numba.njit(cache=True)
def _fill(cells: Bytes, labels: Any, waiting: Any, region: Any) -> None:
    """Number and count all that hangs together with the one cell that waits."""
    number, end = labels[waiting[0, 0], waiting[0, 1]], 1
    region[:] = 0
    region[LEFT], region[TOP] = waiting[0, 1], waiting[0, 0]
    while end:
        end -= 1
        i, j = waiting[end, 0], waiting[end, 1]
        region[LEFT], region[RIGHT] = min(region[LEFT], j), max(region[RIGHT], j + 1)
        region[TOP], region[BOTTOM] = min(region[TOP], i), max(region[BOTTOM], i + 1)
        region[AREA] += 1
        region[ALONG] += j
        region[DOWN] += i
        for y in range(max(i - 1, 0), min(i + 2, len(cells))):
            for x in range(max(j - 1, 0), min(j + 2, cells.shape[1])):
                if cells[y, x] and not labels[y, x]:
                    labels[y, x] = number
                    waiting[end, 0], waiting[end, 1] = y, x
                    end += 1


@numba.njit(cache=True)
def _best(regions: Any, large: Any, near: tuple[float, float]) -> int:
    """Of the large regions the largest, or the one whose middle is nearest to a place."""
    best, least = -1, np.inf
    for n in range(len(regions)):
        area = regions[n, AREA]
        off = -float(area)
        if not math.isnan(near[0]):
            column, row = regions[n, ALONG] / area + 0.5, regions[n, DOWN] / area + 0.5
            off = math.hypot(column - near[0], row - near[1])
        if large[n] and off < least:
            best, least = n, off
    return best


@numba.njit(cache=True)
def same_body(regions: Any, best: int, rows: int) -> Any:
    """Which regions stand over or under the best one, or all but touch it.

    Clothes of the wall's colour part a body across; people who stand side by side do not overlap.

    Args:
        regions: (n, 4 or more), LEFT to BOTTOM of each.
        best: Which of them is somebody's.
        rows: Of the picture.
    """
    own = np.zeros(len(regions), np.bool_)
    one = regions[best]
    for n in range(len(regions)):
        other = regions[n]
        overlap = min(other[RIGHT], one[RIGHT]) - max(other[LEFT], one[LEFT])
        gap = max(other[TOP], one[TOP]) - min(other[BOTTOM], one[BOTTOM])
        wide = overlap > 0.5 * (other[RIGHT] - other[LEFT])
        own[n] = n == best or (wide and gap < APART_SHARE * rows)
    return own
