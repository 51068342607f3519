"""Camera positions and focal lengths, from the tops of poles (section 4.1)."""

from typing import Annotated, Final, NamedTuple

import msgspec
import numpy as np

from common.body.body import Vector
from common.body.observation import Pixel
from common.rig.camera import Rig, paper_rig
from common.rig.rig_file import CalibrationError

Positive = Annotated[float, msgspec.Meta(gt=0)]
PositiveCount = Annotated[int, msgspec.Meta(gt=0)]

READING_SD_PX: Final = 0.5 / 3**0.5
"""Standard deviation of a position that is read to the pixel: uniform within +-0.5 px."""
TAPE_SD_M: Final = 0.01
"""Standard deviation of a tape-measured distance to a lens, metres."""
ROUNDS: Final = 20
"""Gauss-Newton converges within five or never."""
SINGULAR: Final = 1e-9
"""Ratio of least to greatest singular value below which the poles leave a number undetermined."""
NEAREST_M: Final = 0.01
"""Smallest distance of a pole from a lens, metres; a nearer one, or one behind it, cannot be
seen."""
LENGTHS_M: Final = {
    "pole_height_m": (0.2, 10.0),
    "distance_1_m": (0.2, 50.0),
    "distance_2_m": (0.2, 50.0),
}
"""Bounds of a length, metres: beyond them the user probably means centimetres."""
FARTHEST_M: Final = 50.0
"""Bound of a pole's distance from the origin along either axis, metres."""


