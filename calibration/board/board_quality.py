"""Quality of a calibration with a board."""

from collections.abc import Sequence

import msgspec
import numpy as np

from calibration.board.board_coverage import covered
from calibration.board.board_fit import Fit, Sight
from calibration.board.board_floor import Floor
from calibration.board.still_board import Moments, seen_by


class CameraQuality(msgspec.Struct, frozen=True):
    """One camera's quality."""

    name: str
    focal_px: float
    focal_error_px: float
    """Standard deviation of the focal length."""
    k1: float
    k2: float
    reprojection_px: float
    """Root mean square of the reprojection errors."""
    rests: int
    """Number of rests at which it showed the board."""
    coverage: float
    """Share of its picture in which the board was seen."""


class Quality(msgspec.Struct, frozen=True):
    """Quality of a calibration with a board."""

    cameras: tuple[CameraQuality, ...]
    reprojection_px: float
    shared_rests: int
    """Number of rests at which two cameras or more showed the board."""
    floor_s: float
    """Times at which the board lay on the floor, by the first video."""
    floor_rests: int
    """Number of those rests."""


def quality_of(
    fit: Fit, sights: list[Sight], moments: Moments, floor: Floor, size_px: tuple[int, int]
) -> Quality:
    """Quality of each camera of a fit."""
    seen = seen_by(moments)
    cameras = []
    for n, lens in enumerate(fit.lenses):
        cells = covered(moments.px[:, n], size_px)
        cameras.append(
            CameraQuality(
                f"cam{n + 1}",
                float(lens[0]),
                float(fit.focal_error_px[n]),
                float(lens[4]),
                float(lens[5]),
                miss_px_of(fit, sights, n),
                int(seen[:, n].sum()),
                float((cells > 0).mean()),
            )
        )
    squares = np.concatenate([np.sum(miss**2, axis=1) for miss in fit.misses_px])
    return Quality(
        tuple(cameras),
        float(np.sqrt(squares.mean())),
        int((seen.sum(axis=1) > 1).sum()),
        float(moments.begin_s[floor.rests[-1]]),
        len(floor.rests),
    )


def miss_px_of(fit: Fit, sights: Sequence[Sight], camera: int) -> float:
    """Root mean square of one camera's reprojection errors."""
    off = [
        np.sum(miss**2, axis=1)
        for sight, miss in zip(sights, fit.misses_px, strict=True)
        if sight.camera == camera
    ]
    return float(np.sqrt(np.mean(np.concatenate(off))))
