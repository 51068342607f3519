"""Where the body is, from where each view has its navel; how large a metre is there."""

import math
from typing import Final

import numpy as np

from common.body.body import Vector
from common.bus.message_codec import unpack
from common.bus.messages import Pixel, Report
from common.raster.kernel import NEAREST_M
from common.rig.camera import Camera, Rig, as_paper_rig, centre, project, ray
from integrator.pairing import Seen
from integrator.rig.perspective import ground_position, px_per_m, scaling_factors, triangulate

Roots = tuple[Pixel | None, Pixel | None]

AHEAD_M: Final = 4.0
"""Depth of somebody whom one view alone shows, where the place before is not before its camera: the
paper's cameras stand about so far away."""


def roots_of(seen: Seen) -> Roots:
    """Where each view has the navel, as searched for, or else its silhouette's middle."""
    first, second = (None if report is None else _root_px(report) for report in seen)
    return first, second


def _root_px(report: Report) -> Pixel:
    if report.root_px is not None:
        return report.root_px
    assert report.box is not None
    columns = np.flatnonzero(unpack(report).ravel()) % report.width
    return float(columns.mean()) + 0.5, (report.box.top + report.box.bottom + 1) / 2


def place_of(rig: Rig, roots_px: Roots, before_m: Vector, facade: int) -> Vector:
    """The navel in the world, (3,), metres, from its pixels in one or both views.

    In a rig of the paper's kind X and Z come from the two columns (Eq. 3) and Y from the row of
    the facade view (P50); in any other from the point nearest to both rays. One view alone
    keeps the depth that the body had before, and so does the facade view where both cannot mean
    the same person: their rays meet in no place before both cameras.

    Args:
        rig: Two cameras.
        roots_px: Of each view; None where it has none.
        before_m: Where the navel was, (3,).
        facade: 0 or 1: which view sees the facade.
    """
    first, second = roots_px
    if first is not None and second is not None:
        place = _where_rays_meet(rig, (first, second), facade)
        if np.isfinite(scales_at(rig, place)).all():
            return place
    believed = facade if roots_px[facade] is not None else 1 - facade
    pixel = roots_px[believed]
    assert pixel is not None
    return _at_depth(rig.cameras[believed], pixel, before_m)


def _where_rays_meet(rig: Rig, roots_px: tuple[Pixel, Pixel], facade: int) -> Vector:
    first, second = roots_px
    paper = as_paper_rig(rig)
    if paper is None:
        return triangulate((rig.cameras[0], rig.cameras[1]), (first, second))
    x_m, z_m = ground_position(
        first[0] - rig.cameras[0].K[0][2], second[0] - rig.cameras[1].K[0][2], paper
    )
    camera, row = rig.cameras[facade], roots_px[facade][1]
    scale = px_per_m(camera, np.array([x_m, 0.0, z_m]))
    return np.array([x_m, centre(camera)[1] - (row - camera.K[1][2]) / scale, z_m])


def scales_at(rig: Rig, place_m: Vector) -> tuple[float, float]:
    """Size of a metre at a place, in each picture, pixels; NaN where it is behind the camera."""
    first, second = (px_per_m(camera, place_m) for camera in rig.cameras)
    return first, second


def scales_since(rig: Rig, place_m: Vector, measured_at_m: Vector) -> tuple[float, float]:
    """The same by the perspective scaling factors since the body was measured (P45).

    In a rig of the paper's kind: the scale where the BDPs were taken, times r_t1 and r_t2.
    """
    paper = as_paper_rig(rig)
    if paper is None:
        return scales_at(rig, place_m)
    factors = scaling_factors(
        (float(place_m[0]), float(place_m[2])),
        (float(measured_at_m[0]), float(measured_at_m[2])),
        paper,
    )
    reference = scales_at(rig, measured_at_m)
    return reference[0] * factors[0], reference[1] * factors[1]


def pixels_of(rig: Rig, place_m: Vector) -> tuple[Pixel, Pixel]:
    """Where both views show a place; the picture's centre where one cannot."""
    found: list[Pixel] = []
    for camera in rig.cameras:
        u, v = project(camera, place_m[None])[0].tolist()
        seen = math.isfinite(u) and math.isfinite(v)
        found.append((u, v) if seen else (rig.width / 2, rig.height / 2))
    return found[0], found[1]


def _at_depth(camera: Camera, pixel: Pixel, before_m: Vector) -> Vector:
    """The point that a pixel shows at the depth of another point, if that is before the camera."""
    forward = np.array(camera.R)[2]
    depth = float(forward @ (before_m - centre(camera)))
    if depth < NEAREST_M:
        depth = AHEAD_M
    direction = ray(camera, pixel)
    point: Vector = centre(camera) + direction * (depth / float(forward @ direction))
    return point
