"""Which files and cameras the settings name, before any of them is looked into."""

from pathlib import Path

import pytest

from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.video.clip_sources import (
    NOTHING,
    ClipError,
    ViewSource,
    camera_words,
    companions_folder,
    first_camera,
    numbers_of,
    refuse_no_source,
    sources_of,
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
    assert sources_of(whole) == [
        ViewSource(1, one, plain, "cam1"),
        ViewSource(2, two, plain, "cam2"),
    ]
    own, device = CameraSettings(source="x.mp4"), CameraSettings(device=0)
    mixed = Settings(clip=str(folder), cameras={"cam1": own, "cam2": device})
    assert sources_of(mixed) == [
        ViewSource(1, "x.mp4", own, "cam1"),
        ViewSource(2, 0, device, "cam2"),
    ]
    named = CameraSettings(calibrated_as="left")
    assert sources_of(Settings(clip=str(folder), cameras={"cam2": named}))[1] == ViewSource(
        2, two, named, "cam2"
    )


def test_a_view_without_a_source_is_left_out(folder: Path) -> None:
    camera = CameraSettings(device=3)
    assert sources_of(Settings(cameras={"cam2": camera})) == [ViewSource(2, 3, camera, "cam2")]
    assert sources_of(Settings()) == []
    (folder / "cam1.avi").unlink()
    assert [view.number for view in sources_of(Settings(clip=str(folder)))] == [2]


def test_what_is_no_clip_is_refused_by_its_name(folder: Path) -> None:
    for clip, said in (
        (
            folder / "cam1.avi",
            "cam1.avi is a file: name its folder, or set it as cameras.cam1.source",
        ),
        (folder / "gone", "there is no clip folder .*gone: check the path"),
        (folder / "cam2.d", "cam2.d has neither cam1.* nor cam2.*: name the videos so"),
    ):
        with pytest.raises(ClipError, match=said):
            sources_of(Settings(clip=str(clip)))
    (folder / "cam2.avi").touch()
    with pytest.raises(ClipError, match=r"has 2 videos of cam2 \(cam2\.MKV, cam2\.avi\): keep"):
        sources_of(Settings(clip=str(folder)))


def test_settings_that_name_nothing_are_refused_by_their_file(folder: Path) -> None:
    with pytest.raises(ClipError, match=rf"^room\.toml: {NOTHING}$"):
        refuse_no_source(Settings(), Path("room.toml"))
    refuse_no_source(Settings(clip=str(folder)), Path("room.toml"))
    refuse_no_source(Settings(cameras={"cam2": CameraSettings(device=0)}), Path("room.toml"))


def test_what_goes_with_the_videos_lies_in_the_clip_or_beside_the_first_file() -> None:
    camera = CameraSettings()
    sources = (0, "b/two.avi", "c/x.avi")
    named = [ViewSource(1, source, camera, "cam1") for source in sources]
    assert companions_folder(Settings(clip="a"), named) == Path("a")
    assert companions_folder(Settings(), named) == Path("b")
    assert companions_folder(Settings(), named[:1]) == Path()


def test_a_folder_has_up_to_eight_cameras(tmp_path: Path) -> None:
    for n in range(8, 0, -1):
        (tmp_path / f"cam{n}.mp4").touch()
    found = sources_of(Settings(clip=str(tmp_path)))
    assert [(one.number, one.name) for one in found] == [(n, f"cam{n}") for n in range(1, 9)]
    (tmp_path / "cam9.mp4").touch()
    with pytest.raises(ClipError, match=r"has cam9\.mp4: a clip has 8 cameras at most"):
        sources_of(Settings(clip=str(tmp_path)))


def test_cameras_of_any_name_are_numbered_in_their_order() -> None:
    left, right = CameraSettings(source="l.avi"), CameraSettings(device=1)
    found = sources_of(Settings(cameras={"left": left, "right": right}))
    assert found == [ViewSource(1, "l.avi", left, "left"), ViewSource(2, 1, right, "right")]


@pytest.mark.parametrize(
    ("names", "numbers"),
    [
        (["cam2"], [2]),
        (["cam3", "cam1"], [3, 1]),
        (["door", "cam1", "stairs", "cam3"], [2, 1, 4, 3]),
        (["cam08", "cam9", "cam0"], [1, 2, 3]),
    ],
)
def test_who_is_called_by_a_number_has_it_and_others_take_what_is_free(
    names: list[str], numbers: list[int]
) -> None:
    assert [*numbers_of(names).values()] == numbers


def test_a_ninth_camera_is_refused_by_name(folder: Path) -> None:
    seven = {f"c{n}": CameraSettings(device=n) for n in range(7)}
    with pytest.raises(ClipError, match=r"9 cameras \(c0, .*, cam1, cam2\): keep 8 at most"):
        sources_of(Settings(clip=str(folder), cameras=seven))


def test_a_named_camera_without_a_video_is_refused(folder: Path) -> None:
    """A clip folder has none of that name to give."""
    plate = {"left": CameraSettings(background="empty.png")}
    with pytest.raises(ClipError, match=r"^cameras\.left has neither source nor device"):
        sources_of(Settings(clip=str(folder), cameras=plate))


def test_cameras_are_called_by_their_names_for_the_user_and_else_by_their_numbers() -> None:
    camera = CameraSettings(device=0)
    words = camera_words(Settings(cameras={"cam2": camera, "left": camera}))
    assert words[:3] == ("left", "camera 2", "camera 3")
    assert camera_words(Settings(clip="walk"))[:2] == ("camera 1", "camera 2")


def test_the_first_camera_is_that_of_number_1() -> None:
    camera = CameraSettings(device=0)
    assert first_camera(Settings(cameras={"cam2": camera, "left": camera})) == "left"
    assert first_camera(Settings(cameras={"cam2": camera, "cam1": camera})) == "cam1"
    assert first_camera(Settings(cameras={"cam2": camera})) == "cam1"
