"""The PDF, drawn again from its own path, in millimetres."""

import re
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from calibration.board.board import BOARDS, SHEETS_MM, Paper
from calibration.board.board_corners import corners_in
from calibration.board.board_print import print_board
from common.rig.rig_file import CalibrationError

POINTS_A_MM = 72 / 25.4
DOTS_A_MM = 4


def path_of(pdf: bytes) -> str:
    """The drawing that has most, after the sheet's own white: its operators as text."""
    parts = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.DOTALL)
    texts = []
    for part in parts:
        try:
            texts.append(zlib.decompress(part).decode("latin-1"))
        except zlib.error:
            continue
    longest = max(texts, key=len)
    return longest.partition(" W n ")[2]


@pytest.mark.parametrize("paper", ["a4", "a3"])
def test_the_print_has_the_true_size_and_is_found(tmp_path: Path, paper: Paper) -> None:
    print_board(tmp_path / "board.pdf", paper)
    pdf = (tmp_path / "board.pdf").read_bytes()
    box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+) ?\]", pdf)
    assert box
    size_mm = [float(side) / POINTS_A_MM for side in box.groups()]
    assert size_mm == pytest.approx(SHEETS_MM[paper], abs=0.02)
    sheet = np.full([round(side * DOTS_A_MM) for side in reversed(size_mm)], 255, np.uint8)
    corners: list[list[float]] = []
    for x, y, operator in re.findall(r"(-?[\d.]+) (-?[\d.]+) ([ml])$", path_of(pdf), re.MULTILINE):
        if operator == "m" and corners:
            fill(sheet, corners)
            corners = []
        corners.append([float(x) / POINTS_A_MM, size_mm[1] - float(y) / POINTS_A_MM])
    fill(sheet, corners)
    board = BOARDS[paper]
    found = corners_in(sheet, board)
    assert found is not None
    across = np.linalg.norm(np.diff(found.reshape(board.rows - 1, -1, 2), axis=1), axis=-1)
    assert across / DOTS_A_MM == pytest.approx(np.full(across.shape, board.square_m * 1e3), abs=0.1)


def fill(
    sheet: np.ndarray[tuple[int, ...], np.dtype[np.uint8]], corners: list[list[float]]
) -> None:
    (left, top), (right, bottom) = (
        np.round(np.array(corners).min(axis=0) * DOTS_A_MM).astype(int),
        np.round(np.array(corners).max(axis=0) * DOTS_A_MM).astype(int),
    )
    cv2.rectangle(sheet, (left, top), (right - 1, bottom - 1), 0, cv2.FILLED)


def test_a_file_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(CalibrationError, match="cannot write the board"):
        print_board(tmp_path / "file" / "board.pdf", "a4")
