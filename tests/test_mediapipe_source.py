"""MediaPipe's child, with a stand-in for MediaPipe: real processes that answer, dawdle and die."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import msgspec
import psutil
import pytest
from fake_mediapipe import install_fake, shaded, view_of

from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks
from common.config.part_settings import SettingsError
from viewer.landmarks.mediapipe_source import MediaPipe

WRIST = JOINT_NAMES.index("l_wrist")
WRISTS_PLACE = 15 / 4
"""Columns from the figure's first point to its left wrist, which is taken as it is told."""


def column(people: tuple[Landmarks, ...]) -> float:
    (one,) = people
    return one.joints_px[WRIST][0] - WRISTS_PLACE


def test_every_frame_is_answered_with_what_its_own_picture_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_fake(monkeypatch, tmp_path)
    with MediaPipe(view_of()) as source:
        source.ready()
        seen = [source.people(shaded(t, 10 + t), 10.0) for t in range(20)]
        assert [column(people) for people in seen] == pytest.approx([*range(10, 30)])
        assert source.odd == ()


def test_where_nobody_is_seen_there_is_nobody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_fake(monkeypatch, tmp_path)
    with MediaPipe(view_of()) as source:
        source.ready()
        assert source.people(shaded(0, 0), 10.0) == ()
        assert column(source.people(shaded(1, 7), 10.0)) == pytest.approx(7)


def test_it_looks_at_a_larger_picture_and_tells_pixels_of_the_working_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_fake(monkeypatch, tmp_path)
    with MediaPipe(view_of(source=(128, 96))) as source:
        source.ready()
        assert source.large == (128, 96)
        large = shaded(0, 20, (128, 96)).picture
        both = msgspec.structs.replace(shaded(0, 99), large=large)
        assert column(source.people(both, 10.0)) == pytest.approx((20 - WRISTS_PLACE) / 2)
    with MediaPipe(view_of()) as source:
        assert source.large is None


def test_a_film_larger_than_it_can_use_is_shown_smaller(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_fake(monkeypatch, tmp_path)
    with MediaPipe(view_of(source=(1920, 1080))) as source:
        assert source.large == (640, 360)


def test_a_child_that_dies_is_named_once_and_the_run_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_fake(monkeypatch, tmp_path, doing="shade == 3 and os._exit(9)")
    with MediaPipe(view_of()) as source:
        source.ready()
        assert source.people(shaded(0, 2), 10.0)
        assert [source.people(shaded(t, 3), 10.0) for t in (1, 2, 3)] == [()] * 3
        assert source.odd == ("MediaPipe is gone (exit code 9): camera 1 has no landmarks",)


def test_an_answer_that_is_late_is_let_go_and_the_next_belong_to_their_frames(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_fake(monkeypatch, tmp_path, doing="time.sleep(0.5 * (shade == 3))")
    with MediaPipe(view_of()) as source:
        source.ready()
        began_s = time.monotonic()
        assert source.people(shaded(0, 3), 0.05) == ()
        assert source.people(shaded(1, 4), 0.05) == ()  # it still looks at the frame before
        assert time.monotonic() - began_s < 0.4
        time.sleep(1.0)
        assert column(source.people(shaded(2, 5), 10.0)) == pytest.approx(5)
        (odd,) = source.odd
        assert "too slow for camera 1" in odd


@pytest.mark.slow
def test_a_child_that_is_stuck_is_ended_in_bounded_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_fake(monkeypatch, tmp_path)
    with MediaPipe(view_of(), stall_s=2.0) as source:
        source.ready()
        (child,) = children()
        child.suspend()
        began_s, t = time.monotonic(), 0
        while child.is_running() and time.monotonic() - began_s < 10.0:
            assert source.people(shaded(t, 5), 0.1) == ()
            t += 1
        assert time.monotonic() - began_s < 5.0
        assert "it gave nothing for 2 s" in source.odd[-1]


def children() -> list[psutil.Process]:
    """Those of this process that look by MediaPipe."""
    return [
        child
        for child in psutil.Process().children()
        if "viewer.landmarks.mediapipe_child" in child.cmdline()
    ]


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM], ids=["killed", "ended"])
def test_the_child_ends_with_its_viewer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: signal.Signals
) -> None:
    install_fake(monkeypatch, tmp_path)
    code = (
        "import time\n"
        "from fake_mediapipe import view_of\n"
        "from viewer.landmarks.mediapipe_source import MediaPipe\n"
        "source = MediaPipe(view_of())\n"
        "source.ready()\n"
        "print('ready', flush=True)\n"
        "time.sleep(60)\n"
    )
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) as asker:
        assert asker.stdout is not None
        assert asker.stdout.readline() == b"ready\n"
        (child,) = psutil.Process(asker.pid).children()
        asker.send_signal(number)
    assert psutil.wait_procs([child], 5.0)[1] == []


def test_leaving_it_ends_the_child(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install_fake(monkeypatch, tmp_path)
    with MediaPipe(view_of()) as source:
        source.ready()
        (child,) = children()
    assert not child.is_running()


def test_a_mediapipe_that_does_not_work_is_refused_with_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_fake(monkeypatch, tmp_path, born="raise ImportError('no module named attrs')")
    with (
        pytest.raises(SettingsError, match=r"does not work.*no module named attrs.*pip install"),
        MediaPipe(view_of()) as source,
    ):
        source.ready()


def test_a_mediapipe_that_breaks_at_once_is_refused_likewise(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install_fake(monkeypatch, tmp_path, born="os.abort()")
    with (
        pytest.raises(SettingsError, match=r"does not start \(killed by SIGABRT\): pip install"),
        MediaPipe(view_of()) as source,
    ):
        source.ready()


def test_where_it_is_not_installed_that_is_said_with_the_cure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("viewer.landmarks.mediapipe_source.find_spec", lambda _: None)
    with pytest.raises(SettingsError, match=r"pip install --no-deps mediapipe==0\.10\.21"):
        MediaPipe(view_of())
