"""From videos to `calibration.json`, as the command does it."""

from pathlib import Path

import cv2
import msgspec
import numpy as np
import pytest
from filmed_board import FilmedRig, pictures_of, random_rig
from rich.console import Console

from common.rig.camera import centre
from common.rig.rig_file import CalibrationError, load_rig
from integrator.board.board import BOARDS
from tritrack.offline.rig_of_boards import Shown, calibrate_by_videos

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
