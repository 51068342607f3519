"""The settings of a live run that the page begins, read back as a live run reads them."""

from pathlib import Path

import pytest

from common.config import config_file
from tritrack.machine_cameras.live_settings import live_settings


@pytest.mark.parametrize("name", ["room.json", 'a "room" \\ of\tmine é.json'])
def test_what_is_written_is_what_is_read(tmp_path: Path, name: str) -> None:
    file = tmp_path / "live.toml"
    text = live_settings([2, str(tmp_path / "cam 1.avi")], 8123, tmp_path / name, pictures=True)
    file.write_text(text, "utf-8")
    read = config_file.load(file)
    assert read.cameras["cam1"].device == 2
    assert read.cameras["cam2"].source == str(tmp_path / "cam 1.avi")
    assert read.calibration == str(tmp_path / name)
    assert (read.page.port, read.bus.endpoint, read.pictures) == (8123, "auto", True)


def test_without_a_calibration_there_is_none_and_no_picture_leaves_a_viewer(tmp_path: Path) -> None:
    file = tmp_path / "live.toml"
    file.write_text(live_settings([0], 8123, None, pictures=False))
    read = config_file.load(file)
    assert (read.calibration, read.pictures, [*read.cameras]) == ("", False, ["cam1"])
