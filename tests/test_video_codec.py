"""What this machine can encode: found out by trying, quietly, and never for long."""

import subprocess
import sys
from pathlib import Path

import pytest

from animator.video_codec import CODECS, best_codec, pictures_in, works

SIZE = (64, 48)


@pytest.fixture(autouse=True)
def nothing_known() -> None:
    best_codec.cache_clear()


def test_the_best_codec_is_the_first_that_works() -> None:
    assert best_codec(SIZE) == next(codec for codec in CODECS if works(codec, SIZE))


def test_one_needs_no_library_that_may_be_missing() -> None:
    """Motion JPEG by OpenCV's own writer."""
    assert works(CODECS[-1], SIZE)


def test_nothing_is_printed_by_encoders_that_are_missing(capfd: pytest.CaptureFixture[str]) -> None:
    """Hardware encoders that find no device say so in several lines."""
    best_codec(SIZE)
    assert capfd.readouterr() == ("", "")


def test_an_encoder_that_hangs_or_dies_costs_the_trial_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def hangs(*_: object, **__: object) -> None:
        raise subprocess.TimeoutExpired("animator.video_codec", 20.0)

    def dies(*_: object, **__: object) -> object:
        return subprocess.run([sys.executable, "-c", "1 / 0"], capture_output=True, check=False)

    for trial in (hangs, dies):
        best_codec.cache_clear()
        with monkeypatch.context() as patch:
            patch.setattr("animator.video_codec.subprocess.run", trial)
            if trial is dies:
                patch.undo()
                patch.setattr("animator.video_codec.sys.executable", "/bin/false")
            assert best_codec(SIZE) == CODECS[-1]


def test_what_is_no_film_has_no_pictures(tmp_path: Path) -> None:
    (tmp_path / "torn.mp4").write_bytes(b"ftyp" * 9)
    for codec in CODECS:
        assert pictures_in(tmp_path / "torn.mp4", codec) == 0
