"""What every process does alike: end on a signal, beat once a second, keep a log."""

import logging
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import cv2
import psutil
import pytest
from local_bus import LocalBus

from common.bus.bus import Stopped, open_client
from common.bus.control_messages import Pulse
from common.bus.process import BEAT_S, Heart, ProcessContext, logged, process, start_log
from common.bus.rate import Pace
from common.config.part_settings import BusSettings


@pytest.fixture(autouse=True)
def logs_as_before() -> Iterator[None]:
    """The root logger is everybody's."""
    handlers, level = logging.root.handlers[:], logging.root.level
    yield
    logging.root.handlers[:] = handlers
    logging.root.setLevel(level)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=["SIGTERM", "Ctrl-C"])
def test_a_signal_ends_a_process_that_runs_alone(number: signal.Signals) -> None:
    with process("viewer 1", ProcessContext()) as stop:
        os.kill(os.getpid(), number)
        assert stop.wait(5.0)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT], ids=["SIGTERM", "Ctrl-C"])
def test_a_signal_ends_a_process_that_waits_for_the_others(number: signal.Signals) -> None:
    """Nobody listens at that endpoint: whoever gives up does not sit out the minute."""
    began_s, nowhere = time.monotonic(), BusSettings(endpoint="tcp/127.0.0.1:1")
    with process("viewer 1", ProcessContext()) as stop:
        threading.Timer(0.3, os.kill, (os.getpid(), number)).start()
        with open_client(nowhere, "room", 60.0, stop=stop):
            pytest.fail("there is no hub")
    assert time.monotonic() - began_s < 5.0


def test_ctrl_c_is_the_supervisors_to_hear() -> None:
    with process("viewer 1", ProcessContext(supervised=True)) as stop:
        os.kill(os.getpid(), signal.SIGINT)
        assert not stop.is_set()
        os.kill(os.getpid(), signal.SIGTERM)
        assert stop.wait(5.0)


def test_signals_mean_afterwards_what_they_meant_before() -> None:
    before = signal.getsignal(signal.SIGTERM), signal.getsignal(signal.SIGINT)
    with pytest.raises(RuntimeError), process("viewer 1", ProcessContext()):
        raise RuntimeError
    assert (signal.getsignal(signal.SIGTERM), signal.getsignal(signal.SIGINT)) == before


