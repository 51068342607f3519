"""The board as a PDF, to print in true size."""

from pathlib import Path
from typing import Final

from calibration.board.board import BOARDS, SHEETS_MM, Paper, black_cells
from common.atomic_file import replacing
from common.rig.rig_file import CalibrationError

MM_AN_INCH: Final = 25.4


def print_board(path: Path, paper: Paper) -> None:
    """Write the board of a sheet as vectors: one black path, so that no seams appear.

    Raises:
        CalibrationError: When the file cannot be written.
    """
    from matplotlib.backends.backend_pdf import FigureCanvasPdf
    from matplotlib.figure import Figure
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    board, (width, height) = BOARDS[paper], SHEETS_MM[paper]
    square = board.square_m * 1e3
    left, top = (width - board.columns * square) / 2, (height + board.rows * square) / 2
    figure = Figure(figsize=(width / MM_AN_INCH, height / MM_AN_INCH))
    sheet = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, width), ylim=(0.0, height))
    sheet.set_axis_off()
    outlines = []
    for x, y, across, down in black_cells(board):
        low, high = top - (y + down) * square, top - y * square
        near, far = left + x * square, left + (x + across) * square
        corners = [(near, low), (far, low), (far, high), (near, high), (near, low)]
        outlines.append(Outline(corners, closed=True))
    black = Outline.make_compound_path(*outlines)
    sheet.add_patch(PathPatch(black, facecolor="black", edgecolor="none", linewidth=0))
    note = (
        f"tritrack {paper.upper()}: a square is {square:g} mm. Print at 100 %, not fitted to the "
        "page; measure a square\nand say --square MM where it is another. Glue the sheet flat onto "
        "a stiff board."
    )
    sheet.text(left / 2, height / 2, note, ha="center", va="center", rotation=90, fontsize=8)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as new, new.open("wb") as file:
            FigureCanvasPdf(figure).print_pdf(file, metadata={"CreationDate": None})
    except OSError as error:
        raise CalibrationError(f"cannot write the board {path}: {error.strerror}") from error
