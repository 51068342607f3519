"""Two views of one camera, by their files: refused before a run."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from common.bus.messages import ViewerNumber
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.video.clip_sources import ClipError, ViewSource
from common.video.pictures import Source
from common.video.view_pair import refuse_missing, refuse_same_source


def named(*sources: Source) -> list[ViewSource]:
    numbers: tuple[ViewerNumber, ...] = (1, 2)
    views = zip(numbers, sources, strict=False)
    return [
        ViewSource(number, source, CameraSettings(), f"cam{number}") for number, source in views
    ]


def test_equal_files_are_one_video_whatever_their_names(tmp_path: Path) -> None:
    one, copy = tmp_path / "one.avi", tmp_path / "two.avi"
    one.write_bytes(b"a" * 70_000 + b"b")
    copy.write_bytes(one.read_bytes())
    with pytest.raises(ClipError, match=r"one\.avi and .*two\.avi; name two videos"):
        refuse_same_source(named(str(one), str(copy)))
    copy.write_bytes(b"a" * 70_000 + b"c")
    refuse_same_source(named(str(one), str(copy)))


def test_one_camera_is_not_two() -> None:
    with pytest.raises(ClipError, match="0 and 0; name two cameras"):
        refuse_same_source(named(0, 0))
    refuse_same_source(named(0, 1))
    refuse_same_source(named(0))


@pytest.mark.parametrize(
    ("number", "others", "said"),
    [
        (1, ["b2.mp4", "a.mp4"], "has cam1.avi and no cam2.*: rename b2.mp4 to cam2.mp4; to track"),
        (
            2,
            ["c1.mov", "b2.mp4"],
            "has cam2.avi and no cam1.*: rename c1.mov to cam1.mov; to track",
        ),
        (1, ["a2.json", "b1.mp4"], "has cam1.avi and no cam2.*: add it; to track by one camera "),
    ],
)
def test_one_of_two_is_refused_with_the_other_ones_likely_name(
    tmp_path: Path, number: ViewerNumber, others: list[str], said: str
) -> None:
    found = tmp_path / f"cam{number}.avi"
    for name in (found.name, *others):
        (tmp_path / name).touch()
    (tmp_path / "take 1 2").mkdir()
    clip, camera = Settings(clip=str(tmp_path)), CameraSettings()
    with pytest.raises(ClipError) as caught:
        refuse_missing(clip, [ViewSource(number, str(found), camera, f"cam{number}")], None)
    assert f"{tmp_path} {said}" in str(caught.value)
    assert f"add --views {number}, or name its video in settings (cameras.cam{number}.s" in str(
        caught.value
    )


def test_one_alone_is_let_through_where_both_are_there_or_it_was_named_itself() -> None:
    own = CameraSettings(source="walk.avi")
    clip = Settings(clip="nowhere")
    refuse_missing(clip, named("cam1.avi", "cam2.avi"), None)
    refuse_missing(clip, [ViewSource(1, "walk.avi", own, "cam1")], None)
    refuse_missing(clip, named(0), None)
    refuse_missing(Settings(), named("cam1.avi"), None)


def test_a_camera_and_a_file_are_two() -> None:
    refuse_same_source(named(0, "nowhere.avi"))
    refuse_same_source(named("nowhere.avi", 1))


def test_views_that_are_the_same_are_named_in_their_order() -> None:
    with pytest.raises(ClipError, match=r"^views 1 and 2 are the same: 4 and 4; .*--views 1$"):
        refuse_same_source(named(4, 4))


def refusal(
    folder: Path, numbers: Sequence[int], asked: Sequence[int] | None, clip: bool = True
) -> str:
    found = [
        ViewSource(n, str(folder / f"cam{n}.avi"), CameraSettings(), f"cam{n}") for n in numbers
    ]
    with pytest.raises(ClipError) as caught:
        refuse_missing(Settings(clip=str(folder) if clip else ""), found, asked)
    return str(caught.value)


def test_one_of_several_is_missed_with_the_views_that_would_do(tmp_path: Path) -> None:
    for name in ("cam1.avi", "cam4.avi", "cam3.avi", "take2.avi"):
        (tmp_path / name).touch()
    said = refusal(tmp_path, (1, 3, 4), None)
    assert "has cam1.avi, cam3.avi, cam4.avi and no cam2.*: rename take2.avi to cam2.avi" in said
    assert "to track without it add --views 1,3,4, or name the videos" in said
    assert "has cam3.avi, cam4.avi and no cam1.*: rename cam1.avi" in refusal(
        tmp_path, (3, 4), None
    )


def test_only_the_cameras_that_are_asked_for_must_be_there(tmp_path: Path) -> None:
    (tmp_path / "cam1.avi").touch()
    refuse_missing(Settings(clip=str(tmp_path)), named("cam1.avi"), (1,))
    assert "has cam1.avi and no cam3.*: add it" in refusal(tmp_path, (1,), (1, 3))
    assert "no cam2.*" in refusal(tmp_path, (1,), (2,))
    said = refusal(tmp_path, (1,), (2,), clip=False)
    assert said == "there is no camera 2: the settings name 1 (cam1)"
