"""Where the body is and how large it is seen there: two rays, one place (section 4.2)."""

from typing import Any, Final

import msgspec
import numpy as np

from common.body.body import Bdp, Vector
from common.bus.messages import Measure, Pixel
from common.compiled import compiled
from common.rig.camera import Camera, PaperRig, arrays_of, centre, ray

PARALLEL: Final = 1e-9
"""Two rays whose directions span less than this (sine squared of their angle) never meet."""


def ground_position(x1_px: float, z2_px: float, rig: PaperRig) -> tuple[float, float]:
    """D_X and D_Z of the point that both cameras of the paper's rig see, metres.

    The two lines x1 = lambda1 X / (Zc1 - Z) and z2 = lambda2 Z / (X - Xc2), solved. The printed
    form divides by x1 and z2, so it is 0/0 where the body starts; cleared of them it is exact
    everywhere in view.

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

    The ratio of depths, which is what eq. (4) comes to when its reference lies on the axes; off
    them eq. (4) is some percent wrong (3 % at 1 m), so it is not used.

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

    It is eq. (3) for cameras that stand anywhere: the middle of the shortest line between the
    rays. NaN where these are parallel.
    """
    first, second = (ray(camera, pixel) for camera, pixel in zip(cameras, pixels, strict=True))
    middle: Vector = _meeting(centre(cameras[0]), first, centre(cameras[1]), second)
    return middle


@compiled
def _meeting(one: Any, first: Any, other: Any, second: Any) -> Any:
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


def px_per_m(camera: Camera, point_m: Vector) -> float:
    """How many pixels a metre across the line of sight takes at a point: focal length / depth.

    NaN where the point is not in front of the camera.
    """
    depth_m = float(arrays_of(camera).R[2] @ np.asarray(point_m) + camera.t[2])
    return camera.K[0][0] / depth_m if depth_m > 0 else float("nan")


def universal_bdp(front: Measure, side: Measure, px_per_m_1: float) -> Bdp:
    """Both views' measures of the opening posture as one body, metres.

    Viewer 2's trunk depth comes into viewer 1's scale by r_t = t2 / t1, the ratio of the
    silhouettes' heights: SR_torso,u = SR_torso,2 / r_t. The rest is viewer 1's.

    Args:
        front: Viewer 1's measure, with BDPs.
        side: Viewer 2's measure.
        px_per_m_1: Size of a metre at the body in picture 1.

    Raises:
        ValueError: When `front` saw no facade and so has no BDPs.

    Source: section 4.2 (P46).
    """
    if front.bdp_px is None:
        raise ValueError("viewer 1 measured no BDPs: it did not see the facade")
    r_t = side.height_px / front.height_px
    torso = msgspec.structs.replace(front.bdp_px.torso, short_radius=side.depth_px / r_t)
    return msgspec.structs.replace(front.bdp_px, torso=torso).scaled(1 / px_per_m_1)
