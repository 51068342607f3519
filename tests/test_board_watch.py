"""The board watched in running cameras: what is seen, what is kept, what a mirror shows."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from filmed_board import board_picture
from waiting import until

from calibration.board.board import BOARDS
from calibration.board.board_progress import words_of
from common.video.pictures import Image
from tritrack.machine_cameras import board_watch
from tritrack.machine_cameras.board_watch import BoardWatch, sight_of


def held(mirrored: bool = False) -> Image:
    """A picture of the board, as a camera sees it or in a mirror."""
    board = cv2.resize(board_picture(BOARDS["a3"]), (300, 240), interpolation=cv2.INTER_AREA)
    picture = np.full((480, 640, 3), 120, np.uint8)
    picture[100:340, 150:450] = board[..., None]
    return np.ascontiguousarray(picture[:, ::-1]) if mirrored else picture


def test_a_board_that_only_a_mirror_shows_is_no_board_that_is_seen() -> None:
    assert sight_of(held(), BOARDS["a3"], is_read=False).px is not None
    seen = sight_of(held(mirrored=True), BOARDS["a3"], is_read=False)
    assert (seen.px, seen.in_mirror) == (None, True)
    assert sight_of(held(), BOARDS["a4"], is_read=False) == (None, False)


@pytest.mark.slow
def test_two_cameras_are_watched_and_what_they_showed_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(board_watch, "HZ", 20.0)
    watch = BoardWatch([held, lambda: held(mirrored=True)], tmp_path / "board")

    def is_told() -> bool:
        progress = watch.progress
        return progress is not None and (
            progress.cameras[0].poses == 1 and progress.cameras[1].is_mirrored
        )

    assert until(is_told)
    assert watch.progress is not None
    assert "switch mirroring off" in words_of(watch.progress, ["one", "two"])[1]
    green = watch.shown(0, held()).astype(int)
    assert (green[..., 1] > green[..., 2] + 20).any(), "where the board was is tinted"
    watch.close()
    frames = [cv2.VideoCapture(str(path)).get(cv2.CAP_PROP_FRAME_COUNT) for path in watch.videos]
    assert frames[0] == frames[1] > 3
