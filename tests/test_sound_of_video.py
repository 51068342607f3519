"""Sounds of videos, written by PyAV and read again on the clock of their pictures."""

import sys
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest

from common.sound import sound_of_video
from common.sound.sound_of_video import RATE_HZ, sound_of

HZ = 44_100


def written(path: Path, *, sound_begins_s: float | None, pictures_begin_s: float = 0.0) -> Path:
    """A video of 3 s in two channels, whose sound has a click 1 s after its beginning."""
    with av.open(str(path), "w") as container:
        view = container.add_stream("mjpeg", 10)
        view.width, view.height, view.pix_fmt = 64, 48, "yuvj420p"
        heard = None if sound_begins_s is None else container.add_stream("pcm_s16le", HZ)
        for n in range(30):
            picture = av.VideoFrame.from_ndarray(np.zeros((48, 64, 3), np.uint8), format="bgr24")
            picture.pts, picture.time_base = n + round(10 * pictures_begin_s), Fraction(1, 10)
            container.mux(view.encode(picture))
        container.mux(view.encode(None))
        if heard is not None:
            samples = np.zeros((1, 3 * HZ * 2), np.int16)
            samples[0, 2 * HZ : 2 * HZ + 2000] = 30_000
            sound = av.AudioFrame.from_ndarray(samples, format="s16", layout="stereo")
            sound.sample_rate, sound.time_base = HZ, Fraction(1, HZ)
            sound.pts = round(HZ * (sound_begins_s or 0.0))
            container.mux(heard.encode(sound))
            container.mux(heard.encode(None))
    return path


def click_s(path: Path) -> float:
    sound = sound_of(path)
    assert sound is not None
    return int(np.argmax(np.abs(sound) > 0.4)) / RATE_HZ


@pytest.mark.parametrize(
    ("sound_s", "pictures_s", "clicks_s"), [(0.0, 0.0, 1.0), (0.5, 0.0, 1.5), (0.0, 0.4, 0.6)]
)
def test_a_video_is_heard_from_the_beginning_of_its_pictures(
    tmp_path: Path, sound_s: float, pictures_s: float, clicks_s: float
) -> None:
    """A sound that begins later is preceded by silence, one that begins sooner is cut."""
    path = written(tmp_path / "a.mkv", sound_begins_s=sound_s, pictures_begin_s=pictures_s)
    assert click_s(path) == pytest.approx(clicks_s, abs=0.005)


def test_what_has_no_sound_or_cannot_be_read_has_none(tmp_path: Path) -> None:
    assert sound_of(written(tmp_path / "silent.mkv", sound_begins_s=None)) is None
    assert sound_of(tmp_path / "missing.mkv") is None
    (tmp_path / "torn.mp4").write_bytes(b"ftyp" * 9)
    assert sound_of(tmp_path / "torn.mp4") is None


def test_no_more_of_a_sound_is_read_than_ten_minutes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    monkeypatch.setattr(sound_of_video, "LONGEST_S", 1.5)
    path = written(tmp_path / "a.mkv", sound_begins_s=0.0)
    monkeypatch.setattr("sys.argv", ["sound_of_video", str(path)])
    sound_of_video.main()
    sys.stdout.flush()
    assert len(capfdbinary.readouterr().out) == 4 * round(1.5 * RATE_HZ)


def test_without_the_library_nothing_is_heard(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = written(tmp_path / "a.mkv", sound_begins_s=0.0)
    monkeypatch.setattr(sound_of_video, "find_spec", lambda name: None)
    assert sound_of(path) is None
