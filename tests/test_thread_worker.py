"""A part that is a thread of its supervisor's process, held against one with its own process."""

import subprocess
import sys
import threading
import time

import psutil
import pytest

from common.bus.process import ProcessContext, process
from common.video.clip_sources import ClipError
from runtime.faults import code_of
from runtime.live.process_table import Part, last_words
from runtime.live.supervise import PartFailed, Watched, watched
from runtime.live.thread_worker import KILLED

PATIENCE_S = 20.0


def works(number: int, context: ProcessContext) -> None:
    """A part that works until it is asked to end."""
    with process(f"part {number}", context) as stop:
        stop.wait(PATIENCE_S)


def ends(_number: int, _context: ProcessContext) -> None:
    """A part whose work is done."""


def refuses(_number: int, _context: ProcessContext) -> None:
    """A part that cannot work."""
    raise ClipError("no such clip: name another")


def part(main: object, number: int = 1) -> Part:
    return Part(f"part {number}", main, (number, ProcessContext(True)), beside=True)  # type: ignore[arg-type]


def ended(one: Watched) -> int | None:
    one.running.process.join(PATIENCE_S)
    return one.running.process.exitcode


def test_it_is_a_thread_and_ends_alone_when_it_is_asked_to() -> None:
    with watched(part(works, 1)) as first, watched(part(works, 2)) as second:
        assert first.running.process.pid == psutil.Process().pid
        assert {"part 1", "part 2"} <= {each.name for each in threading.enumerate()}
        assert first.end() == ""
        assert (ended(first), first.done) == (0, True)
        assert second.running.process.is_alive()
    assert not second.running.process.is_alive()


def test_one_whose_work_is_done_has_ended() -> None:
    with watched(part(ends)) as one:
        assert ended(one) == 0
        assert one.look(time.monotonic(), {}) == ""
        assert one.done


def test_one_that_fails_says_why_as_a_process_would() -> None:
    with watched(part(refuses)) as one:
        assert ended(one) == code_of(ClipError(""))
        with pytest.raises(PartFailed, match="part 1: no such clip: name another"):
            one.look(time.monotonic(), {})
    with watched(part(refuses)) as one:
        ended(one)
        assert last_words(one.running) == "no such clip: name another"


def test_one_that_hangs_is_killed_with_its_process() -> None:
    """No thread can be ended from outside: whoever serves the room starts it again."""
    script = (
        "import time; from runtime.live.process_table import Part, end, started\n"
        "end(started(Part('deaf', time.sleep, (60.0,), beside=True, end_s=0.2)))"
    )
    done = subprocess.run([sys.executable, "-c", script], timeout=PATIENCE_S, check=False)
    assert done.returncode == KILLED
