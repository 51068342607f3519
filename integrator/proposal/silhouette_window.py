"""Network input from each view's silhouette: a window scaled to the person."""

from functools import lru_cache
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.compiled import compiled
from common.raster.kernel import NEAREST_M
from common.raster.silhouette_report import centroid_px
from common.raster.similarity import Mask
from common.rig.camera import Camera, Rig, arrays_of, centre, project, ray
from integrator.rig.body_position import UP_AXIS, triangulate

Floats = NDArray[np.float32]

ROWS, COLUMNS = 48, 40
"""Number of cells of the window."""
UP, DOWN, ASIDE = 0.75, 0.63, 0.56
"""Extent of the window from the middle of the silhouette, statures: raised arms above, feet
below, stretched arms aside."""
TO_A_SIDE: Final = 1e-6
"""Sine of the angle between two cameras' axes from which on they are on different sides."""
FINER: Final = 2
"""Samples of the silhouette across a cell."""

CELLS: Final = ROWS * COLUMNS
BESIDE: Final = 11
"""Number of inputs beside the windows: for each view whether it sees, the place of its camera
and its scale; the time since the input before."""
LONGEST_S, USUAL_S = 0.4, 1 / 15
"""Upper bound of that time, seconds, and its unit."""
ABOVE_M: Final = 0.1
"""Length, metres, over which the upward direction in a picture is measured."""
STEEPEST: Final = 0.75
"""Sine of the elevation beyond which a camera looks along a body."""
ALONG: Final = 1e-3
"""Sine of the angle below which a direction counts as along an axis."""
NEARNESS: Final = 4.0
"""Factor that brings stature over distance to about one."""
NEAR_M: Final = 1.0
"""Least distance, metres, at which a single camera looks for a person."""
TALLEST_M: Final = 3.0
"""Extent, metres, of a very tall person with raised arms: a single camera looks for a person no
farther off than where their silhouette would be so large."""
FAR_M: Final = 12.0
"""Distance, metres, beyond which the networks are shown no smaller perspective: the training data
contain none."""


class Look(NamedTuple):
    """The network input of the views, and its frame."""

    windows: Floats
    """(2, CELLS) covered share of each cell; 0 for a view without the person."""
    beside: Floats
    """(BESIDE,) inputs beside the windows."""
    middle_m: Vector
    """(3,) place of the body, world."""
    turn: Vector
    """(3, 3) rows: the axes of the proposal's frame in the world; left-handed where mirrored."""
    mirrored: bool = False
    """True: the windows are mirrored, so right limbs are left ones."""


@lru_cache(maxsize=8)
def axes_of(one: Camera, other: Camera) -> Vector:
    """Axes of the proposal's frame, rows (3, 3): y up, z towards one camera.

    x points to the right of that camera, roll removed, or to the left where mirrored. So the other
    camera always stands where the paper's camera 2 does, to the left, as in most training data.
    """
    first, second = np.array(one.R)[2], np.array(other.R)[2]
    right = np.cross(first, UP_AXIS)
    if np.linalg.norm(right) < TO_A_SIDE:
        right = np.array(one.R)[0] * [1.0, 0.0, 1.0]
    right /= np.linalg.norm(right)
    side = -1.0 if np.cross(first, second)[1] > TO_A_SIDE else 1.0
    return np.stack([side * right, [0.0, 1.0, 0.0], np.cross(right, [0.0, 1.0, 0.0])])


def look(
    masks: tuple[Mask | None, Mask | None],
    rig: Rig,
    stature_m: float,
    since_s: float,
    up: Vector | None = None,
) -> Look | None:
    """The silhouettes as network input; None where their rays do not meet in front of both cameras.

    Args:
        masks: Silhouettes of the views, (H, W), not empty; None for a view without the person.
        rig: The cameras; their world has y up and its floor at 0.
        stature_m: The person's stature.
        since_s: Time since the input before.
        up: (3,) direction to the head of a person who leans far or lies, world; None: upright.
    """
    middle_m = _middle_m(masks, rig)
    if middle_m is None:
        return None
    if up is not None:
        masks = _from_a_side(masks, rig, middle_m, up)
    turn = (
        axes_of(rig.cameras[0], rig.cameras[1]) if up is None else _about(masks, rig, middle_m, up)
    )
    mirrored = bool(np.linalg.det(turn) < 0.0)
    windows, beside = np.zeros((2, CELLS), np.float32), np.zeros(BESIDE, np.float32)
    beside[-1] = min(since_s, LONGEST_S) / USUAL_S - 1.0
    for n, mask in enumerate(masks):
        if mask is None:
            continue
        camera = rig.cameras[n]
        _tell(turn, centre(camera) - middle_m, stature_m, beside[5 * n : 5 * n + 5])
        cells = _cells(mask, camera, middle_m, stature_m, turn[1])
        windows[n] = (cells[:, ::-1] if mirrored else cells).ravel()
    return Look(windows, beside, middle_m, turn, mirrored)


def _from_a_side(
    masks: tuple[Mask | None, Mask | None], rig: Rig, middle_m: Vector, up: Vector
) -> tuple[Mask | None, Mask | None]:
    """The views without one that looks along the body, where the other sees it from a side: the
    training data contain no such view."""
    first, second = masks
    rises = [abs(float(_away(camera, middle_m) @ up)) for camera in rig.cameras]
    if first is None or second is None or max(rises) <= STEEPEST:
        return masks
    return (first, None) if rises[1] > rises[0] else (None, second)


