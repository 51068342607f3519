"""The body's place, its scale there and its facing in each view (sections 4.2 and 4.4)."""

import math
from typing import Final

import numpy as np

from common.body.body import POSE_INDEX, Floats, Vector
from common.body.observation import Facing, Observation, Pixel
from common.bus.instant import Seen
from common.compiled import compiled
from common.raster.kernel import NEAREST_M
from common.raster.silhouette_report import unpack
from common.rig.camera import Camera, PaperRig, Rig, as_paper_rig, centre, project, px_per_m, ray

Roots = tuple[Pixel | None, Pixel | None]

AHEAD_M: Final = 4.0
"""Depth of a person in a single view, metres, where the previous place is not in front of its
camera: the usual distance of the paper's cameras."""
UP_AXIS: Final = np.array([0.0, 1.0, 0.0])
MOST_ASIDE: Final = 0.5
"""Smallest cosine between both views' directions at which the second still measures the flank.
At 60 degrees trunks of `thesis_bdp` appear 1.2 times too deep, at 45 degrees 1.4 times."""
PARALLEL: Final = 1e-9
"""Squared sine of the angle between two rays below which they count as parallel."""


def roots_of(seen: Seen) -> Roots:
    """The navel in each view, as searched for, or else the middle of its silhouette."""
    first, second = (None if person is None else _root_px(person) for person in seen)
    return first, second


def _root_px(person: Observation) -> Pixel:
    if person.search is not None:
        return person.search.root_px
    columns = np.flatnonzero(unpack(person).ravel()) % person.width
    return float(columns.mean()) + 0.5, (person.box.top + person.box.bottom + 1) / 2


def place_of(rig: Rig, roots_px: Roots, before_m: Vector, facade: int) -> Vector:
    """The navel in the world, (3,), metres, from its pixels in one or both views.

    In a rig of the paper's kind X and Z come from the two columns (Eq. 3) and Y from the row of the
    facade view (P50); in any other the place is the point nearest to both rays. A single view keeps
    the body's previous depth, and so does the facade view where the rays of both cannot belong to
    one person: they do not meet in front of both cameras.

    Args:
        rig: Two cameras.
        roots_px: The navel in each view; None where it has none.
        before_m: Previous place of the navel, (3,).
        facade: 0 or 1: which view sees the facade.

    Raises:
        ValueError: When neither view has it.
    """
    first, second = roots_px
    if first is not None and second is not None:
        place = _where_rays_meet(rig, (first, second), facade)
        if np.isfinite(scales_at(rig, place)).all():
            return place
    for believed in (facade, 1 - facade):
        if (pixel := roots_px[believed]) is not None:
            return _at_depth(rig.cameras[believed], pixel, before_m)
    raise ValueError("no view has the navel")


def upright_place_of(rig: Rig, root_px: Pixel, above_px: Pixel) -> Vector:
    """The navel of an upright person, (3,), metres, where view 2 shows only the vertical line that
    it is on.

    In a rig of the paper's kind it comes from the two columns, as in `place_of`. In any other it is
    the intersection of view 1's ray with the vertical plane of view 2's; NaN where the ray lies in
    that plane.

    Args:
        rig: Two cameras.
        root_px: The navel in view 1.
        above_px: Any point vertically above or below it in view 2.
    """
    if as_paper_rig(rig) is not None:
        return place_of(rig, (root_px, above_px), np.zeros(3), 0)
    first, second = rig.cameras
    along, normal = ray(first, root_px), np.cross(ray(second, above_px), UP_AXIS)
    nears = float(normal @ along)
    if nears**2 < PARALLEL:
        return np.full(3, np.nan)
    far_m = float(normal @ (centre(second) - centre(first))) / nears
    place: Vector = centre(first) + far_m * along
    return place


def sees_flank(rig: Rig, place_m: Vector) -> bool:
    """Whether view 2 sees the side of a person who faces view 1, about as the paper's does."""
    one, other = ((centre(camera) - place_m)[[0, 2]] for camera in rig.cameras)
    return abs(float(one @ other)) <= MOST_ASIDE * float(
        np.linalg.norm(one) * np.linalg.norm(other)
    )


def _where_rays_meet(rig: Rig, roots_px: tuple[Pixel, Pixel], facade: int) -> Vector:
    first, second = roots_px
    paper = as_paper_rig(rig)
    if paper is None:
        return triangulate((rig.cameras[0], rig.cameras[1]), (first, second))
    x_m, z_m = ground_position(
        first[0] - rig.cameras[0].K[0][2], second[0] - rig.cameras[1].K[0][2], paper
    )
    below_m = np.array([x_m, 0.0, z_m])
    seen_m = _at_depth(rig.cameras[facade], roots_px[facade], below_m)
    return np.array([x_m, seen_m[1], z_m])


def scales_at(rig: Rig, place_m: Vector) -> tuple[float, ...]:
    """Pixels per metre at a place, in each picture; NaN where it is behind the camera."""
    return tuple(px_per_m(camera, place_m) for camera in rig.cameras)


