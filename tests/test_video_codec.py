"""What can be encoded with what is installed."""

from pathlib import Path

import cv2
import pytest

from animator import video_codec
from animator.video_codec import CODECS, H264, MOTION_JPEG, MPEG4, best_codec, pictures_in


@pytest.fixture(autouse=True)
def nothing_known() -> None:
    best_codec.cache_clear()


@pytest.mark.parametrize(
    ("has_av", "by", "best"),
    [
        (True, [], H264),
        (False, [cv2.CAP_FFMPEG], MPEG4),
        (False, [cv2.CAP_OPENCV_MJPEG], MOTION_JPEG),
    ],
)
def test_the_best_codec_is_that_of_the_best_library(
    has_av: bool, by: list[int], best: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(video_codec, "find_spec", lambda name: name if has_av else None)
    monkeypatch.setattr(cv2.videoio_registry, "getWriterBackends", lambda: by)
    assert best_codec() == best


def test_what_is_no_video_has_no_pictures(tmp_path: Path) -> None:
    (tmp_path / "torn.mp4").write_bytes(b"ftyp" * 9)
    for codec in CODECS:
        assert pictures_in(tmp_path / "torn.mp4", codec) == 0
