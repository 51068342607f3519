"""Two views of one camera, by their files: refused before a run."""

from pathlib import Path

import pytest

from common.bus.messages import ViewerNumber
from common.config.part_settings import CameraSettings
from common.video.clip_sources import ClipError, Footage
from common.video.decoding import Source
from common.video.view_pair import refuse_same_source


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