def test_all_processes_append_to_one_log_by_name(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "log.txt"
    for name in ("viewer 1", "integrator"):
        start_log(name, path)
        logging.getLogger("x").warning("hello from %s", name)
        logging.getLogger("x").debug("not wanted")
    lines = path.read_text().splitlines()
    assert [line.split("WARNING")[1].strip() for line in lines] == [
        "hello from viewer 1",
        "hello from integrator",
    ]
    assert " viewer 1 " in lines[0]


def test_the_log_level_comes_from_the_command_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TRITRACK_LOG", "debug")
    start_log("viewer 1", tmp_path / "log.txt")
    logging.getLogger("x").debug("wanted now")
    assert "wanted now" in (tmp_path / "log.txt").read_text()


def test_a_heart_beats_once_a_second_and_at_every_change(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = [100.0]
    monkeypatch.setattr("common.bus.process.time.monotonic", lambda: now_s[0])
    bus = LocalBus()
    heard = bus.subscribe(Pulse)
    heart = Heart(bus, "viewer 1", Pace(1 / 15))
    heart.beat("ready", "odd")
    for _ in range(44):  # three seconds of frames, the last one short
        now_s[0] += 1 / 15
        heart.beat("running", dropped=2)
    heart.beat("ended")
    pulses = heard.drain()
    assert [pulse.state for pulse in pulses] == ["ready", "running", "running", "ended"]
    assert pulses[0].detail == "odd"
    assert (pulses[1].process, pulses[1].dropped) == ("viewer 1", 2)
    assert pulses[1].memory_mb > 10
    assert BEAT_S == 1.0


def test_a_heart_tells_what_its_pace_counts_and_hurries_where_there_is_news(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Ten frames of 0.1 s that are done 10, 20, 30 ms after they were due, the last 300."""
    now_s = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now_s[0])
    bus, pace = LocalBus(), Pace(0.1)
    heard = bus.subscribe(Pulse)
    for n in range(10):
        pace.done(0.1 * n, 0.1 * n + (0.3 if n == 9 else 0.01 * (n + 1)))
    heart = Heart(bus, "viewer 2", pace)
    heart.beat("running")
    now_s[0] += 0.5
    heart.beat("running", "not yet")
    heart.hurry()
    heart.beat("running", "now", malformed=3)
    first, second = heard.drain()
    assert (first.frames, first.deadline_misses, first.detail) == (10, 1, "")
    assert (first.latency_p50_ms, first.latency_p99_ms) == pytest.approx((50.0, 300.0))
    assert first.fps == pytest.approx(9 / 1.19)
    assert (second.detail, second.malformed) == ("now", 3)


def test_a_thread_has_no_memory_of_its_own_and_a_process_has_megabytes() -> None:
    bus = LocalBus()
    heard, heart = bus.subscribe(Pulse), Heart(bus, "metrics", Pace(1.0))
    heart.beat("ready")
    thread = threading.Thread(target=heart.beat, args=("ended",))
    thread.start()
    thread.join()
    own, none = (pulse.memory_mb for pulse in heard.drain())
    rss = psutil.Process().memory_info().rss
    assert own == pytest.approx(rss / 1e6, rel=0.1)
    assert none == 0.0


def test_a_part_within_its_supervisors_process_leaves_signals_and_log_alone(tmp_path: Path) -> None:
    stop, log = threading.Event(), tmp_path / "log.txt"
    signals = signal.getsignal(signal.SIGTERM), signal.getsignal(signal.SIGINT)
    cv2.setNumThreads(2)
    with process("metrics", ProcessContext(log=log, stop=stop)) as own:
        assert own is stop
        assert cv2.getNumThreads() == 1
        assert (signal.getsignal(signal.SIGTERM), signal.getsignal(signal.SIGINT)) == signals
        raise Stopped
    assert not log.exists()


def test_who_is_stopped_leaves_in_order_and_a_fault_is_not_swallowed() -> None:
    with process("viewer 1", ProcessContext()):
        raise Stopped
    for context in (ProcessContext(), ProcessContext(stop=threading.Event())):
        with pytest.raises(RuntimeError), process("viewer 1", context):
            raise RuntimeError


def test_a_line_of_the_log_has_its_time_its_process_and_its_level(tmp_path: Path) -> None:
    start_log("viewer 1", tmp_path / "log.txt", "WARNING")
    logging.getLogger("x").info("not wanted")
    logging.getLogger("x").error("broken")
    (line,) = (tmp_path / "log.txt").read_text().splitlines()
    assert re.fullmatch(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d,\d{3} viewer 1    ERROR   broken", line)


def test_what_the_supervisor_logs_goes_to_the_runs_log_alone_while_it_runs(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """And nothing of the parts, which may be threads of its process."""
    path, own = tmp_path / "log.txt", logging.getLogger("runtime")
    with logged("supervisor", path):
        own.warning("within")
        logging.getLogger("runtime.live.launch").warning("deeper")
        logging.getLogger("viewer.__main__").warning("of a part")
    own.warning("after")
    lines = path.read_text().splitlines()
    assert [line.split(" supervisor  WARNING ")[1] for line in lines] == ["within", "deeper"]
    assert caplog.messages == ["of a part", "after"]
    assert own.propagate
    assert not own.handlers
    assert str(path) not in [file.path for file in psutil.Process().open_files()]


SETTLING = """
import gc, psutil
from common.bus.process import settle
own = psutil.Process()
taken = [bytearray(2000) for _ in range(30_000)]
kept = taken[::100]
before = own.memory_info().rss
del taken
settle()
print(before - own.memory_info().rss > 40e6, gc.get_freeze_count() > 1000, len(kept))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="of glibc alone it is known how")
def test_holes_of_the_heap_are_given_back_while_something_behind_them_is_held() -> None:
    done = subprocess.run(
        [sys.executable, "-c", SETTLING], check=True, capture_output=True, text=True
    )
    assert done.stdout == "True True 300\n"
