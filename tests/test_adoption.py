"""A child that somebody else forked, told of as one's own: real processes."""

import os
import signal
import sys
import time
from multiprocessing import get_context

import pytest

from tritrack.forking import adoption
from tritrack.forking.adoption import Adopted, adopted

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="parts are adopted on Linux alone")
SPAWN = get_context("spawn")


def child(code: str) -> Adopted:
    """Of this process, and not multiprocessing's."""
    words = [sys.executable, "-S", "-c", code]
    return Adopted(os.posix_spawn(sys.executable, words, os.environ))


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
    monkeypatch.setattr(adoption, "BORN_S", 0.1)
    ours, _theirs = SPAWN.Pipe(duplex=False)
    born = SPAWN.Process(target=time.sleep, args=(60.0,))
    born.start()
    with pytest.raises(TimeoutError):
        adopted(born, ours)
    born.join()
    assert born.exitcode == -signal.SIGKILL
