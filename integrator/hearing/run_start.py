"""When a run begins, by the room's clock."""

import time
from typing import Final

from common.bus.control_messages import ClockAnswer, ClockQuestion
from common.bus.messages import View, ViewerNumber

LEAD_S: Final = 0.5
"""From the last viewer's being ready to the first frame: time for all to hear of it."""


class Starter:
    """Answers what the room's clock says, and fixes the start once every viewer is ready, and
    somebody looks, where that is waited for."""

    def __init__(
        self,
        expected: frozenset[ViewerNumber],
        wait_s: float = 0.0,
        start_s: float | None = None,
    ) -> None:
        """Viewers that belong to the run, and how long they wait for somebody to look; when it
        began, where another integrator has fixed that."""
        self._missing = set(expected)
        self._start_s = start_s
        self._wait_s = wait_s
        self._ready_s: float | None = None

    def answer(self, question: ClockQuestion) -> ClockAnswer:
        """What the clock says now; the start, if it is fixed. Called by the bus's own thread."""
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
        """Somebody looks: nothing else is waited for."""
        self._wait_s = 0.0

    @property
    def start_s(self) -> float | None:
        """When the run begins; None while that is not fixed."""
        return self._start_s

    def begun(self, report: View) -> None:
        """The run has begun: this process was started again, and its viewers were not."""
        if self._start_s is None:
            self._start_s = report.clock_s - report.captured_s