class Pole(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A pole on the floor, and its top in each camera's picture; None where it is not visible."""

    x_m: float
    z_m: float
    cam1_px: Pixel | None = None
    cam2_px: Pixel | None = None


class Poles(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A file of poles: the centre of the top-left pixel is (0.5, 0.5)."""

    width: PositiveCount
    height: PositiveCount
    pole_height_m: Positive
    poles: tuple[Pole, ...]
    distance_1_m: Positive | None = None
    """Zc1 by tape: from the origin's vertical to the lens of camera 1."""
    distance_2_m: Positive | None = None
    """-Xc2 by tape."""


class CameraQuality(msgspec.Struct, frozen=True, kw_only=True):
    """One camera's numbers from the poles, each with one standard deviation."""

    name: str
    focal_px: float
    focal_sd_px: float
    distance_m: float
    distance_sd_m: float
    height_m: float
    """Height of the lens, relative to the poles' height."""
    off_centre_px: float
    """Column of the camera's axis, from the centre column: 0 where the aim follows the markers."""
    misfit_px: float
    """Root mean square of the tops' residuals; about 0.3 when they are read to the pixel."""


class Quality(msgspec.Struct, frozen=True):
    """Precision of a rig."""

    cameras: tuple[CameraQuality, ...]


def refuse_other_units(measured: Poles) -> None:
    """Refuse lengths that cannot be metres.

    Raises:
        CalibrationError: When one is out of bounds; it asks whether centimetres were meant.
    """
    for name, (low, high) in LENGTHS_M.items():
        _refuse_beyond(name, getattr(measured, name), low, high)
    for n, pole in enumerate(measured.poles):
        for name in ("x_m", "z_m"):
            _refuse_beyond(f"{name} of pole {n + 1}", getattr(pole, name), -FARTHEST_M, FARTHEST_M)


def _refuse_beyond(name: str, length_m: float | None, low: float, high: float) -> None:
    if length_m is None or low <= length_m <= high:
        return
    meant = f": {length_m / 100:g}?" if low <= length_m / 100 <= high else ""
    raise CalibrationError(
        f"{name} must be from {low:g} to {high:g} metres, got {length_m:g}{meant}"
    )


def poles(measured: Poles) -> tuple[Rig, Quality]:
    """Focal lengths, distances and heights of the paper's two cameras from the tops of poles.

    For poles at A, B and C this is lambda1 = Zc1 (x1C - x1A) / D_X and Zc1 = D_Z t1B / (t1B - t1A),
    and the same for camera 2 (M2, P43). More poles are fitted by least squares. A distance by tape
    is one more observation. The error bars are those of readings to the pixel: with few poles in a
    small picture a distance is hardly known.

    Raises:
        CalibrationError: When the poles do not determine a camera.

    Source: section 4.1 (P43, M2); the conditions of P42 hold (the cameras are level and aimed).
    """
    first, second = (camera_by_poles(measured, number) for number in (1, 2))
    rig = paper_rig(
        (measured.width, measured.height),
        (first.focal_px, second.focal_px),
        (first.distance_m, second.distance_m),
        (first.height_m, second.height_m),
    )
    return rig, Quality((first, second))


def camera_by_poles(measured: Poles, number: int) -> CameraQuality:
    """One of the two cameras (1 or 2), from the poles in its picture.

    Raises:
        CalibrationError: When they do not determine it.
    """
    name = f"cam{number}"
    values, sds, misfit_px = _fit(_tops(measured, number), name)
    distance_m, focal_px, rise, off_centre_px = values
    height_m = measured.pole_height_m - rise / focal_px
    if not (focal_px > 0 and height_m > 0):
        raise CalibrationError(
            f"by these points {name} has a focal length of {focal_px:.0f} px and its lens is at "
            f"{height_m:.2f} m: check pole_height_m, and that columns run right and rows down"
        )
    return CameraQuality(
        name=name,
        focal_px=focal_px,
        focal_sd_px=sds[1],
        distance_m=distance_m,
        distance_sd_m=sds[0],
        height_m=height_m,
        off_centre_px=off_centre_px,
        misfit_px=misfit_px,
    )


class _Tops(NamedTuple):
    """The tops of poles in one camera's picture, and the poles relative to that camera."""

    across_m: Vector
    """Distance to the right of its axis: X for camera 1, Z for camera 2."""
    towards_m: Vector
    """Distance from the origin towards the camera: Z for camera 1, -X for camera 2."""
    columns_px: Vector
    """Column from the centre column, right positive."""
    rows_px: Vector
    """Row from the centre row, up positive."""
    taped_m: float | None


def _tops(measured: Poles, camera: int) -> _Tops:
    rows = []
    for pole in measured.poles:
        pixel = pole.cam1_px if camera == 1 else pole.cam2_px
        place = (pole.x_m, pole.z_m) if camera == 1 else (pole.z_m, -pole.x_m)
        if pixel is not None:
            rows.append((*place, pixel[0] - measured.width / 2, measured.height / 2 - pixel[1]))
    if len(rows) < 2:
        raise CalibrationError(f"cam{camera} shows {len(rows)} poles: two or more are needed")
    taped_m = measured.distance_1_m if camera == 1 else measured.distance_2_m
    across, towards, columns, heights = np.array(rows, np.float64).T
    return _Tops(across, towards, columns, heights, taped_m)


def _fit(tops: _Tops, name: str) -> tuple[list[float], list[float], float]:
    """(distance, focal length, focal length times rise, off-centre), their deviations, the
    misfit."""
    values = _start(tops, name)
    for _ in range(ROUNDS):
        jacobian, residual = _linear(tops, values)
        scale = np.maximum(np.linalg.norm(jacobian, axis=0), SINGULAR)
        spread = np.linalg.svd(jacobian / scale, compute_uv=False)
        if spread[-1] < SINGULAR * spread[0]:
            raise CalibrationError(f"no pole stands off the axis of {name}: add one at its side")
        values = values + np.linalg.lstsq(jacobian, residual)[0]
        if not values[0] > tops.towards_m.max() + NEAREST_M:
            raise _distance_unknown(name)
    jacobian, residual = _linear(tops, values)
    sds = READING_SD_PX * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    misfit_px = float(np.sqrt(np.mean(residual[: 2 * len(tops.rows_px)] ** 2)))
    return values.tolist(), sds.tolist(), misfit_px


def _start(tops: _Tops, name: str) -> Vector:
    """The distance by tape or from the rows; the rest from the columns, given the distance (M2,
    P43)."""
    rows = np.column_stack([tops.rows_px, -np.ones_like(tops.rows_px)])
    by_rows = np.linalg.lstsq(rows, tops.rows_px * tops.towards_m)[0]
    distance_m = by_rows[0] if tops.taped_m is None else tops.taped_m
    if not distance_m > tops.towards_m.max() + NEAREST_M:
        raise _distance_unknown(name)
    near = 1 / (distance_m - tops.towards_m)
    columns = np.column_stack([tops.across_m * near, np.ones_like(near)])
    focal_px, off_centre_px = np.linalg.lstsq(columns, tops.columns_px)[0]
    rise = float(tops.rows_px @ near / (near @ near))
    return np.array([distance_m, focal_px, rise, off_centre_px])


def _linear(tops: _Tops, values: Vector) -> tuple[Vector, Vector]:
    """Jacobian (m, 4) and residual (m,), pixels, of columns, rows and tape at given values."""
    distance_m, focal_px, rise, off_centre_px = values
    near, none = 1 / (distance_m - tops.towards_m), np.zeros_like(tops.across_m)
    bearing = tops.across_m * near
    by_column = np.column_stack([-focal_px * bearing * near, bearing, none, none + 1])
    by_row = np.column_stack([-rise * near**2, none, near, none])
    off_columns = tops.columns_px - focal_px * bearing - off_centre_px
    off_rows = tops.rows_px - rise * near
    if tops.taped_m is None:
        return np.concatenate([by_column, by_row]), np.concatenate([off_columns, off_rows])
    weight = READING_SD_PX / TAPE_SD_M
    by_tape, off_tape = [[weight, 0.0, 0.0, 0.0]], [weight * (tops.taped_m - distance_m)]
    return (
        np.concatenate([by_column, by_row, by_tape]),
        np.concatenate([off_columns, off_rows, off_tape]),
    )


def _distance_unknown(name: str) -> CalibrationError:
    return CalibrationError(
        f"the poles do not show how far {name} stands: put them at two distances from it or more, "
        f"with tops well above its centre row, or give distance_{name[-1]}_m by tape"
    )
