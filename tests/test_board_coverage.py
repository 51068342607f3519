"""Which part of a picture a board was seen in, counted and looked at by hand."""

import numpy as np
import pytest

from calibration.board.board_coverage import CELLS, TINT, coverage_picture, covered

NAN = float("nan")


def test_cells_inside_the_corners_are_counted_at_each_rest() -> None:
    """480 x 240: cells of ten pixels, 48 x 24."""
    left = [(0.0, 0.0), (90.0, 0.0), (90.0, 190.0), (0.0, 190.0), (NAN, NAN)]
    top = [(0.0, 0.0), (470.0, 0.0), (470.0, 40.0), (0.0, 40.0), (200.0, 20.0)]
    hidden = [(NAN, NAN)] * 5
    cells = covered(np.array([left, hidden, top]), (480, 240))
    assert cells.shape == (24, CELLS)
    expected = np.zeros((24, CELLS), int)
    expected[:20, :10] += 1
    expected[:5] += 1
    assert (cells == expected).all()


def test_what_was_covered_four_times_is_fully_tinted_and_the_rest_is_half_as_bright() -> None:
    """Two pictures beside each other, each 480 wide, within a white frame."""
    cells = np.zeros((24, CELLS), np.int64)
    cells[4:8, 8:16], cells[12:16, 8:16], cells[12:16, 24:32] = 4, 2, 9
    grey = np.full((120, 240, 3), 100, np.uint8)
    bright = np.full((240, 480, 3), 200, np.uint8)
    drawn = coverage_picture([grey, bright], [cells, np.zeros_like(cells)])
    assert drawn.shape == (240, 960, 3)
    tint = np.array(TINT)
    assert drawn[200, 400].tolist() == [50] * 3
    assert drawn[60, 120] == pytest.approx(0.4 * 50 + 0.6 * tint, abs=1.0)
    assert drawn[140, 120] == pytest.approx(0.7 * 50 + 0.3 * tint, abs=1.0)
    assert drawn[140, 280] == pytest.approx(0.4 * 50 + 0.6 * tint, abs=1.0)
    assert drawn[60, 480 + 120].tolist() == [100] * 3
    for row, column in ((0, 7), (239, 7), (7, 0), (7, 479), (7, 480), (239, 959)):
        assert drawn[row, column].tolist() == [255] * 3
