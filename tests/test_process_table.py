"""The table of a live run: who is started in which order, how, and how one is ended."""

from typing import Any

import pytest

from common.bus.process import ProcessContext
from common.config.settings import Settings
from common.platform.platform import Job, Started
from common.video.clip_facts import Clip, ClipView, Meta
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
    views = [ClipView(n, f"cam{n}.avi", (160, 120), (160, 120), 30.0, 9) for n in numbers]
    return Clip("room", tuple(views), 2, None, Meta())


def test_who_listens_comes_before_who_speaks_and_the_run_lasts_as_long_as_its_viewers() -> None:
    settings, of, launcher = Settings(metrics="127.0.0.1:1"), clip(1, 2), object()
    parts = live_parts(settings, of, CONTEXT, launcher, True)  # type: ignore[arg-type]
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
    assert all(part.launcher is launcher and part.beside for part in parts)
    assert names_of(of) == ("integrator", "recognizer", "viewer 1", "viewer 2")


def test_a_run_of_one_view_without_metrics_has_three_parts() -> None:
    parts = live_parts(Settings(), clip(2), CONTEXT, None)  # type: ignore[arg-type]
    assert [part.name for part in parts] == ["integrator", "recognizer", "viewer 2"]
    assert not any(part.beside for part in parts)


def test_the_page_is_a_part_that_neither_leads_nor_beats() -> None:
    given: Any = (object(), object(), object())
    part = page_part(Settings(), CONTEXT, "title", given[0], given[1], given[2])
    assert part.arguments == (Settings(), CONTEXT, "title", given[0], given[1])
    assert (part.name, part.main, part.launcher) == ("animator", animator_main, given[2])
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


class Launching:
    """A platform, or its launcher, that begins nothing."""

    def __init__(self) -> None:
        self.jobs: list[Job] = []

    def start(self, job: Job) -> Started:
        self.jobs.append(job)
        worker: Any = Process(heeds=True)
        words: Any = Words()
        return Started(worker, words)


@pytest.mark.parametrize("nests", [True, False])
def test_a_part_begins_by_its_launcher_else_as_the_platform_begins_one(
    monkeypatch: pytest.MonkeyPatch, nests: bool
) -> None:
    platform, launcher = Launching(), Launching()
    monkeypatch.setattr(process_table, "platform", lambda: platform)
    part = Part("viewer 1", viewer_main, ("given",), nests=nests)
    due = Job("viewer 1", process_table._guarded, ("viewer 1", viewer_main, ("given",)), nests)
    one = process_table.started(part)
    assert (platform.jobs, launcher.jobs) == ([due], [])
    assert isinstance(one.process, Process)
    assert isinstance(one.words, Words)
    other: Any = launcher
    process_table.started(part._replace(launcher=other))
    assert (platform.jobs, launcher.jobs) == ([due], [due])


def test_a_part_says_why_it_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    called: list[Any] = []
    words: Any = object()

    def confessed(*of: Any) -> int:
        called.append(of)
        return 7

    monkeypatch.setattr(process_table, "confessed", confessed)
    error = ValueError("no camera 0")

    def main(*arguments: Any) -> None:
        called.append(arguments)
        if arguments == ("fails",):
            raise error

    process_table._guarded("viewer 1", main, ("a", 2), words)
    assert called == [("a", 2)]
    with pytest.raises(SystemExit) as ended:
        process_table._guarded("viewer 1", main, ("fails",), words)
    assert ended.value.code == 7
    assert called[-1] == ("viewer 1", error, words)
