"""A rig from videos of a board, and its quality."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from calibration.board.board import Board, corner_places
from calibration.board.board_fit import Fit, Sight, Start, fitted_to, start_of, weighed
from calibration.board.board_floor import Floor, floor_of, world_cameras
from calibration.board.board_quality import Quality, miss_px_of, quality_of
from calibration.board.lens_start import Lens, Place, between, lens_of
from calibration.board.still_board import (
    BoardVideo,
    Chosen,
    Moments,
    moments_of,
    only,
    rests_of,
    seen_by,
    spread_moments,
)
from calibration.foreign.foreign_camera import ForeignCamera, our_rig
from common.body.body import Vector
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError

LEAST_RESTS: Final = 8
"""Fewest rests of one camera."""
LEAST_SHARED: Final = 4
"""Fewest rests that two cameras share."""
MOST_RESTS: Final = 80
"""Most rests that are used: more add little."""
LAST_RESTS: Final = 12
"""Number of last rests that are always kept: the board is laid on the floor at the end."""
ASTRAY: Final = 3.0
"""Error of a sight, in medians of all, above which it is dropped if it exceeds ASTRAY_PX too."""
ASTRAY_PX: Final = 0.5
POOR_PX: Final = 1.5
"""Mean error of the corners, pixels, above which the board is probably not the one that was
named."""
APART: Final = 0.02
"""Error of the board's corners, in picture widths, above which two cameras probably did not look
at the same moments."""


class BoardCalibration(NamedTuple):
    """A rig from videos of a board, and its quality."""

    rig: Rig
    quality: Quality
    moments: Moments
    """Times of the rests that the rig was computed from."""


def calibrated_by_board(
    films: Sequence[BoardVideo], board: Board, floor_s: float | None = None
) -> BoardCalibration:
    """The rig of the cameras that recorded a board.

    Args:
        films: One per camera, all of one picture size.
        board: The board in the videos.
        floor_s: Time at which the board lies on the floor, by the first video; None: found
            automatically.

    Raises:
        CalibrationError: It names the video, what it lacks, and the cure.
    """
    places, size_px = corner_places(board), films[0].size_px
    rests = [rests_of(film) for film in films]
    for film, some in zip(films, rests, strict=True):
        _refuse_few(film, len(some))
    told = moments_of(rests)
    moments = spread_moments(told, MOST_RESTS, _late(told, floor_s))
    lenses = [lens_of(places, moments.px[:, n], size_px) for n in range(len(films))]
    cameras = _related(films, lenses, moments, places)
    start = start_of(lenses, cameras, len(moments.px))
    fit, sights, moments = _fit(moments, places, start, size_px)
    for n, film in enumerate(films):
        _refuse_poor(film, miss_px_of(fit, sights, n))
    floor = floor_of(fit.boards, fit.cameras, places, _resting(moments, floor_s))
    quality = quality_of(fit, sights, moments, floor, size_px)
    return BoardCalibration(_rig(fit, floor, size_px), quality, moments)


def _related(
    films: Sequence[BoardVideo], lenses: Sequence[Lens], moments: Moments, places: Vector
) -> list[Place]:
    """From the first camera's axes to each camera's."""
    shared, width_px = seen_by(moments), films[0].size_px[0]
    cameras = [Place(np.zeros(3), np.zeros(3))]
    for n, film in enumerate(films[1:], start=1):
        both = int((shared[:, 0] & shared[:, n]).sum())
        if both < LEAST_SHARED:
            raise CalibrationError(
                f"{films[0].name} and {film.name} show the board at rest together {both} times, "
                f"{LEAST_SHARED} or more are needed: hold it for two seconds where both see it, "
                "and begin both videos within half a second"
            )
        place, off_px = between(lenses[0], lenses[n], places, moments.px[:, n])
        if off_px > APART * width_px:
            raise CalibrationError(
                f"{film.name} does not show the moments that {films[0].name} shows ({off_px:.0f} "
                "px apart): begin both videos within half a second, and move no camera"
            )
        cameras.append(place)
    return cameras


def _refuse_few(film: BoardVideo, rests: int) -> None:
    if rests < LEAST_RESTS:
        raise CalibrationError(
            f"{film.name} shows the board in {len(film.time_s)} of the pictures that were looked "
            f"at and at rest {rests} times, {LEAST_RESTS} or more are needed: hold it for two "
            "seconds each at other places, near and far, turned to all sides"
        )


def _refuse_poor(film: BoardVideo, miss_px: float) -> None:
    if miss_px > POOR_PX:
        raise CalibrationError(
            f"the corners in {film.name} miss the board by {miss_px:.1f} px: it must be flat, "
            "stiff and the one that is named (--chessboard), and the camera must keep its zoom"
        )


def _late(moments: Moments, floor_s: float | None) -> Chosen:
    """Whether the board may lie on the floor: at the given time, or among the last rests."""
    at = np.arange(len(moments.px)) >= len(moments.px) - LAST_RESTS
    if floor_s is not None:
        at |= (moments.begin_s <= floor_s) & (floor_s <= moments.end_s)
    return at


def _fit(
    moments: Moments, places: Vector, start: Start, size_px: tuple[int, int]
) -> tuple[Fit, list[Sight], Moments]:
    """Fit twice: the second time without outlying sights, and with each sight's own deviation."""
    sights = _sights(moments, places)
    fit = fitted_to(sights, start, size_px)
    off_px = np.array([np.sqrt(np.mean(np.sum(miss**2, axis=1))) for miss in fit.misses_px])
    good = off_px <= max(ASTRAY * float(np.median(off_px)), ASTRAY_PX)
    px = moments.px.copy()
    for sight, well in zip(sights, good, strict=True):
        if not well:
            px[sight.rest, sight.camera] = np.nan
    left = np.flatnonzero(np.isfinite(px[..., 0]).any(axis=(1, 2)))
    moments = only(moments._replace(px=px), left)
    kept = [
        weighed(sight, miss)._replace(rest=int(np.searchsorted(left, sight.rest)))
        for sight, miss, well in zip(sights, fit.misses_px, good, strict=True)
        if well
    ]
    again = Start(fit.lenses, fit.cameras, tuple(fit.boards[n] for n in left))
    return fitted_to(kept, again, size_px), kept, moments


def _sights(moments: Moments, places: Vector) -> list[Sight]:
    sights = []
    for rest, camera in np.argwhere(seen_by(moments)).tolist():
        seen = np.isfinite(moments.px[rest, camera, :, 0])
        sights.append(Sight(camera, rest, places[seen], moments.px[rest, camera][seen]))
    return sights


def _resting(moments: Moments, floor_s: float | None) -> int | None:
    """The rest at a time of the first video."""
    if floor_s is None:
        return None
    at = np.flatnonzero((moments.begin_s <= floor_s) & (floor_s <= moments.end_s))
    if not len(at):
        raise CalibrationError(
            f"the board is not at rest at --floor {floor_s:g}: it is from "
            f"{', '.join(f'{begin:.1f}' for begin in moments.begin_s[-5:])} s on, and before"
        )
    return int(at[-1])


def _rig(fit: Fit, floor: Floor, size_px: tuple[int, int]) -> Rig:
    cameras = []
    for n, (R, t) in enumerate(world_cameras(fit.cameras, floor)):
        fx, fy, cx, cy, k1, k2 = fit.lenses[n].tolist()
        K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
        cameras.append(ForeignCamera(f"cam{n + 1}", size_px, K, R, t, (k1, k2, 0.0, 0.0)))
    return our_rig(cameras, "the board's rig", "y")
