"""From videos to `calibration.json`, as the command does it."""

import io
from pathlib import Path

import cv2
import msgspec
import numpy as np
import pytest
from filmed_board import FilmedRig, pictures_of, random_rig
from rich.console import Console

from calibration.board.board import BOARDS, Board
from calibration.board.board_quality import CameraQuality, Quality
from calibration.board.board_rig import BoardCalibration
from calibration.board.still_board import BoardVideo, Moments
from common.rig.camera import centre, paper_rig
from common.rig.rig_file import CalibrationError, load_rig
from runtime.offline import rig_of_boards
from runtime.offline.board_videos import Looked
from runtime.offline.rig_of_boards import Shown, calibrate_by_videos

QUIET = Console(quiet=True)


def write_videos(folder: Path, rig: FilmedRig) -> list[Path]:
    """Five pictures a second, as MJPEG; the second film begins 0.2 s late."""
    paths = []
    for n in range(2):
        path = folder / f"cam{n + 1}.avi"
        writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 5.0, rig.size)
        writer.set(cv2.VIDEOWRITER_PROP_QUALITY, 95)
        for picture in pictures_of(rig, n, n, 4, late=n):
            writer.write(picture)
        writer.release()
        paths.append(path)
    return paths


@pytest.mark.slow
def test_videos_give_the_rig_its_quality_and_what_was_covered(tmp_path: Path) -> None:
    board = BOARDS["a3"]._replace(square_m=0.2)
    rig = random_rig(1, (320, 240), board, 24)
    videos = write_videos(tmp_path, rig)
    out = tmp_path / "calibration.json"
    quality, drawn = calibrate_by_videos(videos, Shown(square_mm=200.0), out, QUIET)
    found = load_rig(out)
    apart = [float(np.linalg.norm(centre(a) - centre(b))) for a, b in (found.cameras, rig.cameras)]
    assert apart[0] == pytest.approx(apart[1], abs=0.02)
    assert quality.reprojection_px < 0.3
    assert "quality" in msgspec.json.decode(out.read_bytes())
    picture = cv2.imread(str(drawn))
    assert picture is not None
    assert picture.shape == (360, 960, 3)


def test_a_room_without_a_board_is_told_with_the_cure(tmp_path: Path) -> None:
    blank = np.full((240, 320, 3), 90, np.uint8)
    pictures = [tmp_path / "cam1.png", tmp_path / "cam2.png"]
    for path in pictures:
        cv2.imwrite(str(path), blank)
    out = tmp_path / "calibration.json"
    with pytest.raises(CalibrationError, match=r"no board is found in .*cam1\.png: print one"):
        calibrate_by_videos(pictures, Shown(), out, QUIET)
    with pytest.raises(CalibrationError, match=r"cam1\.png: a chessboard of 9x6 squares must"):
        calibrate_by_videos(pictures, Shown(20.0, "9x6"), out, QUIET)


def test_a_chessboard_needs_its_squares_measured(tmp_path: Path) -> None:
    with pytest.raises(CalibrationError, match="--square MM"):
        calibrate_by_videos([], Shown(chessboard="9x6"), tmp_path / "calibration.json", QUIET)


def looked_at(board: Board, size_px: tuple[int, int]) -> Looked:
    width, height = size_px
    film = BoardVideo("cam", size_px, np.empty(0), np.empty((0, 12, 2)))
    return Looked(film, board, np.zeros((height, width, 3), np.uint8))


class Bench:
    """Films of a board, and a rig that they give: what the command hands on between both."""

    rig = paper_rig((320, 240), (400.0, 400.0), (4.0, 4.0))

    def __init__(self, patch: pytest.MonkeyPatch, printed: Board, coverage: float = 0.9) -> None:
        self.asked: tuple[Board, ...] = ()
        self.board = printed
        self.floor_s: float | None = None
        self.printed, self.coverage = printed, coverage
        patch.setattr(rig_of_boards, "looked_through", self.looked_through)
        patch.setattr(rig_of_boards, "calibrated_by_board", self.calibrated)

    def looked_through(
        self, videos: list[str], boards: tuple[Board, ...], _: object
    ) -> list[Looked]:
        self.asked = boards
        return [looked_at(boards[0] if len(boards) == 1 else self.printed, (320, 240))] * 2

    def calibrated(
        self, films: list[BoardVideo], board: Board, floor_s: float | None
    ) -> BoardCalibration:
        self.board, self.floor_s = board, floor_s
        corners = np.array([[0.0, 0.0], [319.0, 0.0], [319.0, 239.0], [0.0, 239.0]])
        px = np.full((1, 2, 4, 2), np.nan)
        px[0, 0] = corners
        shown = [
            CameraQuality(f"cam{n}", 400.0, 1.0, 0.0, 0.0, 0.1, 9, self.coverage) for n in (1, 2)
        ]
        quality = Quality(tuple(shown), 0.1, 9, 1.0, 1)
        return BoardCalibration(self.rig, quality, Moments(np.zeros(1), np.ones(1), px))


def test_the_squares_that_are_measured_are_metres_inside(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A chessboard of 30 mm, and a sheet of ours that came out of the printer at 47 mm."""
    bench, out = Bench(monkeypatch, BOARDS["a4"]), tmp_path / "calibration.json"
    calibrate_by_videos([Path("1.avi")] * 2, Shown(30.0, "9x6", 4.5), out, QUIET)
    assert bench.asked == (Board(9, 6, 0.030, None),)
    assert bench.board.square_m == pytest.approx(0.030)
    assert bench.floor_s == 4.5
    calibrate_by_videos([Path("1.avi")] * 2, Shown(47.0), out, QUIET)
    assert bench.asked == tuple(BOARDS.values())
    assert bench.board == BOARDS["a4"]._replace(square_m=0.047)
    calibrate_by_videos([Path("1.avi")] * 2, Shown(), out, QUIET)
    assert bench.board == BOARDS["a4"]


def test_each_camera_is_drawn_with_what_it_saw_and_named_where_that_is_little(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The board filled the first picture and was never in the second."""
    Bench(monkeypatch, BOARDS["a4"], 0.39)
    console = Console(record=True, width=200, file=io.StringIO())
    out = tmp_path / "calibration.json"
    _, drawn = calibrate_by_videos([Path("1.avi")] * 2, Shown(), out, console)
    assert drawn == tmp_path / "calibration_coverage.png"
    green = cv2.imread(str(drawn))[:, :, 1]  # type: ignore[index]
    assert green[180, 240] > 0
    assert green[180, 720] == 0
    assert load_rig(out) == Bench.rig
    said = console.export_text()
    assert "covered 39% of the picture of cam1" in said
    assert "covered 39% of the picture of cam2" in said
    Bench(monkeypatch, BOARDS["a4"], 0.41)
    console = Console(record=True, width=200, file=io.StringIO())
    calibrate_by_videos([Path("1.avi")] * 2, Shown(), out, console)
    assert "covered" not in console.export_text()
