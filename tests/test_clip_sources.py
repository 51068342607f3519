"""Which files and cameras the settings name, before any of them is looked into."""

from pathlib import Path

import pytest

from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.video.clip_sources import (
    NOTHING,
    ClipError,
    Footage,
    companions_folder,
    footage_of,
    refuse_no_footage,
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two videos, and what may stand beside them under the same names."""
    for name in ("cam1.avi", "cam2.MKV", "cam1.png", "cam1.json", "cam2.TXT", "cam12.avi"):
        (tmp_path / name).touch()
    (tmp_path / "cam2.d").mkdir()
    return tmp_path


def test_a_folder_names_both_and_a_views_own_source_goes_before_it(folder: Path) -> None:
    plain, whole = CameraSettings(), Settings(clip=str(folder))
    one, two = str(folder / "cam1.avi"), str(folder / "cam2.MKV")
    assert footage_of(whole) == [Footage(1, one, plain), Footage(2, two, plain)]
    own, device = CameraSettings(source="x.mp4"), CameraSettings(device=0)
    mixed = Settings(clip=str(folder), camera_1=own, camera_2=device)
    assert footage_of(mixed) == [Footage(1, "x.mp4", own), Footage(2, 0, device)]
    named = CameraSettings(calibrated_as="left")
    assert footage_of(Settings(clip=str(folder), camera_2=named))[1] == Footage(2, two, named)


def test_a_view_without_a_source_is_left_out(folder: Path) -> None:
    camera = CameraSettings(device=3)
    assert footage_of(Settings(camera_2=camera)) == [Footage(2, 3, camera)]
    assert footage_of(Settings()) == []
    (folder / "cam1.avi").unlink()
    assert [view.number for view in footage_of(Settings(clip=str(folder)))] == [2]


def test_what_is_no_clip_is_refused_by_its_name(folder: Path) -> None:
    for clip, said in (
        (folder / "cam1.avi", "cam1.avi is a file: name its folder, or set it as camera_1.source"),
        (folder / "gone", "there is no clip folder .*gone: check the path"),
        (folder / "cam2.d", "cam2.d has neither cam1.* nor cam2.*: name the videos so"),
    ):
        with pytest.raises(ClipError, match=said):
            footage_of(Settings(clip=str(clip)))
    (folder / "cam2.avi").touch()
    with pytest.raises(ClipError, match=r"has 2 videos of camera 2 \(cam2\.MKV, cam2\.avi\): keep"):
        footage_of(Settings(clip=str(folder)))


def test_settings_that_name_nothing_are_refused_by_their_file(folder: Path) -> None:
    with pytest.raises(ClipError, match=rf"^room\.toml: {NOTHING}$"):
        refuse_no_footage(Settings(), Path("room.toml"))
    refuse_no_footage(Settings(clip=str(folder)), Path("room.toml"))
    refuse_no_footage(Settings(camera_2=CameraSettings(device=0)), Path("room.toml"))


def test_what_goes_with_the_videos_lies_in_the_clip_or_beside_the_first_file() -> None:
    camera = CameraSettings()
    named = [Footage(1, 0, camera), Footage(2, "b/two.avi", camera), Footage(1, "c/x.avi", camera)]
    assert companions_folder(Settings(clip="a"), named) == Path("a")
    assert companions_folder(Settings(), named) == Path("b")
    assert companions_folder(Settings(), named[:1]) == Path()
