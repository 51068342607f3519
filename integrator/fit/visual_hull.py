"""The common visual hull of two silhouettes: a person without other foreground.

A place that both views show belongs to their common hull (Laurentini 1994); a person is one piece
of it, and the largest and tallest. Shadows, glare and moved furniture are other pieces, or none.
"""

from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.bus.instant import TwoSeen
from common.compiled import compiled
from common.raster.kernel import NEAREST_M, seen_at, view_of
from common.raster.silhouette_report import unpack, with_silhouette
from common.raster.similarity import Mask
from common.rig.camera import Camera, Rig, project, px_per_m
from integrator.rig.body_position import triangulate
from integrator.rig.undistortion import undistorted

CELL_M: Final = 0.05
"""Side of a cell, metres: thinner than an arm, so that it stays connected to its hand."""
ASIDE_CELLS: Final = 40
"""Half width of the volume, cells: 2 m to each side of the middle of the silhouettes, which
clutter draws away from the person."""
UP_CELLS: Final = 48
FLOOR_M: Final = 0.05
"""Height below which a cell lies on the floor, metres."""
REACH_CELLS: Final = 10
"""Largest distance that an arm may reach out of one of the pictures, cells."""
CLUTTER_SHARE: Final = 0.03
"""Share of a silhouette that must be clutter to be removed: the hull is coarse."""


class Cleaned(NamedTuple):
    """A person in two views, as one piece, and whether anything else was in the views."""

    seen: TwoSeen
    clutter: bool


def cleaned(rig: Rig, seen: TwoSeen) -> Cleaned:
    """A person in two views, without what does not belong to them.

    Args:
        rig: Two cameras; their world has y up and its floor at 0.
        seen: The person in each view; returned unchanged where one view alone shows them.
    """
    first, second = seen
    if first is None or second is None:
        return Cleaned(seen, False)
    masks = (unpack(first), unpack(second))
    kept = one_piece(rig, masks)
    if kept is None or not any(
        after.sum() < (1.0 - CLUTTER_SHARE) * before.sum()
        for after, before in zip(kept, masks, strict=True)
    ):
        return Cleaned(seen, False)
    return Cleaned((with_silhouette(first, kept[0]), with_silhouette(second, kept[1])), True)


def one_piece(rig: Rig, masks: tuple[Mask, Mask]) -> tuple[Mask, Mask] | None:
    """The parts of both silhouettes that show the largest piece of their hull; None where there is
    none.

    Args:
        rig: Two cameras.
        masks: The silhouettes, not empty.
    """
    first, second = (_median_px(mask) for mask in masks)
    middle_m = triangulate((rig.cameras[0], rig.cameras[1]), (first, second))
    if not np.isfinite(middle_m).all():
        return None
    corner_m = middle_m - ASIDE_CELLS * CELL_M
    corner_m[1] = FLOOR_M
    views = np.array([view_of(camera) for camera in rig.cameras])
    full = np.zeros((2 * ASIDE_CELLS, UP_CELLS, 2 * ASIDE_CELLS), np.int8)
    for view, mask, camera in zip(views, masks, rig.cameras, strict=True):
        _carve(full, corner_m, view, undistorted(mask, camera))
    piece = _largest(full)
    if not len(piece):
        return None
    places_m = corner_m + (piece + 0.5) * CELL_M
    kept = [
        mask & _shown(places_m, camera, mask)
        for mask, camera in zip(masks, rig.cameras, strict=True)
    ]
    return (kept[0], kept[1]) if kept[0].any() and kept[1].any() else None


def _median_px(mask: Mask) -> tuple[float, float]:
    rows, columns = np.nonzero(mask)
    return float(np.median(columns)) + 0.5, float(np.median(rows)) + 0.5


@compiled
def _carve(full: NDArray[np.int8], corner_m: Vector, view: Vector, mask: Mask) -> None:
    """Count the views in which each cell is covered; -1 where one sees background there.

    A place that one view covers and that is outside the other's picture may be an arm that reaches
    out.
    """
    height, width = mask.shape
    for i in range(full.shape[0]):
        for j in range(full.shape[1]):
            for k in range(full.shape[2]):
                if full[i, j, k] < 0:
                    continue
                x = corner_m[0] + (i + 0.5) * CELL_M
                y = corner_m[1] + (j + 0.5) * CELL_M
                z = corner_m[2] + (k + 0.5) * CELL_M
                u, v, depth = seen_at(view, x, y, z)
                if depth >= NEAREST_M and 0.0 <= u < width and 0.0 <= v < height:
                    full[i, j, k] = full[i, j, k] + 1 if mask[int(v), int(u)] else -1


def _largest(full: NDArray[np.int8]) -> NDArray[np.int64]:
    """Cells, (n, 3), of the piece in both views with the most volume times height.

    In addition the adjacent cells of one view: an arm that reaches out of the other's picture.
    """
    piece = np.zeros(full.shape, np.bool_)
    _fill_largest(full, piece)
    return _cells(piece)


@compiled
def _fill_largest(full: NDArray[np.int8], piece: NDArray[np.bool_]) -> None:
    """Set the cells of the piece."""
    common, lone = full == 2, full == 1
    cells = np.empty((full.size + 1, 3), np.int32)
    first = last = end = worth = 0
    for i in range(full.shape[0]):
        for j in range(full.shape[1]):
            for k in range(full.shape[2]):
                if common[i, j, k]:
                    cells[end], common[i, j, k], begin = (i, j, k), False, end
                    end = _flood(common, cells, begin, begin + 1, full.size)
                    rows = cells[begin:end, 1]
                    own = len(rows) * (rows.max() - rows.min() + 1)
                    if own > worth:
                        first, last, worth = begin, end, own
    cells[: last - first] = cells[first:last].copy()
    for n in range(_flood(lone, cells, 0, last - first, REACH_CELLS)):
        piece[cells[n, 0], cells[n, 1], cells[n, 2]] = True


@compiled
def _flood(
    free: NDArray[np.bool_], cells: NDArray[np.int32], begin: int, end: int, steps: int
) -> int:
    """The end of the cells, (n, 3), with those that are free and so many steps from the ones from
    begin to end; they are free no more."""
    for _ in range(steps):
        known = end
        for n in range(begin, known):
            for axis in range(3):
                for step in (-1, 1):
                    cells[end] = cells[n]
                    at = cells[end, axis] = cells[n, axis] + step
                    i, j, k = cells[end]
                    if 0 <= at < free.shape[axis] and free[i, j, k]:
                        free[i, j, k] = False
                        end += 1
        if end == known:
            break
        begin = known
    return end


def _cells(where: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The cells, (n, 3), where a condition holds; np.argwhere takes ten times as long."""
    return np.stack(np.unravel_index(np.flatnonzero(where), where.shape), axis=1)


def _shown(places_m: NDArray[np.float64], camera: Camera, mask: Mask) -> Mask:
    """The area in which a view shows cells at given places."""
    height, width = mask.shape
    u, v = project(camera, places_m).T  # nan behind the camera, which is in no picture
    inside = (u >= 0) & (v >= 0) & (u < width) & (v < height)
    dots = np.zeros(mask.shape, np.uint8)
    dots[v[inside].astype(int), u[inside].astype(int)] = 1
    reach = int(np.ceil(CELL_M * px_per_m(camera, places_m.mean(axis=0))))
    around = np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
    return np.asarray(cv2.dilate(dots, around) > 0)
