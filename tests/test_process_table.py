"""The table of a live run: who is started in which order, of what, and how one is ended."""

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import pytest

from common.bus.process import ProcessContext
from common.config.settings import Settings
from common.video.clip_facts import Clip, Meta, View
from runtime.forking.zygote import FORK, SPAWN
from runtime.live import process_table
from runtime.live.process_table import (
    END_S,
    Part,
    Running,
    animator_main,
    end,
    integrator_main,
    last_words,
    live_parts,
    metrics_main,
    names_of,
    page_part,
    recognizer_main,
    viewer_main,
)

CONTEXT = ProcessContext()


def clip(*numbers: int) -> Clip:
    """Views of 30 frames a second, of which every second is taken."""
    views = [View(n, f"cam{n}.avi", (160, 120), (160, 120), 30.0, 9) for n in numbers]
    return Clip("room", tuple(views), 2, None, Meta())


def test_who_listens_comes_before_who_speaks_and_the_run_lasts_as_long_as_its_viewers() -> None:
    settings, of, zygote = Settings(metrics="127.0.0.1:1"), clip(1, 2), object()
    parts = live_parts(settings, of, CONTEXT, zygote, True)  # type: ignore[arg-type]
    assert [(part.name, part.main, part.arguments) for part in parts] == [
        ("integrator", integrator_main, (settings, of, CONTEXT)),
        ("recognizer", recognizer_main, (settings, 2 / 30, CONTEXT)),
        ("metrics", metrics_main, (settings, names_of(of), CONTEXT)),
        ("viewer 1", viewer_main, (settings, 1, CONTEXT)),
        ("viewer 2", viewer_main, (settings, 2, CONTEXT)),
    ]
    assert [part.leads for part in parts] == [False] * 3 + [True] * 2
    assert [part.beats for part in parts] == [True, False, False, True, True]
    assert [part.nests for part in parts] == [True, False, False, True, True]
    assert [part.spare for part in parts] == [False, False, True, False, False]
    assert all(part.zygote is zygote and part.beside for part in parts)
    assert names_of(of) == ("integrator", "recognizer", "viewer 1", "viewer 2")


def test_a_run_of_one_view_without_metrics_has_three_parts() -> None:
    parts = live_parts(Settings(), clip(2), CONTEXT, None)  # type: ignore[arg-type]
    assert [part.name for part in parts] == ["integrator", "recognizer", "viewer 2"]
    assert not any(part.beside for part in parts)


def test_the_page_is_a_part_that_neither_leads_nor_beats() -> None:
    given: Any = (object(), object(), object())
    part = page_part(Settings(), CONTEXT, "title", given[0], given[1], given[2])
    assert part.arguments == (Settings(), CONTEXT, "title", given[0], given[1])
    assert (part.name, part.main, part.zygote) == ("animator", animator_main, given[2])
    assert (part.leads, part.beats, part.end_s) == (False, False, END_S)


class Process:
    """One that ends when it is asked, or only when it is killed."""

    def __init__(self, heeds: bool, exitcode: int | None = None) -> None:
        self.heeds, self.exitcode, self.calls = heeds, exitcode, list[Any]()
        self.alive = exitcode is None

    def is_alive(self) -> bool:
        return self.alive

    def terminate(self) -> None:
        self.calls.append("terminate")
        self.alive = not self.heeds

    def kill(self) -> None:
        self.calls.append("kill")
        self.alive = False

    def join(self, within_s: float | None = None) -> None:
        self.calls.append(within_s)


class Words:
    def __init__(self, *said: str, over: bool = False) -> None:
        self.said, self.over = [*said], over

    def poll(self) -> bool:
        if self.over:
            raise EOFError
        return bool(self.said)

    def recv(self) -> str:
        return self.said.pop()


