"""What dies is started again, later each time, until it is given up: real processes, no bus."""

import os
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from common.bus.control_messages import Pulse
from common.platform.platforms import platform
from common.video.clip_sources import ClipError
from runtime.faults import code_of
from runtime.live.process_table import Part
from runtime.live.supervise import BACK_OFF_S, TRIES, PartBroke, PartFailed, Watched, watched

PATIENCE_S = 60.0


def sleeps() -> None:
    """A part that works."""
    time.sleep(600.0)


def ignores() -> None:
    """A part that hangs when it shall end."""
    with platform().asked_to_end(lambda: None):
        print("deaf", flush=True)
        time.sleep(600.0)


def ends() -> None:
    """A part whose work is done."""


def refuses(text: str) -> None:
    """A part that does not."""
    raise ClipError(text)


def breaks() -> None:
    """A part with a fault."""
    empty: dict[str, int] = {}
    empty["nothing"]


def beating(name: str) -> dict[str, Pulse]:
    return {name: Pulse(process=name, state="running", frames=7)}


@pytest.fixture
def sleeper() -> Iterator[Watched]:
    with watched(Part("viewer 2", sleeps, (), leads=True, beats=True)) as one:
        yield one


def until(seen: Callable[[], object]) -> None:
    until_s = time.monotonic() + PATIENCE_S
    while not seen():
        assert time.monotonic() < until_s
        time.sleep(0.02)


def killed(one: Watched) -> None:
    pid = one.running.process.pid
    assert pid is not None
    os.kill(pid, signal.SIGKILL)
    until(lambda: one.running.process.exitcode is not None)


def test_what_dies_is_started_again_and_the_table_says_so(sleeper: Watched) -> None:
    pulses = beating("viewer 2")
    assert sleeper.look(100.0, pulses) == ""
    first = sleeper.running.process.pid
    killed(sleeper)
    assert sleeper.look(100.1, pulses) == (
        "viewer 2: killed by signal 9; it is started again in 0.5 s (1 of 5 times)"
    )
    assert (pulses["viewer 2"].state, pulses["viewer 2"].frames) == ("restarting", 7)
    assert not sleeper.done
    sleeper.look(100.5, pulses)
    assert sleeper.running.process.pid == first
    sleeper.look(100.7, pulses)
    assert sleeper.running.process.pid != first
    assert sleeper.running.process.is_alive()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP])
def test_what_a_terminal_says_to_all_is_for_the_supervisor_alone(
    sleeper: Watched, number: signal.Signals
) -> None:
    """Ctrl-C, and that it was closed: who started the others ends them in order."""
    pid = sleeper.running.process.pid
    assert pid is not None
    os.kill(pid, number)
    time.sleep(0.3)
    assert sleeper.running.process.is_alive()


def test_each_further_start_waits_twice_as_long_and_then_it_is_given_up(
    sleeper: Watched,
) -> None:
    pulses, now_s, waits = beating("viewer 2"), 100.0, []
    sleeper.look(now_s, pulses)
    for _ in range(TRIES):
        killed(sleeper)
        sleeper.look(now_s, pulses)
        before = now_s
        while sleeper.running.process.exitcode is not None:
            now_s += BACK_OFF_S / 4
            sleeper.look(now_s, pulses)
        waits.append(now_s - before)
    assert waits == [BACK_OFF_S * 2**n for n in range(TRIES)]
    killed(sleeper)
    told = sleeper.look(now_s, pulses)
    assert told == "viewer 2: killed by signal 9; after 5 new starts it is given up"
    assert pulses["viewer 2"].state == "given up"
    assert sleeper.look(now_s + 100.0, pulses) == "", "it is told once"
    with pytest.raises(PartFailed, match="viewer 2: killed by signal 9; after 5 new starts"):
        sleeper.refuse_failure()


def test_what_ran_for_a_minute_has_all_its_tries_again(sleeper: Watched) -> None:
    pulses, now_s = beating("viewer 2"), 100.0
    sleeper.look(now_s, pulses)
    killed(sleeper)
    sleeper.look(now_s, pulses)
    for _ in range(200):
        now_s += 0.5
        pulses["viewer 2"] = beating("viewer 2")["viewer 2"]
        sleeper.look(now_s, pulses)
    killed(sleeper)
    assert "(1 of 5 times)" in sleeper.look(now_s, pulses)


def test_what_hangs_is_killed_but_not_by_a_supervisor_that_slept_itself(sleeper: Watched) -> None:
    pulses, now_s = beating("viewer 2"), 100.0
    sleeper.look(now_s, pulses)
    assert sleeper.look(now_s + 3600.0, pulses) == ""
    now_s += 3600.0
    told = ""
    while not told:
        now_s += 0.1
        told = sleeper.look(now_s, pulses)
    assert now_s - 3700.0 == pytest.approx(5.0, abs=1.0)
    assert told == "viewer 2: it has said nothing for 5 s, hangs, and is killed"
    until(lambda: sleeper.running.process.exitcode == -signal.SIGKILL)


