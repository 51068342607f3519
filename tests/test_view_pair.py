"""Two views of one camera, by their files: refused before a run."""

from pathlib import Path

import pytest

from common.bus.messages import ViewerNumber
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.video.clip_sources import ClipError, Footage
from common.video.pictures import Source
from common.video.view_pair import refuse_one_of_two, refuse_same_source


def named(*sources: Source) -> list[Footage]:
    numbers: tuple[ViewerNumber, ...] = (1, 2)
    views = zip(numbers, sources, strict=False)
    return [Footage(number, source, CameraSettings()) for number, source in views]


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
        refuse_one_of_two(clip, [Footage(number, str(found), camera)])
    assert f"{tmp_path} {said}" in str(caught.value)
    assert f"add --views {number}, or name its video in settings (camera_{number}.s" in str(
        caught.value
    )


def test_one_alone_is_let_through_where_both_are_there_or_it_was_named_itself() -> None:
    own = CameraSettings(source="walk.avi")
    clip = Settings(clip="nowhere")
    refuse_one_of_two(clip, named("cam1.avi", "cam2.avi"))
    refuse_one_of_two(clip, [Footage(1, "walk.avi", own)])
    refuse_one_of_two(clip, named(0))
    refuse_one_of_two(Settings(), named("cam1.avi"))


def test_a_camera_and_a_file_are_two() -> None:
    refuse_same_source(named(0, "nowhere.avi"))
    refuse_same_source(named("nowhere.avi", 1))


def test_views_that_are_the_same_are_named_in_their_order() -> None:
    with pytest.raises(ClipError, match=r"^views 1 and 2 are the same: 4 and 4; .*--views 1$"):
        refuse_same_source(named(4, 4))
