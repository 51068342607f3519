"""Live runs as a user starts and ends them: signals, one camera, what is told and written."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest
from rich.console import Console
from spoiling import copied, cut_off, edit_json, uncalibrated
from waiting import until_of

from common.bus.control_messages import Pulse
from common.config.part_settings import PageSettings
from common.config.settings import Settings
from common.video.clip_sources import ClipError
from runtime.live.admission import LiveRefused
from runtime.live.free_ports import free_settings, refuse_held_ports
from runtime.live.screen import warnings_of
from runtime.live.session import live
from runtime.store.journal import Head, Journal
from runtime.store.past_journal import read_journal
from runtime.store.past_run import open_run


def settings_of(clip: Path) -> Settings:
    return free_settings(Settings(clip=str(clip), page=PageSettings(port=0)))


def pulse(process: str, detail: str) -> Pulse:
    return Pulse(process=process, state="running", detail=detail)


def test_warnings_come_from_viewers_and_integrator_a_line_each() -> None:
    pulses = {
        "viewer 2": pulse("viewer 2", "no empty room\ncut off"),
        "integrator": pulse("integrator", "no calibration"),
        "animator": pulse("animator", "http://127.0.0.1:8080"),
        "viewer 1": pulse("viewer 1", ""),
    }
    assert warnings_of(pulses) == ["no calibration", "no empty room", "cut off"]


def test_the_thesis_mode_of_a_settings_file_is_refused_live(tmp_path: Path) -> None:
    with pytest.raises(LiveRefused, match="tritrack single VIDEO --mode thesis"):
        live(Settings(mode="thesis"), tmp_path / "run", Console(quiet=True))
    assert not (tmp_path / "run").exists()


def test_a_run_that_cannot_begin_leaves_what_one_that_was_killed_said(tmp_path: Path) -> None:
    """Its journal stands in the folder yet; of a run that ended the next one has the log."""
    log = tmp_path / "log.txt"
    nothing = Settings(clip=str(tmp_path / "none"), page=PageSettings(port=0))
    log.write_text("it ran out of memory\n")
    journal = Journal(tmp_path, Head(settings=nothing, facts={}))
    with pytest.raises(ClipError):
        live(free_settings(nothing), tmp_path, Console(quiet=True))
    assert "it ran out of memory\n" in log.read_text()
    journal.remove()
    with pytest.raises(ClipError):
        live(free_settings(nothing), tmp_path, Console(quiet=True))
    assert "it ran out of memory\n" not in log.read_text()


def test_free_settings_open_no_page_where_none_was_wanted() -> None:
    assert free_settings(Settings(page=PageSettings(port=0))).page.port == 0
    first, second = free_settings(Settings()), free_settings(Settings())
    assert first.page.port != 0
    assert len({first.bus.endpoint, second.bus.endpoint}) == 2


def slowed(clip: Path, folder: Path, rate_hz: float) -> Path:
    """The clip at another rate, with which a busy machine keeps up."""
    copied(clip, folder)
    edit_json(folder / "meta.json", lambda meta: meta.update(fps=rate_hz))
    return folder


@pytest.mark.slow
@pytest.mark.live
def test_each_oddity_is_told_once_and_kept_in_the_summary(
    clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = slowed(clip, tmp_path / "odd [x]", 7.5)  # slower, the person would tell the rig
    uncalibrated(folder)
    cut_off(folder)
    facts = live(settings_of(folder), tmp_path / "out", Console(stderr=True))
    said = capsys.readouterr()
    told = [line for line in said.err.splitlines() if line.startswith("warning: ")]
    assert sorted(told) == sorted(f"warning: {text}" for text in facts["warnings"])
    for oddity in (
        "no calibration",
        r"odd \[x\]/cam2.avi was cut off or is damaged: \d+ of 69 frames could be read",
        r"view 2 is lost \(its clip is over\)",
        r"the rig stayed assumed: both cameras saw somebody move for \d+ s, of 4 needed",
    ):
        assert len([line for line in told if re.search(oddity, line)]) == 1, told
    assert len(told) == 4
    assert said.out == ""
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["warnings"] == facts["warnings"]
    assert summary["scale_source"] == "assumed"
    for process in ("viewer 1", "viewer 2", "integrator", "recognizer"):
        assert {"frames", "fps", "dropped", "latency_p99_ms", "memory_mb"} <= set(
            summary["processes"][process]
        )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "whole_group"),
    [(signal.SIGINT, True), (signal.SIGTERM, False)],
    ids=["Ctrl-C", "SIGTERM"],
)
@pytest.mark.parametrize("moment", ["starting", "tracking"])
def test_a_deliberate_end_is_no_failure(
    clip: Path, tmp_path: Path, number: signal.Signals, whole_group: bool, moment: str
) -> None:
    """The processes end in order, the run folder is written, the exit code is 0, nobody is left.

    A terminal sends Ctrl-C to the whole group; a service manager ends the supervisor alone.
    """
    slow = slowed(clip, tmp_path / "slow", 5.0)
    settings = settings_of(slow)
    text = f'clip = "{slow}"\n[page]\nport = 0\n[bus]\nendpoint = "{settings.bus.endpoint}"\n'
    (tmp_path / "run.toml").write_text(text)
    out, log = tmp_path / "out", tmp_path / "out" / "log.txt"
    words = ["live", str(tmp_path / "run.toml"), "--out", str(out)]
    run = subprocess.Popen(
        [sys.executable, "-m", "tritrack", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    if moment == "tracking":
        until_of(run, lambda: measured(out), log)
    else:
        until_of(run, log.is_file, log)
        time.sleep(0.5)
    children = psutil.Process(run.pid).children(recursive=True)
    (os.killpg if whole_group else os.kill)(run.pid, number)
    said, errors = run.communicate(timeout=60)
    assert (run.returncode, said) == (0, "")
    assert "Traceback" not in errors
    assert "error" not in errors
    assert {path.name for path in out.iterdir()} == {
        "poses.npz",
        "summary.json",
        "posture.json",
        "log.txt",
    }
    assert [child for child in children if lives(child)] == []
    with np.load(out / "poses.npz", allow_pickle=False) as found:
        assert len(found["frame"]) < 69
        assert (len(found["frame"]) > 0) == (moment == "tracking")


@pytest.mark.slow
def test_what_was_measured_outlives_a_run_that_is_killed(clip: Path, tmp_path: Path) -> None:
    """Its processes end with it, its ports are free, and its folder is read as any other."""
    slow, out = slowed(clip, tmp_path / "slow", 5.0), tmp_path / "out"
    settings = settings_of(slow)
    text = f'clip = "{slow}"\n[page]\nport = 0\n[bus]\nendpoint = "{settings.bus.endpoint}"\n'
    (tmp_path / "run.toml").write_text(text)
    words = ["live", str(tmp_path / "run.toml"), "--out", str(out)]
    run = subprocess.Popen(
        [sys.executable, "-m", "tritrack", *words], stderr=subprocess.PIPE, text=True
    )
    until_of(run, lambda: measured(out) > 5, out / "log.txt")
    children = psutil.Process(run.pid).children(recursive=True)
    run.kill()
    run.wait()
    time.sleep(1.0)
    assert [child for child in children if lives(child)] == []
    refuse_held_ports(settings)
    assert not (out / "poses.npz").exists()
    found = open_run(out)
    assert len(found.poses["frame"]) > 5
    assert "cut short" in found.summary["warnings"][0]


def measured(out: Path) -> int:
    """Bodies of a run that goes on."""
    told = read_journal(out)
    return 0 if told is None else len([*told.bodies])


def lives(child: psutil.Process) -> bool:
    """Whether it still runs a second later; one that waits to be reaped by init does not."""
    try:
        child.wait(timeout=1.0)
    except psutil.TimeoutExpired:
        return bool(child.status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False
    return False