def scales_since(rig: Rig, place_m: Vector, measured_at_m: Vector) -> tuple[float, ...]:
    """The same by the perspective scaling factors since the body was measured (P45).

    In a rig of the paper's kind: the scale where the BDPs were measured, times r_t1 and r_t2.
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


def pixels_of(rig: Rig, place_m: Vector) -> tuple[Pixel, ...]:
    """Pixels of a place in each view; the picture's centre where it is not visible."""
    found: list[Pixel] = []
    for camera in rig.cameras:
        u, v = project(camera, place_m[None])[0].tolist()
        seen = math.isfinite(u) and math.isfinite(v)
        found.append((u, v) if seen else (rig.width / 2, rig.height / 2))
    return tuple(found)


def _at_depth(camera: Camera, pixel: Pixel, before_m: Vector) -> Vector:
    """The point on a pixel's ray at the depth of another point, if that is in front of the
    camera."""
    forward = np.array(camera.R)[2]
    depth = float(forward @ (before_m - centre(camera)))
    if depth < NEAREST_M:
        depth = AHEAD_M
    direction = ray(camera, pixel)
    point: Vector = centre(camera) + direction * (depth / float(forward @ direction))
    return point


def facing_of(rig: Rig, pose: Vector) -> tuple[Facing, ...]:
    """The facing in each view of a known pose. Each view is compared with the mean of the most
    and the least frontal one: a more frontal view sees the facade."""
    yaw = math.radians(pose[POSE_INDEX["torso_y"]])
    shares = []
    for camera in rig.cameras:
        x, _, z = (centre(camera) - pose[:3]).tolist()
        shares.append(abs(math.sin(yaw) * x + math.cos(yaw) * z) / math.hypot(x, z))
    most, midway = max(shares), (max(shares) + min(shares)) / 2
    facade = shares.index(most)
    return tuple(
        "facade" if view == facade or share > midway else "flank"
        for view, share in enumerate(shares)
    )


def ground_position(x1_px: float, z2_px: float, rig: PaperRig) -> tuple[float, float]:
    """D_X and D_Z of the point that both cameras of the paper's rig see, metres.

    The two lines x1 = lambda1 X / (Zc1 - Z) and z2 = lambda2 Z / (X - Xc2), solved. The printed
    form divides by x1 and z2, so it is 0/0 where the body starts; this form is exact everywhere in
    view.

    Args:
        x1_px: Column in picture 1, from the centre column, right positive.
        z2_px: Column in picture 2, from the centre column, right positive.
        rig: Focal lengths and distances.

    Source: eq. (3), with Xc2 for the printed x_c2 (P44, M3, M4).
    """
    focals = rig.focal_1_px * rig.focal_2_px
    shared = focals + x1_px * z2_px
    d_x = x1_px * (rig.distance_1_m * rig.focal_2_px - z2_px * rig.distance_2_m) / shared
    d_z = z2_px * (x1_px * rig.distance_1_m + rig.distance_2_m * rig.focal_1_px) / shared
    return d_x, d_z


def scaling_factors(
    position_m: tuple[float, float], measured_at_m: tuple[float, float], rig: PaperRig
) -> tuple[float, float]:
    """r_t1 and r_t2: size in each picture over the size where the BDPs were measured.

    The ratio of depths, to which eq. (4) reduces when its reference lies on the axes; off the axes
    eq. (4) has an error of some percent (3 % at 1 m), so it is not used.

    Args:
        position_m: (X, Z) of the body now.
        measured_at_m: (X0, Z0) of the body when the BDPs were measured.
        rig: Focal lengths and distances.

    Source: eq. (4) as P45 and M5 read it.
    """
    (x, z), (x0, z0) = position_m, measured_at_m
    return (
        (rig.distance_1_m - z0) / (rig.distance_1_m - z),
        (x0 + rig.distance_2_m) / (x + rig.distance_2_m),
    )


def triangulate(cameras: tuple[Camera, Camera], pixels: tuple[Pixel, Pixel]) -> Vector:
    """The point nearest to both rays (least squares), shape (3,), world metres.

    It is eq. (3) for cameras in any arrangement: the middle of the shortest line between the rays.
    NaN where these are parallel.
    """
    first, second = (ray(camera, pixel) for camera, pixel in zip(cameras, pixels, strict=True))
    middle: Vector = _meeting(centre(cameras[0]), first, centre(cameras[1]), second)
    return middle


@compiled
def _meeting(one: Vector, first: Vector, other: Vector, second: Vector) -> Floats:
    """The middle of the shortest line between two rays, from their starts and directions (3,)."""
    cosine = along = across = 0.0
    for i in range(3):
        cosine += first[i] * second[i]
        along += first[i] * (one[i] - other[i])
        across += second[i] * (one[i] - other[i])
    sine_squared = 1.0 - cosine * cosine
    if sine_squared < PARALLEL:
        return np.full(3, np.nan)
    far_first = (cosine * across - along) / sine_squared
    far_second = (across - cosine * along) / sine_squared
    return (one + first * far_first + other + second * far_second) / 2
