"""From videos of a printed board to `calibration.json` and a picture of the covered area."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

import cv2
from rich.console import Console

from calibration.board.board import BOARDS, Board, chessboard
from calibration.board.board_coverage import coverage_picture, covered
from calibration.board.board_quality import Quality
from calibration.board.board_rig import calibrated_by_board
from calibration.paper.calibration import write_rig
from common.atomic_file import replacing
from common.rig.rig_file import CalibrationError
from runtime.offline.board_videos import looked_through
from runtime.terminal import bar, warn

UNCOVERED: Final = 0.4
"""Share of a picture covered by the board, below which its lens is uncertain at the border."""


class Shown(NamedTuple):
    """The user's options for the videos."""

    square_mm: float | None = None
    """Side of a square as measured; None: as printed."""
    chessboard: str | None = None
    """Number of squares, columns x rows; None: one of our boards."""
    floor_s: float | None = None
    """When it lies on the floor; None: found automatically."""


def calibrate_by_videos(
    videos: Sequence[Path], shown: Shown, out: Path, console: Console
) -> tuple[Quality, Path]:
    """Calibrate, write the rig with its quality, and beside it a picture of the covered area.

    Returns:
        The quality, and the file of the picture.

    Raises:
        CalibrationError: When the videos do not suffice, or a file cannot be written.
        Undecodable, DecoderDied: When a video cannot be read.
    """
    with bar(console) as progress:
        looked = looked_through([str(path) for path in videos], _boards(shown), progress)
    board = looked[0].board
    if shown.square_mm is not None:
        board = board._replace(square_m=shown.square_mm / 1e3)
    found = calibrated_by_board([one.film for one in looked], board, shown.floor_s)
    write_rig(out, found.rig, found.quality)
    drawn = out.with_name(f"{out.stem}_coverage.png")
    cells = [covered(found.moments.px[:, n], one.film.size_px) for n, one in enumerate(looked)]
    picture = coverage_picture([one.picture for one in looked], cells)
    _write(drawn, cv2.imencode(".png", picture)[1].tobytes())
    for camera in found.quality.cameras:
        if camera.coverage < UNCOVERED:
            warn(
                console,
                f"the board covered {camera.coverage:.0%} of the picture of {camera.name}: its "
                f"lens is guessed elsewhere; hold it there too ({drawn})",
            )
    return found.quality, drawn


def _boards(shown: Shown) -> tuple[Board, ...]:
    if shown.chessboard is None:
        return tuple(BOARDS.values())
    if shown.square_mm is None:
        raise CalibrationError("measure a square of the chessboard and say it: --square MM")
    return (chessboard(shown.chessboard, shown.square_mm / 1e3),)


def _write(path: Path, content: bytes) -> None:
    try:
        with replacing(path) as new:
            new.write_bytes(content)
    except OSError as error:
        raise CalibrationError(f"cannot write {path}: {error.strerror}") from error
