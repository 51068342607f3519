"""A process has the name that a user looks for, and does not outlive its parent."""

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import psutil
import pytest

from common.platform.linux.own_process import end_with_parent
from runtime.live.process_table import Part, end, started

SOON_S = 10.0
PR_GET_PDEATHSIG = 2
"""prctl(2)."""
PATIENCE_S = 60.0

PARENT = """
import sys, time
from pathlib import Path
from test_own_process import sleeps
from runtime.live.process_table import Part, started
if __name__ == "__main__":
    child = started(Part("viewer 1", sleeps, (sys.argv[1],)))
    time.sleep(600)
"""


def sleeps(word: str) -> None:
    """A part that has begun to work."""
    Path(word).write_text(str(os.getpid()))
    time.sleep(600.0)


def ended_within(pid: int, wait_s: float) -> bool:
    until_s = time.monotonic() + wait_s
    while time.monotonic() < until_s:
        try:
            if psutil.Process(pid).status() == psutil.STATUS_ZOMBIE:
                return True
        except psutil.NoSuchProcess:
            return True
        time.sleep(0.02)
    return False


def written(path: Path) -> int:
    until_s = time.monotonic() + PATIENCE_S
    while not path.is_file() or not path.read_text():
        assert time.monotonic() < until_s
        time.sleep(0.02)
    return int(path.read_text())


@pytest.mark.parametrize("stopped", [False, True], ids=["works", "is stopped"])
def test_a_part_ends_when_its_supervisor_is_killed(tmp_path: Path, stopped: bool) -> None:
    """A process that was stopped runs no thread that could see it: Linux itself kills it."""
    script = tmp_path / "parent.py"
    script.write_text(PARENT)
    path = os.pathsep.join((str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")))
    parent = subprocess.Popen(
        [sys.executable, str(script), str(tmp_path / "pid")], env={**os.environ, "PYTHONPATH": path}
    )
    pid = written(tmp_path / "pid")
    if stopped:
        os.kill(pid, signal.SIGSTOP)
    parent.kill()
    parent.wait()
    assert ended_within(pid, SOON_S)


def test_a_part_whose_supervisor_lives_lives(tmp_path: Path) -> None:
    one = started(Part("viewer 1", sleeps, (str(tmp_path / "pid"),)))
    try:
        assert not ended_within(written(tmp_path / "pid"), 0.5)
    finally:
        end(one)


def test_a_process_that_nobody_started_so_is_left_alone() -> None:
    end_with_parent()
    told = ctypes.c_int(-1)
    ctypes.CDLL(None).prctl(PR_GET_PDEATHSIG, ctypes.byref(told))
    assert told.value == 0
    assert "parent's death" not in [thread.name for thread in threading.enumerate()]


def test_a_child_that_works_ends_with_its_pipe() -> None:
    """It reads nothing at the moment, as a decoder that waits for a camera."""
    code = (
        "import sys, time; from common.platform.linux.own_process import end_with_pipe; "
        "end_with_pipe(sys.stdin.fileno()); print('up', flush=True); time.sleep(600)"
    )
    child = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert child.stdin is not None
    assert child.stdout is not None
    assert child.stdout.readline() == b"up\n"
    child.stdin.write(b"a line that is not read\n")
    child.stdin.flush()
    with pytest.raises(subprocess.TimeoutExpired):
        child.wait(0.3)
    child.stdin.close()
    child.wait(SOON_S)


@pytest.mark.skipif(sys.platform != "linux", reason="the name is set on Linux alone")
@pytest.mark.parametrize(("name", "shown"), [("viewer 1", "viewer 1"), ("s" * 20, "s" * 15)])
def test_ps_shows_the_name(name: str, shown: str) -> None:
    code = (
        "import os, subprocess; from common.platform.linux.own_process import be_shown_as\n"
        f"be_shown_as({name!r})\n"
        "print(subprocess.check_output(['ps', '-o', 'comm=', '-p', str(os.getpid())], text=True))"
    )
    said = subprocess.check_output([sys.executable, "-c", code], text=True)
    assert said.strip() == shown
