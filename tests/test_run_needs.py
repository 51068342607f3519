"""What a live run needs, looked over: each planted fault is found by name."""

import shutil
import socket
import time
from pathlib import Path

import msgspec
import pytest

from common.config.part_settings import BusSettings, CameraSettings, PageSettings
from common.config.settings import Settings
from runtime.live.free_ports import free_settings
from tritrack.doctor.installation import Finding, refused
from tritrack.doctor.run_needs import examine_run


def found(settings: Settings, out: Path) -> dict[str, Finding]:
    return {finding.what: finding for finding in examine_run(settings, out)}


def faults(settings: Settings, out: Path) -> set[str]:
    return {what for what, finding in found(settings, out).items() if not finding.ok}


@pytest.fixture
def sound(tmp_path: Path) -> Settings:
    """Of two films that open."""
    import cv2
    import numpy as np

    for number in (1, 2):
        kind = cv2.VideoWriter.fourcc(*"MJPG")
        film = cv2.VideoWriter(str(tmp_path / f"cam{number}.avi"), kind, 15, (64, 48))
        for _ in range(3):
            film.write(np.full((48, 64, 3), 90 * number, np.uint8))
        film.release()
    return free_settings(Settings(clip=str(tmp_path)))


def test_a_run_that_lacks_nothing_is_found_sound(sound: Settings, tmp_path: Path) -> None:
    assert faults(sound, tmp_path / "runs" / "live") == set()
    assert found(sound, tmp_path)["pictures"].detail.startswith("view 1: 64x48, 15 a second, view")


def test_a_port_that_is_taken_is_named(sound: Settings, tmp_path: Path) -> None:
    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        port = holder.getsockname()[1]
        bus = BusSettings(endpoint=f"tcp/127.0.0.1:{port}")
        held = Settings(clip=sound.clip, bus=bus, page=PageSettings(port=port))
        seen = found(held, tmp_path)
    assert {what for what, one in seen.items() if not one.ok} == {
        "port of the bus",
        "port of the page",
    }
    assert f"127.0.0.1:{port}" in seen["port of the bus"].detail
    assert "set another [bus] endpoint" in seen["port of the bus"].cure


def test_metrics_are_looked_at_only_where_there_are_some(sound: Settings, tmp_path: Path) -> None:
    assert "port of the metrics" not in found(sound, tmp_path)
    metered = msgspec.structs.replace(sound, metrics="127.0.0.1:9464")
    assert "port of the metrics" in found(metered, tmp_path)


def test_a_camera_that_is_missing_is_named(sound: Settings, tmp_path: Path) -> None:
    (tmp_path / "cam2.avi").unlink()
    gone = CameraSettings(source=str(tmp_path / "cam2.avi"))
    nowhere = Settings(clip=sound.clip, bus=sound.bus, page=sound.page, cameras={"cam2": gone})
    seen = found(nowhere, tmp_path)
    assert not seen["pictures"].ok
    assert "cam2.avi" in seen["pictures"].detail


def test_three_cameras_without_a_calibration_are_named(sound: Settings, tmp_path: Path) -> None:
    (tmp_path / "cam3.avi").write_bytes((tmp_path / "cam2.avi").read_bytes() + bytes(1))
    seen = found(sound, tmp_path)
    assert not seen["pictures"].ok
    assert "3 cameras need a calibration" in seen["pictures"].detail


def test_a_disk_that_is_full_is_named(
    sound: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    usage = shutil.disk_usage(tmp_path)._replace(free=10_000_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage)
    assert faults(sound, tmp_path) == {"disk"}


def test_a_clock_that_was_never_set_is_named(
    sound: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(time, "time", lambda: 86_400.0)
    assert faults(sound, tmp_path) == {"clock"}


@pytest.mark.parametrize(
    ("said", "detail", "cure"),
    [
        ("x is held: another run; end that", "x is held: another run", "end that"),
        ("there is no file x: check the path", "there is no file x", "check the path"),
        ("cam1: R is no rotation: calibrate", "cam1: R is no rotation", "calibrate"),
        ("no sockets", "no sockets", "mend that"),
    ],
)
def test_what_is_refused_is_parted_into_fault_and_cure(said: str, detail: str, cure: str) -> None:
    finding = refused("port", ValueError(said))
    assert (finding.ok, finding.detail, finding.cure) == (False, detail, cure)


def test_a_film_that_is_none_is_named_with_the_whole_cure(sound: Settings, tmp_path: Path) -> None:
    (tmp_path / "cam2.avi").write_bytes(b"RIFF no film")
    pictures = found(sound, tmp_path)["pictures"]
    assert pictures.detail.endswith("cam2.avi gives no picture")
    assert pictures.cure.startswith("convert it, for example to MJPEG (ffmpeg -i")
