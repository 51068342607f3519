"""Poles as a calibrated camera should show them."""

import numpy as np

from calibration.paper.poles import CameraQuality, Poles
from common.body.body import Vector


def drawn_poles(measured: Poles, number: int, known: CameraQuality) -> Vector:
    """Top and foot of every pole in the picture of camera 1 or 2, seen or not.

    The axis lies where the poles put it (`off_centre_px`), so `misfit_px` is the root mean square
    of the tops' distances.

    Returns:
        (n, 2, 2): pole; top, foot; column, row, pixels. NaN behind the camera.
    """
    places = np.array([(pole.x_m, pole.z_m) for pole in measured.poles]).reshape(-1, 2)
    across_m = places[:, 0] if number == 1 else places[:, 1]
    towards_m = places[:, 1] if number == 1 else -places[:, 0]
    depth_m = known.distance_m - towards_m
    px_per_m = known.focal_px / np.where(depth_m > 0, depth_m, np.nan)
    columns = measured.width / 2 + known.off_centre_px + px_per_m * across_m
    above_m = np.array([measured.pole_height_m, 0.0]) - known.height_m
    rows = measured.height / 2 - px_per_m[:, None] * above_m
    drawn: Vector = np.stack([np.broadcast_to(columns[:, None], rows.shape), rows], axis=-1)
    return drawn
