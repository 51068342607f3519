"""Cameras on another host: nothing of this one is opened for them."""

from pathlib import Path

import msgspec
import pytest
from spoiling import copied, edit_json

from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.rig.rig_file import load_rig
from common.video.clip_sources import ClipError
from common.video.clips import open_clip
from runtime.live.elsewhere import whole_clip

NOWHERE, NEITHER = CameraSettings(device=63), CameraSettings(device=62)


@pytest.fixture
def calibration(clip: Path, tmp_path: Path) -> Path:
    return copied(clip, tmp_path / "own") / "calibration.json"


def settings_of(calibration: Path, **more: object) -> Settings:
    own = Settings(calibration=str(calibration), cameras={"cam1": NOWHERE, "cam2": NEITHER})
    return msgspec.structs.replace(own, **more)


def test_a_camera_is_known_by_its_calibration(calibration: Path) -> None:
    rig = load_rig(calibration)
    clip = whole_clip(settings_of(calibration, size="4096x4096"))
    assert [view.source_size for view in clip.views] == [(rig.width, rig.height)] * 2
    assert [view.source for view in clip.views] == [63, 62]
    assert clip.rig is not None
    assert clip.rig.cameras == rig.cameras


def test_the_rate_is_the_settings_the_calibrations_or_15(calibration: Path) -> None:
    edit_json(calibration, lambda rig: rig.update(fps=25))
    assert whole_clip(settings_of(calibration, fps=30.0)).views[0].fps == 30.0
    assert whole_clip(settings_of(calibration)).views[0].fps == 25.0
    edit_json(calibration, lambda rig: rig.pop("fps"))
    assert whole_clip(settings_of(calibration)).views[0].fps == 15.0


def test_a_recorded_clip_is_looked_into_as_ever(clip: Path) -> None:
    assert whole_clip(Settings(clip=str(clip))).views == open_clip(Settings(clip=str(clip))).views


def test_a_calibration_that_cannot_be_read_is_told(calibration: Path) -> None:
    calibration.write_text("{")
    with pytest.raises(ClipError, match=r"calibration\.json"):
        whole_clip(settings_of(calibration))


def test_without_a_calibration_the_camera_itself_must_be_there() -> None:
    with pytest.raises(ClipError, match="camera 63"):
        whole_clip(Settings(cameras={"cam1": NOWHERE, "cam2": NEITHER}))
