"""The start of a run, by the room's clock."""

import time
from typing import Final

from common.bus.control_messages import ClockAnswer, ClockQuestion
from common.bus.messages import View, ViewerNumber

LEAD_S: Final = 0.5
"""Time from the last viewer's readiness to the first frame: all must receive it."""


class Starter:
    """Answers questions about the room's clock, and fixes the start once every viewer is ready
    and, where that is wanted, the page is open."""

    def __init__(
        self,
        expected: frozenset[ViewerNumber],
        wait_s: float = 0.0,
        start_s: float | None = None,
    ) -> None:
        """The viewers of the run, and how long they wait for the page; the start, where a
        previous integrator has fixed it."""
        self._missing = set(expected)
        self._start_s = start_s
        self._wait_s = wait_s
        self._ready_s: float | None = None

    def answer(self, question: ClockQuestion) -> ClockAnswer:
        """The clock now; the start, if it is fixed. Called by the bus's own thread."""
        now_s = time.monotonic()
        if question.ready and question.viewer is not None:
            self._missing.discard(question.viewer)
        if not self._missing and self._ready_s is None:
            self._ready_s = now_s
        if self._ready_s is not None and self._start_s is None:
            looked_for = now_s - self._ready_s >= self._wait_s
            self._start_s = now_s + LEAD_S if looked_for else None
        return ClockAnswer(now_s=now_s, start_s=self._start_s)

    def looked_at(self) -> None:
        """The page was opened: nothing else is waited for."""
        self._wait_s = 0.0

    @property
    def start_s(self) -> float | None:
        """The start of the run; None while it is not fixed."""
        return self._start_s

    def begun(self, report: View) -> None:
        """The run has begun: this process was restarted, its viewers were not."""
        if self._start_s is None:
            self._start_s = report.clock_s - report.captured_s
