"""How a worker is begun on Linux: what it takes over, whose child it becomes, what it hears."""

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import pytest

from common.platform.environment import FRUGAL
from common.platform.linux import part_process, zygote
from common.platform.linux.part_process import begun
from common.platform.linux.zygote import Zygote
from common.platform.platform import Job, Started


def works() -> None:
    """What a worker does."""


def test_a_worker_whose_zygote_dies_is_a_new_python(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[str, bool]] = []

    def start(job: Job, forked: bool) -> str:
        asked.append((job.name, forked))
        if forked and job.name == "lost":
            raise EOFError
        return job.name

    monkeypatch.setattr(zygote, "begun", start)
    own = Zygote.__new__(Zygote)
    own.warm = False
    jobs = [Job(name, works, ()) for name in ("cold", "warm", "lost")]
    given: list[Any] = [own.start(jobs[0])]
    own.warm = True
    given += [own.start(job) for job in jobs[1:]]
    assert given == ["cold", "warm", "lost"]
    assert asked == [("cold", False), ("warm", True), ("lost", True), ("lost", False)]


class End:
    def __init__(self) -> None:
        self.closed = False

    def close(self) -> None:
        self.closed = True


class Context:
    """Starts nothing: what it is asked, and how the supervisor is at that moment."""

    def __init__(self) -> None:
        self.ours, self.theirs = End(), End()
        self.asked: dict[str, Any] = {}
        self.at_start: tuple[dict[str, str], set[Any], list[str]] | None = None
        self.doors: list[str] = []

    def Pipe(self, duplex: bool) -> tuple[End, End]:
        assert not duplex
        return self.ours, self.theirs

    def Process(self, **asked: Any) -> "Context":
        self.asked = asked
        return self

    def start(self) -> None:
        deaf = signal.pthread_sigmask(signal.SIG_BLOCK, ())
        self.at_start = (dict(os.environ), deaf, [*self.doors])
        assert not self.theirs.closed

    @contextmanager
    def adopting(self) -> Iterator[None]:
        self.doors.append("adopting")
        yield
        self.doors.append("adopted")


@pytest.mark.parametrize("forked", [True, False])
@pytest.mark.parametrize("nests", [True, False])
def test_a_part_is_begun_frugal_and_deaf_and_adopted_where_it_is_forked(
    monkeypatch: pytest.MonkeyPatch, forked: bool, nests: bool
) -> None:
    context: Any = Context()
    monkeypatch.setattr(part_process, "adopting", context.adopting)
    monkeypatch.setattr(part_process, "adopted", lambda *of: ("child", of))
    if forked:
        monkeypatch.setattr(part_process, "FORK", context)
    else:
        monkeypatch.setattr(part_process, "SPAWN", context)
    before = signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT, signal.SIGHUP))
    running = begun(Job("viewer 1", works, ("given",), nests), forked)
    after = signal.pthread_sigmask(signal.SIG_SETMASK, before)
    assert not {signal.SIGINT, signal.SIGHUP} & after
    assert context.asked == {
        "name": "viewer 1",
        "target": part_process._run,
        "args": ("viewer 1", works, ("given",), context.theirs, forked),
        "daemon": not nests,
    }
    process: Any = ("child", (context, context.ours)) if forked else context
    assert running == Started(process, context.ours)
    assert (context.theirs.closed, context.ours.closed) == (True, False)
    environment, deaf, doors = context.at_start
    assert environment["MALLOC_ARENA_MAX"] == environment["OPENBLAS_NUM_THREADS"] == "1"
    assert {signal.SIGINT, signal.SIGHUP} <= deaf
    assert doors == (["adopting"] if forked else [])
    assert context.doors == (["adopting", "adopted"] if forked else [])


def test_what_is_taken_over_is_the_supervisors_own_again_afterwards(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One who is deaf to a hang-up himself stays so; starting the tracker lifts the block."""
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    at_start: list[set[Any]] = []

    def ensure_running() -> None:
        at_start.append(signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT,)))

    monkeypatch.setattr("multiprocessing.resource_tracker.ensure_running", ensure_running)
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGHUP,))
    signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT,))
    try:
        with suppress(OSError), part_process.inherited():
            deaf = signal.pthread_sigmask(signal.SIG_BLOCK, ())
            told = {name: os.environ[name] for name in FRUGAL}
            os.environ["LEFT_BEHIND"] = "1"
            raise OSError("no process")
    finally:
        after = signal.pthread_sigmask(signal.SIG_SETMASK, before)
    assert told == {
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "NUMBA_NUM_THREADS": "1",
        "MALLOC_ARENA_MAX": "1",
    }
    assert {signal.SIGINT, signal.SIGHUP} <= at_start[0]
    assert {signal.SIGINT, signal.SIGHUP} <= deaf
    assert signal.SIGTERM not in deaf
    assert (signal.SIGHUP in after, signal.SIGINT in after) == (True, False)
    assert os.environ["OMP_NUM_THREADS"] == "7"
    assert "NUMBA_NUM_THREADS" not in os.environ
    assert "LEFT_BEHIND" not in os.environ


@pytest.mark.parametrize("aside", [False, True], ids=["main thread", "another"])
def test_a_ctrl_c_that_a_worker_does_not_hear_ends_none_that_starts_a_worker(
    monkeypatch: pytest.MonkeyPatch, aside: bool
) -> None:
    """It came while the first run was about to compile; starting the tracker lets it through. A
    thread aside cannot keep it off, and starts its worker yet."""
    lifted: list[bool] = []

    def ensure_running() -> None:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT,))
        lifted.append(True)

    def starts() -> None:
        signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT,))
        if not aside:
            signal.raise_signal(signal.SIGINT)
        with part_process.inherited():
            pass

    monkeypatch.setattr("multiprocessing.resource_tracker.ensure_running", ensure_running)
    handler, before = signal.getsignal(signal.SIGINT), signal.pthread_sigmask(signal.SIG_BLOCK, ())
    try:
        if aside:
            thread = threading.Thread(target=starts)
            thread.start()
            thread.join()
        else:
            starts()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    assert lifted == [True]
    assert signal.getsignal(signal.SIGINT) is handler


@pytest.mark.parametrize("forked", [True, False])
def test_a_worker_runs_under_its_name_and_hears_its_end(
    monkeypatch: pytest.MonkeyPatch, forked: bool
) -> None:
    called: list[Any] = []
    words: Any = object()
    for name in ("be_adopted", "be_shown_as", "end_with_parent"):
        monkeypatch.setattr(part_process, name, lambda *of, name=name: called.append((name, *of)))

    def main(*arguments: Any) -> None:
        deaf = signal.pthread_sigmask(signal.SIG_BLOCK, ())
        called.append((arguments, signal.SIGTERM in deaf))

    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGTERM,))
    try:
        part_process._run("viewer 1", main, ("a", 2), words, forked)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    began: list[Any] = [("be_adopted", words)] if forked else []
    began += [("be_shown_as", "viewer 1"), ("end_with_parent",)]
    assert called == [*began, (("a", 2, words), False)]
