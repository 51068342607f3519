"""Files of measured points: read, refused with a reason, and written as a calibration."""

from pathlib import Path

import msgspec
import pytest

from calibration.paper.calibration import run_markers, run_poles
from calibration.paper.poles import Quality
from common.atomic_file import FileRefused
from common.rig.camera import as_paper_rig
from common.rig.rig_file import CalibrationError, load_rig

CONFIGS = Path(__file__).parents[1] / "configs"


def test_the_example_of_poles_gives_the_rig_that_it_speaks_of(tmp_path: Path) -> None:
    """P43: within three bars, through the file that everything else reads."""
    out = tmp_path / "calibration.json"
    quality = run_poles(CONFIGS / "poles.toml", out)
    for camera, focal_px, distance_m in zip(
        quality.cameras, (620.0, 640.0), (4.2, 3.9), strict=True
    ):
        assert abs(camera.focal_px - focal_px) < 3 * camera.focal_sd_px
        assert abs(camera.distance_m - distance_m) < 3 * camera.distance_sd_m
        assert camera.distance_sd_m < 0.05
    rig = load_rig(out, wanted=("cam1", "cam2"))
    first, second = quality.cameras
    assert as_paper_rig(rig) == pytest.approx(
        (first.focal_px, second.focal_px, first.distance_m, second.distance_m)
    )
    assert (rig.width, rig.height) == (640, 480)


def test_the_folder_of_a_calibration_is_made(tmp_path: Path) -> None:
    out = tmp_path / "new" / "deep" / "calibration.json"
    run_poles(CONFIGS / "poles.toml", out)
    assert load_rig(out).cameras


def test_the_quality_stands_beside_the_rig(tmp_path: Path) -> None:
    out = tmp_path / "calibration.json"
    quality = run_poles(CONFIGS / "poles.toml", out)
    written = msgspec.json.decode(out.read_bytes())
    assert msgspec.convert(written["quality"], Quality) == quality


def test_the_example_of_markers_gives_the_errors_that_it_speaks_of() -> None:
    """P42: within 0.1 degrees, read to the pixel."""
    first, second = run_markers(CONFIGS / "markers.toml")
    assert (first.yaw_deg, first.pitch_deg, first.roll_deg) == pytest.approx(
        (1.5, -0.8, 0.5), abs=0.1
    )
    assert (second.yaw_deg, second.pitch_deg, second.roll_deg) == pytest.approx(
        (-0.7, 0.3, 0.0), abs=0.1
    )


def test_a_json_file_says_the_same_as_a_toml_file(tmp_path: Path) -> None:
    plain = msgspec.toml.decode((CONFIGS / "poles.toml").read_bytes())
    copy = tmp_path / "poles.json"
    copy.write_bytes(msgspec.json.encode(plain))
    assert run_poles(copy, tmp_path / "a.json") == run_poles(
        CONFIGS / "poles.toml", tmp_path / "b.json"
    )


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("pole_height_m", "pole_heigth_m", "pole_heigth_m"),
        (
            "x_m = 1.0",
            "x_m = 1.0\ny_m = 0.0",
            "unknown setting poles 3, y_m",
        ),
        (
            "cam1_px = [320.5, 62.5]",
            "cam1_px = [320.5]",
            "poles 1, cam1_px must have 2 entries, got 1",
        ),
        ("width = 640", "width = -640", "width must be a whole number >= 1"),
        ("pole_height_m = 2.2", "pole_height_m = 0", "pole_height_m must be a number > 0"),
        (
            "pole_height_m = 2.2",
            "pole_height_m = 220",
            r"pole_height_m must be from 0\.2 to 10 metres, got 220: 2\.2\?",
        ),
        (
            "# distance_1_m = 4.2",
            "distance_1_m = 420",
            r"distance_1_m must be from 0\.2 to 50 metres, got 420: 4\.2\?",
        ),
        ("x_m = 1.0", "x_m = 100", r"x_m of pole 3 must be from -50 to 50 metres, got 100: 1\?"),
        ("cam1_px = [320.5, 62.5]", "cam1_px = [nan, 62.5]", "not finite"),
        ("width = 640", "width = ", "poles.toml"),
    ],
)
def test_a_file_that_cannot_be_meant_is_refused_at_the_place(
    tmp_path: Path, old: str, new: str, says: str
) -> None:
    text = (CONFIGS / "poles.toml").read_text()
    assert old in text
    wrong = tmp_path / "poles.toml"
    wrong.write_text(text.replace(old, new, 1))
    with pytest.raises(CalibrationError, match=says):
        run_poles(wrong, tmp_path / "out.json")
    assert not (tmp_path / "out.json").exists()


def test_files_that_cannot_be_read_or_written_are_told(tmp_path: Path) -> None:
    with pytest.raises(CalibrationError, match="cannot read the points"):
        run_markers(tmp_path / "absent.toml")
    (tmp_path / "file").write_text("")
    with pytest.raises(CalibrationError, match="cannot write the calibration"):
        run_poles(CONFIGS / "poles.toml", tmp_path / "file" / "calibration.json")
    (tmp_path / "noise.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(CalibrationError, match=r"noise\.toml"):
        run_markers(tmp_path / "noise.toml")


def test_a_calibration_that_is_there_is_lost_only_where_it_may_be(tmp_path: Path) -> None:
    out = tmp_path / "calibration.json"
    out.write_text("an afternoon")
    with pytest.raises(FileRefused, match="--force"):
        run_poles(CONFIGS / "poles.toml", out)
    assert out.read_text() == "an afternoon"
    run_poles(CONFIGS / "poles.toml", out, replace=True)
    assert load_rig(out).cameras
