"""A child that somebody else forked, told of as one's own: real processes."""

import ctypes
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pytest

from common.platform.linux import reparenting
from common.platform.linux.reparenting import ReparentedProcess, adopted, adopting

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="parts are adopted on Linux alone")
SPAWN = get_context("spawn")


def child(code: str) -> ReparentedProcess:
    """Of this process, and not multiprocessing's."""
    words = [sys.executable, "-S", "-c", code]
    return ReparentedProcess(os.posix_spawn(sys.executable, words, os.environ))


def test_how_it_ended_is_known_and_asked_again() -> None:
    one = child("raise SystemExit(3)")
    one.join()
    assert (one.exitcode, one.exitcode, one.is_alive()) == (3, 3, False)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_it_is_ended_by_a_signal_which_its_exit_code_tells(number: signal.Signals) -> None:
    one = child("import time; time.sleep(60)")
    began_s = time.monotonic()
    one.join(0.1)
    assert 0.1 <= time.monotonic() - began_s < 5.0
    assert one.is_alive()
    assert one.exitcode is None
    (one.terminate if number is signal.SIGTERM else one.kill)()
    one.join()
    assert one.exitcode == -number
    one.kill()  # its number may be another's by now: nobody is killed


def test_who_dies_before_it_says_its_number_is_not_waited_for() -> None:
    ours, theirs = SPAWN.Pipe(duplex=False)
    theirs.close()
    with pytest.raises(EOFError):
        adopted(SPAWN.Process(), ours)


def test_who_never_says_its_number_is_killed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reparenting, "BORN_S", 0.1)
    ours, _theirs = SPAWN.Pipe(duplex=False)
    born = SPAWN.Process(target=time.sleep, args=(60.0,))
    born.start()
    with pytest.raises(TimeoutError):
        adopted(born, ours)
    born.join()
    assert born.exitcode == -signal.SIGKILL


class Born:
    """A zygote's fork that has said a number."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, float | None]] = []

    def join(self, within_s: float | None = None) -> None:
        self.calls.append(("join", within_s))

    def kill(self) -> None:
        self.calls.append(("kill", None))


def test_who_said_its_number_is_a_child_of_that_number_and_its_parent_is_awaited() -> None:
    ours, theirs = SPAWN.Pipe(duplex=False)
    real = child("raise SystemExit(4)")
    theirs.send(real.pid)
    born: Any = Born()
    one = adopted(born, ours)
    one.join()
    assert (one.pid, one.exitcode) == (real.pid, 4)
    assert born.calls == [("join", reparenting.BORN_S)]


def test_orphans_are_taken_in_meanwhile_and_not_for_longer() -> None:
    """prctl(2): 37 asks whether this process takes orphans in."""
    library = ctypes.CDLL(None)

    def takes_in() -> int:
        told = ctypes.c_int(-1)
        library.prctl(37, ctypes.byref(told), 0, 0, 0)
        return told.value

    before = takes_in()
    with suppress(ValueError), adopting():
        meanwhile = takes_in()
        raise ValueError("it cannot be forked")
    assert (before, meanwhile, takes_in()) == (0, 1, 0)


def test_who_goes_on_as_a_child_of_its_grandparent_is_a_process_of_its_own() -> None:
    """By hand: the first process says the number of the second and is gone; that goes on once it
    has another parent."""
    code = (
        "import os, sys; sys.path.insert(0, sys.argv[1])\n"
        "from common.platform.linux.reparenting import be_adopted\n"
        "class Words:\n"
        "    def send(self, pid): print(os.getpid(), pid, flush=True)\n"
        "first = os.getpid()\n"
        "be_adopted(Words())\n"
        "print(os.getpid(), os.getppid() != first, flush=True)\n"
    )
    root = str(Path(__file__).parents[1])
    done = subprocess.run(
        [sys.executable, "-c", code, root], capture_output=True, text=True, timeout=60, check=True
    )
    first, said, second, moved = done.stdout.split()
    assert said == second != first
    assert moved == "True"
