"""One process of a run under supervision: what dies is started again, later each time."""

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
"""How often a part is started again before it is given up."""
BACK_OFF_S: Final = 0.5
"""Before the first new start; twice as long before each further one."""
STEADY_S: Final = 60.0
"""A part that ran for so long has all its tries again."""
LOOK_AT_MOST_S: Final = 0.5
"""What counts of the time between two looks: a supervisor that was stopped itself, with all of
its group, must not take the others for hung."""

LATELY_S: Final = 2.5
"""Who has said nothing for so long may be unable to hand on what others say."""


class PartFailed(RuntimeError):
    """A process of the run failed; the text names it and says why."""


class PartBroke(PartFailed, Fault):
    """It failed by a fault of the program."""


class Watched:
    """A part and its process, which may be another one later."""

    def __init__(self, part: Part) -> None:
        """Started now."""
        self.part = part
        self.given_up = ""
        """Why it is not started again; "" while it is."""
        self.running = started(part)
        self._tries = 0
        self._asked = False
        """It was told to end."""
        self._came_up = False
        """It has worked once: what fails of itself before that fails for good."""
        self._cut_off = False
        """It did not end when it was asked to, and was killed."""
        self._alive_s, self._quiet_s = 0.0, 0.0
        self._looked_s = time.monotonic()
        self._again_s: float | None = None
        self._last: Pulse | None = None

    @property
    def done(self) -> bool:
        """Whether it came to its own end."""
        return self._again_s is None and self.running.process.exitcode == 0

    @property
    def speaks(self) -> bool:
        """Whether it has said something lately, as who hands on what others say must."""
        return self._again_s is None and self._quiet_s <= LATELY_S

    def look(self, now_s: float, pulses: dict[str, Pulse], reached: bool = True) -> str:
        """Start it again where it died or hangs; what is to be told of that, or "".

        Args:
            now_s: This host's monotonic clock.
            pulses: The newest of each part; a part that is down is told there too.
            reached: Whether what it says gets here: nobody is held to what cannot be heard.

        Raises:
            PartFailed: When it fails of itself before it ever worked.
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
        """Say why it failed, if it did.

        Who was asked to end and had no ears for it yet did not, nor who took too long to end.

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
        """End its process and start no other; what is to be told of that, or ""."""
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
        """Let the table of processes say how it is, with its counts so far."""
        last = pulses.get(self.part.name) or Pulse(process=self.part.name, state=state)
        pulses[self.part.name] = msgspec.structs.replace(last, state=state)

    def _hung(self) -> str:
        """Kill it where it should speak and does not; the next look finds it dead."""
        last = self._last
        expected = self.part.beats and last is not None and last.state == "running"
        if not expected or not silent(TOPICS[Pulse].hz, 0.0, self._quiet_s):
            return ""
        self.running.process.kill()
        quiet_s, self._quiet_s = self._quiet_s, 0.0
        return f"{self.part.name}: it has said nothing for {quiet_s:.0f} s, hangs, and is killed"


@contextmanager
def watched(part: Part) -> Iterator[Watched]:
    """A part, started; ended whatever happens."""
    one = Watched(part)
    try:
        yield one
    finally:
        one.end()
