"""The command that records: what it asks for, and what it says of each camera."""

from pathlib import Path
from typing import Any

import pytest
from typed import instead, typed

from common.video.clip_sources import ClipError
from tritrack.commands.record_command import lines_of, record
from tritrack.machine_cameras import camera_list

FACTS: dict[str, Any] = {
    "folder": "clips/walk",
    "seconds": 30.02,
    "why": "the time is over",
    "cameras": {
        "cam1": {"source": "camera 0", "frames": 900, "fps": 30.0, "dropped": 0, "fault": ""},
        "cam2": {"source": "camera 2", "frames": 880, "fps": 29.97, "dropped": 19, "fault": ""},
        "cam3": {"source": "b.avi", "frames": 450, "fps": 15.0, "dropped": 0, "fault": ""},
    },
    "later_s": {"cam2": 0.045, "cam3": None},
}


def test_each_camera_has_a_line() -> None:
    assert lines_of(FACTS) == [
        "clips/walk: 30.0 s, the time is over",
        "cam1 (camera 0): 900 frames, 30.00 a second",
        "cam2 (camera 2): 880 frames, 29.97 a second, 19 missing; it shows motion +0.045 s after "
        "cam1",
        "cam3 (b.avi): 450 frames, 15.00 a second; how late it is, its motion does not say",
    ]


def test_numbers_are_devices_and_paths_are_videos(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    called = instead(monkeypatch, "tritrack.recording_cameras.record_clip.record_clip", FACTS)
    out = tmp_path / "walk"
    words = ("--camera", 2, "--camera", "b.avi", "--seconds", 5, "--force")
    assert typed(record, "--out", out, *words).exit_code == 0
    sources, folder, seconds, _, _, force, _ = called.last
    assert (sources, folder, seconds, force) == ([2, "b.avi"], out, 5.0, True)


def test_without_a_camera_it_is_said_what_to_do(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(camera_list, "cameras_of", lambda _: [])
    with pytest.raises(ClipError, match="has no camera that the system knows"):
        record(tmp_path / "walk")