def running(process: Process, words: Words) -> Running:
    part = Part("viewer 1", viewer_main, (), end_s=3.0)
    return Running(part, process, words)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("process", "calls"),
    [
        (Process(heeds=True), ["terminate", 3.0]),
        (Process(heeds=False), ["terminate", 3.0, "kill", None]),
        (Process(heeds=True, exitcode=0), []),
    ],
    ids=["heeds", "hangs", "is over"],
)
def test_who_does_not_end_when_asked_is_killed(process: Process, calls: list[Any]) -> None:
    assert end(running(process, Words())) is ("kill" not in calls)
    assert process.calls == calls


@pytest.mark.parametrize(
    ("exitcode", "words", "told"),
    [
        (1, Words("no camera 0"), "no camera 0"),
        (1, Words(), "ended with exit code 1"),
        (-9, Words(over=True), "killed by signal 9"),
        (0, Words(), "ended with exit code 0"),
    ],
)
def test_why_a_process_ended_is_what_it_said_or_its_code(
    exitcode: int, words: Words, told: str
) -> None:
    assert last_words(running(Process(True, exitcode), words)) == told


def test_a_part_whose_zygote_dies_is_a_new_python(monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[object] = []

    def start(part: Part, context: object) -> str:
        begun.append(context)
        if context is FORK:
            raise EOFError
        return part.name

    class Warm:
        context = FORK

    monkeypatch.setattr(process_table, "_begun", start)
    part = Part("viewer 1", viewer_main, ())
    warm: Any = Warm()
    given: list[Any] = [
        process_table.started(part),
        process_table.started(part._replace(zygote=warm)),
    ]
    assert given == ["viewer 1"] * 2
    assert begun == [SPAWN, FORK, SPAWN]


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
    monkeypatch.setattr(process_table, "adopting", context.adopting)
    monkeypatch.setattr(process_table, "adopted", lambda *of: ("child", of))
    if forked:
        monkeypatch.setattr(process_table, "FORK", context)
    part = Part("viewer 1", viewer_main, ("given",), nests=nests)
    before = signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT, signal.SIGHUP))
    running = process_table._begun(part, context)
    after = signal.pthread_sigmask(signal.SIG_SETMASK, before)
    assert not {signal.SIGINT, signal.SIGHUP} & after
    assert context.asked == {
        "name": "viewer 1",
        "target": process_table._guarded,
        "args": ("viewer 1", viewer_main, ("given",), context.theirs, forked),
        "daemon": not nests,
    }
    process: Any = ("child", (context, context.ours)) if forked else context
    assert running == Running(part, process, context.ours)
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
        with suppress(OSError), process_table.inherited():
            deaf = signal.pthread_sigmask(signal.SIG_BLOCK, ())
            told = {name: os.environ[name] for name in process_table.FRUGAL}
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


@pytest.mark.parametrize("forked", [True, False])
def test_a_part_runs_under_its_name_hears_its_end_and_says_why_it_fails(
    monkeypatch: pytest.MonkeyPatch, forked: bool
) -> None:
    called: list[Any] = []
    words: Any = object()
    for name in ("be_adopted", "be_shown_as", "end_with_parent"):
        monkeypatch.setattr(process_table, name, lambda *of, name=name: called.append((name, *of)))

    def confessed(*of: Any) -> int:
        called.append(of)
        return 7

    monkeypatch.setattr(process_table, "confessed", confessed)
    error = ValueError("no camera 0")

    def main(*arguments: Any) -> None:
        deaf = signal.pthread_sigmask(signal.SIG_BLOCK, ())
        called.append((arguments, signal.SIGTERM in deaf))
        if arguments == ("fails",):
            raise error

    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGTERM,))
    try:
        process_table._guarded("viewer 1", main, ("a", 2), words, forked)
        began: list[Any] = [("be_adopted", words)] if forked else []
        began += [("be_shown_as", "viewer 1"), ("end_with_parent",)]
        assert called == [*began, (("a", 2), False)]
        called.clear()
        with pytest.raises(SystemExit) as ended:
            process_table._guarded("viewer 1", main, ("fails",), words, forked)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
    assert ended.value.code == 7
    assert called[-1] == ("viewer 1", error, words)
