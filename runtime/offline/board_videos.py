"""Videos of a printed board, searched for its corners."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np
from rich.progress import Progress

from calibration.board.board import BOARDS, Board
from calibration.board.board_corners import corners_in
from calibration.board.still_board import BoardVideo
from common.rig.rig_file import CalibrationError
from common.video.decoding import Decoder
from common.video.frame_times import timed
from common.video.pictures import Decoded, Image, Size, VideoInfo, Wanted
from runtime.terminal import Tell, by_share

LOOKS_HZ: Final = 5.0
"""Number of examined pictures per second."""
USUAL_HZ: Final = 30.0
"""Frame rate of a video that reports none."""
WIDEST_PX: Final = 1920
"""Width to which wider pictures are reduced, pixels: larger ones give no better corners, and
take long."""


MIRROR: Final = (
    "it is read in the mirror image alone: switch mirroring off in the camera's own program or "
    "driver, and record it again"
)
"""What to do where the picture is mirrored."""


class Looked(NamedTuple):
    """The corners found in a video."""

    film: BoardVideo
    board: Board
    picture: Image
    """Its first picture."""


def looked_through(
    videos: Sequence[str], boards: Sequence[Board], progress: Progress
) -> list[Looked]:
    """The videos of a board, one per camera.

    Args:
        videos: Their files.
        boards: Candidates for the board in them.
        progress: Receives the progress.

    Raises:
        CalibrationError: When one shows no board, or another board than the first, or has pictures
            of another size.
        Undecodable, DecoderDied: When one cannot be read.
    """
    found: list[Looked] = []
    with Decoder() as decoder:
        for video, tell in by_share(progress, videos, "looking for the board"):
            found.append(_looked(decoder, video, boards, tell))
            _refuse_another(found[0], found[-1])
    return found


def _looked(decoder: Decoder, video: str, boards: Sequence[Board], tell: Tell) -> Looked:
    info = timed(decoder.probe(video))
    rate_hz = info.fps if info.fps > 0 else USUAL_HZ
    size, every = _reduced(info), max(1, round(rate_hz / LOOKS_HZ))
    times, px, first, board = [], [], None, None
    for shown in decoder.frames(video, size, Wanted(every)):
        first = shown.picture if first is None else first
        for one in boards if board is None else (board,):
            corners = corners_in(shown.picture, one)
            if corners is not None:
                board = one
                px.append((corners + 0.5) * info.width / size[0] - 0.5)
                times.append(_time_s(shown, info, rate_hz))
                break
        tell(min(1.0, shown.index / max(info.frames, 1)))
    if board is None or first is None:
        mirrored = _is_mirrored(decoder, video, size, every, boards)
        raise CalibrationError(
            f"no board is found in {video}: {MIRROR if mirrored else _cure(boards)}"
        )
    return Looked(
        BoardVideo(video, (info.width, info.height), np.array(times), np.array(px)), board, first
    )


def _is_mirrored(
    decoder: Decoder, video: str, size: Size, every: int, boards: Sequence[Board]
) -> bool:
    """Whether a board can be read in the mirror image of a video; a chessboard is the same."""
    marked = [board for board in boards if board.first_marker is not None]
    return any(
        corners_in(cv2.flip(shown.picture, 1), board) is not None
        for shown in decoder.frames(video, size, Wanted(every))
        for board in marked
    )


def _reduced(info: VideoInfo) -> Size:
    scale = min(1.0, WIDEST_PX / info.width)
    return round(info.width * scale), round(info.height * scale)


def _time_s(shown: Decoded, info: VideoInfo, rate_hz: float) -> float:
    if shown.index < len(info.shown_s):
        return info.shown_s[shown.index]
    return shown.index / rate_hz


def _cure(boards: Sequence[Board]) -> str:
    if boards[0].first_marker is None:
        return (
            f"a chessboard of {boards[0].columns}x{boards[0].rows} squares must be seen whole, its "
            "white rim too; all squares are counted, not the corners between them"
        )
    return (
        "print one (--print board.pdf) and hold it nearer, in good light: a square must be some 15 "
        "pixels wide; for a chessboard say --chessboard 9x6"
    )


def _refuse_another(first: Looked, other: Looked) -> None:
    one, two = first.film, other.film
    if one.size_px != two.size_px:
        sizes = [f"{width}x{height}" for width, height in (one.size_px, two.size_px)]
        raise CalibrationError(
            f"{two.name} has pictures of {sizes[1]}, {one.name} of {sizes[0]}: record both alike"
        )
    if first.board != other.board:
        names = {board: paper.upper() for paper, board in BOARDS.items()}
        raise CalibrationError(
            f"{two.name} shows the board of {names.get(other.board, 'another kind')}, {one.name} "
            f"that of {names.get(first.board, 'another kind')}: use one for both"
        )