def _about(
    masks: tuple[Mask | None, Mask | None], rig: Rig, middle_m: Vector, up: Vector
) -> Vector:
    """Axes like those of `axes_of` for a person who leans far: y to the head, z towards camera
    1. Where camera 2 is alone, it is placed to the left, as the paper's."""
    first, second = (_across(_away(camera, middle_m), up) for camera in rig.cameras)
    if masks[0] is None:
        return np.stack([-second, up, np.cross(-second, up)])
    right = np.cross(up, first)
    side = -1.0 if masks[1] is not None and second @ right > 0.0 else 1.0
    return np.stack([side * right, up, first])


def _away(camera: Camera, middle_m: Vector) -> Vector:
    """Towards a camera, unit length."""
    away: Vector = centre(camera) - middle_m
    return away / np.linalg.norm(away)


def _across(away: Vector, up: Vector) -> Vector:
    """The part of a direction perpendicular to an axis, unit length; any perpendicular for one
    along it."""
    for tried in (away, *np.eye(3)):
        across = tried - (tried @ up) * up
        length = float(np.linalg.norm(across))
        if length > ALONG:
            return across / length
    raise AssertionError("no axis is along all axes")


@compiled
def _tell(
    turn: NDArray[np.float64],
    away_m: NDArray[np.float64],
    stature_m: float,
    out: NDArray[np.float32],
) -> None:
    """One view's inputs beside its window, (5,): that it sees, its camera's place, its scale."""
    far = np.sqrt((away_m * away_m).sum())
    out[0], out[4] = 1.0, NEARNESS * stature_m / min(far, FAR_M)
    for i in range(3):
        out[1 + i] = (turn[i] * away_m).sum() / far


def _middle_m(masks: tuple[Mask | None, Mask | None], rig: Rig) -> Vector | None:
    """Intersection of the rays to the silhouettes' middles; for a single view the place where
    its feet stand."""
    first, second = masks
    if first is not None and second is not None:
        found = triangulate(
            (rig.cameras[0], rig.cameras[1]), (centroid_px(first), centroid_px(second))
        )
        if not all(_depth_m(camera, found) >= NEAREST_M for camera in rig.cameras):
            return None
    else:
        views = zip(masks, rig.cameras, strict=True)
        found = next(standing_m(mask, camera) for mask, camera in views if mask is not None)
    return found if np.isfinite(found).all() else None


def standing_m(mask: Mask, camera: Camera) -> Vector:
    """The middle of a silhouette whose lowest point, along down in its picture, is on the floor.

    Near the horizon the floor's distance means nothing: the silhouette is taken for no giant's.
    """
    middle_px = centroid_px(mask)
    eye, middle = centre(camera), ray(camera, middle_px)
    downwards = _downwards(camera, eye + middle)
    rows, columns = np.nonzero(mask)
    along = (np.stack([columns, rows], axis=1) + 0.5 - middle_px) @ downwards
    half_px = 0.5 * float(np.abs(downwards).sum())
    lowest = middle_px + downwards * (along.max() + half_px)
    down = ray(camera, (float(lowest[0]), float(lowest[1])))
    flat = float(np.hypot(down[0], down[2]))
    steep = -down[1] / max(flat, 1e-9)
    farthest_m = TALLEST_M * camera.K[0][0] / float(np.ptp(along) + 2.0 * half_px)
    far_m = eye[1] / steep if steep > eye[1] / farthest_m else farthest_m
    found: Vector = eye + middle * (
        max(far_m, NEAR_M) / max(float(np.hypot(middle[0], middle[2])), 1e-9)
    )
    return found


def _downwards(camera: Camera, place_m: Vector) -> Vector:
    """The downward direction in a picture at a place in front of its camera, (2,), unit length."""
    at, above = project(camera, np.stack([place_m, place_m + ABOVE_M * UP_AXIS]))
    down: Vector = (at - above) / max(float(np.linalg.norm(at - above)), 1e-9)
    return down


def _depth_m(camera: Camera, place_m: Vector) -> float:
    """Depth of a place in a camera; negative behind it, NaN where there is no place."""
    return float(arrays_of(camera).R[2] @ place_m + camera.t[2])


def _cells(mask: Mask, camera: Camera, middle_m: Vector, stature_m: float, up: Vector) -> Floats:
    """Covered share of each cell, (ROWS, COLUMNS): upright, scaled to the person."""
    at_and_above = project(camera, np.stack([middle_m, middle_m + ABOVE_M * up]))
    size_px = camera.K[0][0] * stature_m / _depth_m(camera, middle_m)
    fine = cv2.warpAffine(
        mask.view(np.uint8) * np.uint8(255),
        _warp(at_and_above, size_px),
        (FINER * COLUMNS, FINER * ROWS),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
    )
    cells = cv2.resize(fine, (COLUMNS, ROWS), interpolation=cv2.INTER_AREA)
    return np.asarray(cells / np.float32(255), np.float32)


@compiled
def _warp(at_and_above: NDArray[np.float64], size_px: float) -> NDArray[np.float64]:
    """Affine map from samples of the window to the picture, (2, 3), in OpenCV's form.

    Args:
        at_and_above: The middle of the body and a place above it, (2, 2) px.
        size_px: Pixels per stature there.
    """
    up = at_and_above[1] - at_and_above[0]
    up /= max(np.hypot(up[0], up[1]), 1e-9)
    warp = np.empty((2, 3))
    for i in range(2):
        across = -up[1] if i == 0 else up[0]
        right = across * size_px * 2 * ASIDE / (FINER * COLUMNS)
        down = -up[i] * size_px * (UP + DOWN) / (FINER * ROWS)
        corner = at_and_above[0, i] + up[i] * size_px * UP - right * FINER * COLUMNS / 2
        warp[i, 0], warp[i, 1], warp[i, 2] = right, down, corner + (right + down) / 2 - 0.5
    return warp
