"""What every process does alike: end on a signal, beat once a second, keep a log."""

import logging
import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from local_bus import LocalBus

from common.bus.bus import open_client
from common.bus.control_messages import Pulse
from common.bus.process import BEAT_S, Heart, ProcessContext, process, start_log
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
