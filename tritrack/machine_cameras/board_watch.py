"""The calibration board before running cameras: found in their pictures, which are kept for it."""

import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

import cv2

from calibration.board.board import BOARDS, Board
from calibration.board.board_corners import corners_in
from calibration.board.board_coverage import tinted
from calibration.board.board_progress import BoardProgress, Sight, init, step
from common.video.pictures import Image

HZ: Final = 5.0
"""Most pictures of each camera that are looked at, and the rate of the kept videos, Hz."""
MOST_PICTURES: Final = 9000
"""Of each camera: half an hour. Then nothing more is looked at."""

PictureOf = Callable[[], Image | None]
"""A camera's newest picture."""


class BoardWatch:
    """Looks for one of our boards in several cameras at once, in a thread, until `close`.

    Args:
        cameras: Each one's newest picture.
        folder: Gets the pictures that were looked at, as cam1.avi and so on; of all cameras one
            picture each at a time.
    """

    def __init__(self, cameras: Sequence[PictureOf], folder: Path) -> None:
        self._cameras, self._folder = tuple(cameras), folder
        self.progress: BoardProgress | None = None
        """None before all cameras gave a picture."""
        self.fault = ""
        self.period_s = 1.0 / HZ
        """Between the last two pictures that were looked at, seconds."""
        self._boards: tuple[Board, ...] = tuple(BOARDS.values())
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="board", daemon=True)
        self._thread.start()

    @property
    def is_over(self) -> bool:
        """Whether it looks no longer."""
        return not self._thread.is_alive()

    @property
    def videos(self) -> tuple[Path, ...]:
        """The kept videos; whole once it is closed."""
        return tuple(self._folder / f"cam{n}.avi" for n in range(1, len(self._cameras) + 1))

    def shown(self, number: int, picture: Image) -> Image:
        """A camera's picture with the parts in which the board was."""
        progress = self.progress
        return picture if progress is None else tinted(picture, progress.cameras[number].cells)

    def close(self) -> None:
        """Stop looking, and close the videos."""
        self._over.set()
        self._thread.join()

    def _run(self) -> None:
        writers: list[cv2.VideoWriter] = []
        before: list[Image] = []
        looked_s = 0.0
        try:
            for _ in range(MOST_PICTURES):
                began_s = time.monotonic()
                pictures = [found for newest in self._cameras if (found := newest()) is not None]
                fresh = len(pictures) == len(self._cameras) and not any(
                    one is other for one, other in zip(pictures, before, strict=False)
                )
                if fresh:
                    self.period_s = began_s - looked_s if before else self.period_s
                    looked_s = began_s
                    writers = writers or self._opened(pictures)
                    self._look(began_s, pictures)
                    for writer, picture in zip(writers, pictures, strict=True):
                        writer.write(picture)
                    before = pictures
                if self._over.wait(max(0.0, began_s + 1.0 / HZ - time.monotonic())):
                    return
        except OSError as error:
            self.fault = str(error)
        finally:
            for writer in writers:
                writer.release()

    def _opened(self, pictures: Sequence[Image]) -> list[cv2.VideoWriter]:
        self.progress = init([(each.shape[1], each.shape[0]) for each in pictures])
        self._folder.mkdir(parents=True, exist_ok=True)
        code, found = cv2.VideoWriter.fourcc(*"MJPG"), []
        for path, each in zip(self.videos, pictures, strict=True):
            size = (each.shape[1], each.shape[0])
            found.append(cv2.VideoWriter(str(path), cv2.CAP_OPENCV_MJPEG, code, HZ, size))
            if not found[-1].isOpened():
                raise OSError(f"cannot write {path}: see that its folder takes files")
        return found

    def _look(self, time_s: float, pictures: Sequence[Image]) -> None:
        """Look for the board; before one was found, for each of ours in turn."""
        assert self.progress is not None
        board = self._boards[0]
        sights = [
            sight_of(picture, board, is_read=seen.poses > 0)
            for picture, seen in zip(pictures, self.progress.cameras, strict=True)
        ]
        if any(sight.px is not None or sight.in_mirror for sight in sights):
            self._boards = (board,)
        else:
            self._boards = (*self._boards[1:], board)
        self.progress = step(self.progress, time_s, sights)


def sight_of(picture: Image, board: Board, is_read: bool) -> Sight:
    """The board in a picture.

    Args:
        picture: Of a camera, (H, W, 3).
        board: The board to look for.
        is_read: Whether this camera showed it before: then it is not looked for in a mirror.
    """
    px = corners_in(picture, board)
    if px is not None or is_read:
        return Sight(px)
    return Sight(None, corners_in(cv2.flip(picture, 1), board) is not None)