def test_what_is_killed_for_its_silence_is_killed_once_though_it_takes_a_moment_to_end(
    sleeper: Watched, monkeypatch: pytest.MonkeyPatch
) -> None:
    pulses, kills = beating("viewer 2"), list[int]()
    with monkeypatch.context() as patch:
        patch.setattr(sleeper.running.process, "kill", lambda: kills.append(1))
        said = [sleeper.look(100.0 + 0.5 * number, pulses) for number in range(16)]
    assert len(kills) == 1
    assert len([each for each in said if each]) == 1


def test_what_came_to_its_end_unheard_does_not_hang() -> None:
    """Its last pulse is lost where the integrator is down as it ends."""
    with watched(Part("viewer 2", ends, (), leads=True, beats=True)) as one:
        pulses = beating("viewer 2")
        one.look(100.0, pulses)
        until(lambda: one.done)
        told = {one.look(100.0 + 0.4 * number, pulses) for number in range(30)}
    assert told == {""}


def test_what_cannot_be_heard_is_not_killed_for_its_silence(sleeper: Watched) -> None:
    """The integrator hands on what all others say, and takes seconds to start again."""
    pulses, now_s = beating("viewer 2"), 100.0
    for reached in (*[False] * 40, *[True] * 10):
        now_s += 0.4
        assert sleeper.look(now_s, pulses, reached) == ""
    assert sleeper.running.process.is_alive()
    for _ in range(10):
        now_s += 0.4
        told = sleeper.look(now_s, pulses)
        if told:
            break
    assert "hangs, and is killed" in told


def test_who_is_down_or_silent_hands_nothing_on(sleeper: Watched) -> None:
    pulses, now_s = beating("viewer 2"), 100.0
    sleeper.look(now_s, pulses)
    assert sleeper.speaks
    for _ in range(8):
        now_s += 0.4
        sleeper.look(now_s, pulses)
    assert not sleeper.speaks
    sleeper.look(now_s, beating("viewer 2"))
    assert sleeper.speaks
    killed(sleeper)
    sleeper.look(now_s, pulses)
    assert not sleeper.speaks


def test_what_fails_before_it_ever_worked_fails_the_run_with_its_reason() -> None:
    with watched(Part("viewer 1", refuses, ("no camera",), leads=True)) as one:
        until(lambda: one.running.process.exitcode is not None)
        with pytest.raises(PartFailed, match="viewer 1: no camera"):
            one.look(100.0, {})


def test_what_is_killed_before_it_ever_worked_is_started_again(sleeper: Watched) -> None:
    """Whoever killed it, it did not fail of itself: a short want of memory ends no run."""
    killed(sleeper)
    assert sleeper.look(100.0, {}).endswith("it is started again in 0.5 s (1 of 5 times)")
    sleeper.refuse_failure()
    sleeper.look(100.0 + BACK_OFF_S, {})
    assert sleeper.running.process.is_alive()


def test_what_does_not_end_when_it_is_asked_to_is_killed_and_named_but_has_not_failed(
    capfd: pytest.CaptureFixture[str],
) -> None:
    one = Watched(Part("integrator", ignores, (), end_s=0.2))
    until(lambda: "deaf" in capfd.readouterr().out)
    assert one.end() == "integrator: it did not end when asked to, and was killed"
    assert one.running.process.exitcode == -signal.SIGKILL
    one.refuse_failure()


def test_a_fault_is_told_from_what_a_user_can_mend() -> None:
    with watched(Part("viewer 1", breaks, (), leads=True)) as one:
        until(lambda: one.running.process.exitcode is not None)
        with pytest.raises(PartBroke, match=r"viewer 1: a fault .*KeyError.*report (.*)") as told:
            one.look(100.0, {})
    assert code_of(told.value) == 1
    kept = Path(str(told.value).rpartition(" ")[2])
    assert "breaks" in kept.read_text()
    kept.unlink()


def test_nothing_runs_after_the_end(sleeper: Watched) -> None:
    assert sleeper.end() == ""
    assert not sleeper.running.process.is_alive()


def test_what_is_told_to_end_before_it_listens_has_not_failed(sleeper: Watched) -> None:
    sleeper.end()
    assert sleeper.running.process.exitcode in (-signal.SIGTERM, 0), "by a signal, or of itself"
    sleeper.refuse_failure()


def test_what_was_killed_by_others_has(sleeper: Watched) -> None:
    killed(sleeper)
    sleeper.end()
    with pytest.raises(PartFailed, match="killed by signal 9"):
        sleeper.refuse_failure()
