"""Supervision of one process of a run: after a crash it is restarted, later each time."""

import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final, Literal

import msgspec

from common.bus.control_messages import Pulse
from common.bus.message_codec import TOPICS
from common.bus.rate import silent
from runtime.faults import FAULTY, Fault
from runtime.live.process_table import Part, end, last_words, started

TRIES: Final = 5
"""Number of restarts of a part before it is given up."""
BACK_OFF_S: Final = 0.5
"""Delay before the first restart, seconds; each further one waits twice as long."""
STEADY_S: Final = 60.0
"""Running time, seconds, after which a part has all its restarts again."""
LOOK_AT_MOST_S: Final = 0.5
"""Upper bound of the counted time between two checks: after the supervisor itself was stopped,
with its whole group, the others must not count as hung."""

RECENT_S: Final = 2.5
"""Silence, seconds, after which a part may be unable to forward messages."""


class PartFailed(RuntimeError):
    """A process of the run failed; the text names it and the cause."""


class PartBroke(PartFailed, Fault):
    """It failed by a fault of the program."""


class Watched:
    """A part and its process, which changes with a restart."""

    def __init__(self, part: Part) -> None:
        """Started now."""
        self.part = part
        self.given_up = ""
        """Why it is not restarted; "" while it may be."""
        self.running = started(part)
        self._tries = 0
        self._asked = False
        """It was asked to end."""
        self._came_up = False
        """It has worked once: an error before that is final."""
        self._cut_off = False
        """It did not end when asked to, and was killed."""
        self._alive_s, self._quiet_s = 0.0, 0.0
        self._looked_s = time.monotonic()
        self._again_s: float | None = None
        self._last: Pulse | None = None

    @property
    def done(self) -> bool:
        """Whether it ended normally."""
        return self._again_s is None and self.running.process.exitcode == 0

    @property
    def speaks(self) -> bool:
        """Whether it has sent something recently, as a forwarding part must."""
        return self._again_s is None and self._quiet_s <= RECENT_S

    def look(self, now_s: float, pulses: dict[str, Pulse], reached: bool = True) -> str:
        """Restart it where it crashed or hangs; the line to report, or "".

        Args:
            now_s: This host's monotonic clock.
            pulses: The newest pulse of each part; a stopped part's is added.
            reached: Whether its messages arrive here: silence counts only then.

        Raises:
            PartFailed: When its own error ends it before it ever worked.
        """
        since_s = min(now_s - self._looked_s, LOOK_AT_MOST_S)
        self._looked_s = now_s
        if self.given_up or self.done:
            return ""
        if self._again_s is not None:
            launcher = self.part.launcher
            if now_s >= self._again_s and (launcher is None or launcher.ready()):
                self._again_s, self.running = None, started(self.part)
                self._alive_s = self._quiet_s = 0.0
            return ""
        self._listen(since_s, pulses.get(self.part.name), reached)
        if self.running.process.exitcode:
            return self._died(now_s, pulses)
        return self._hung()

    def refuse_failure(self) -> None:
        """Raise the error that ended it, if any.

        A part that was asked to end before it could receive that, or that took too long, is no
        failure.

        Raises:
            PartFailed: When its process ended with an error, or it was given up.
        """
        code = 0 if self._again_s is not None else self.running.process.exitcode
        ended = self._cut_off or (self._asked and code == -signal.SIGTERM)
        if self.given_up or (code and not ended):
            raise self._failure(self.given_up or last_words(self.running))

    def ask(self) -> None:
        """Ask its process to end."""
        if self.running.process.is_alive():
            self._asked = True
            self.running.process.terminate()

    def end(self) -> str:
        """End its process for good; the line to report, or ""."""
        self.ask()
        self._cut_off |= not end(self.running)
        late = f"{self.part.name}: it did not end when asked to, and was killed"
        return late if self._cut_off else ""

    def _listen(self, since_s: float, pulse: Pulse | None, reached: bool) -> None:
        self._alive_s += since_s
        self._quiet_s = self._quiet_s + since_s if pulse is self._last and reached else 0.0
        self._last = pulse
        self._came_up |= pulse is not None and pulse.state in ("ready", "running")
        if self._alive_s > STEADY_S:
            self._tries = 0

    def _died(self, now_s: float, pulses: dict[str, Pulse]) -> str:
        why = last_words(self.running)
        of_itself = (self.running.process.exitcode or 0) > 0
        if of_itself and not self._came_up:
            raise self._failure(why)
        if self._tries == TRIES:
            self.given_up = f"{why}; after {TRIES} new starts it is given up"
            self._show("given up", pulses)
            return f"{self.part.name}: {self.given_up}"
        wait_s = BACK_OFF_S * 2**self._tries
        self._tries += 1
        self._again_s = now_s + wait_s
        self._show("restarting", pulses)
        return (
            f"{self.part.name}: {why}; it is started again in {wait_s:g} s "
            f"({self._tries} of {TRIES} times)"
        )

    def _failure(self, why: str) -> PartFailed:
        kind = PartBroke if self.running.process.exitcode == FAULTY else PartFailed
        return kind(f"{self.part.name}: {why}")

    def _show(self, state: Literal["restarting", "given up"], pulses: dict[str, Pulse]) -> None:
        """Show its state in the table of processes, with its counts so far."""
        last = pulses.get(self.part.name) or Pulse(process=self.part.name, state=state)
        pulses[self.part.name] = msgspec.structs.replace(last, state=state)

    def _hung(self) -> str:
        """Kill it where it is silent without reason; the next check finds it dead."""
        last = self._last
        expected = self.part.beats and last is not None and last.state == "running"
        if not expected or not silent(TOPICS[Pulse].hz, 0.0, self._quiet_s):
            return ""
        self.running.process.kill()
        quiet_s, self._quiet_s = self._quiet_s, 0.0
        return f"{self.part.name}: it has said nothing for {quiet_s:.0f} s, hangs, and is killed"


@contextmanager
def watched(part: Part) -> Iterator[Watched]:
    """A started part; it is ended whatever happens."""
    one = Watched(part)
    try:
        yield one
    finally:
        one.end()
