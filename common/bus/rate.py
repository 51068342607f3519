"""Keeping time: waiting until a frame is due, and how late work was done."""

import math
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Final

WINDOW: Final = 450
"""Window of the statistics, frames: half a minute at 15 Hz."""

SILENT_PERIODS: Final = 5
"""Number of messages missing in a row before their sender counts as silent. One or two late
frames are no silence; a third of a second at 15 Hz is soon enough to go on with one view."""

Clock = Callable[[], float]


class Pace:
    """How a process keeps up with frames that are due at known moments.

    A frame is late when its work ends more than a period after it was due: 66.7 ms at the
    paper's 15 frames a second (P1).
    """

    def __init__(self, period_s: float) -> None:
        """No frame done yet."""
        self.misses = 0
        """Number of deadlines missed since the start."""
        self.frames = 0
        """Number of frames done since the start."""
        self._period_s = period_s
        self._recent: deque[tuple[float, float]] = deque(maxlen=WINDOW)

    def done(self, due_s: float, now_s: float) -> None:
        """Count a frame by the moment it was due and the moment its work ended."""
        self.frames += 1
        self.misses += now_s - due_s > self._period_s
        self._recent.append((now_s, now_s - due_s))

    @property
    def fps(self) -> float:
        """Frames a second within the window; 0 before the second frame."""
        if len(self._recent) < 2:
            return 0.0
        took_s = self._recent[-1][0] - self._recent[0][0]
        return (len(self._recent) - 1) / took_s if took_s > 0 else 0.0

    def latency_ms(self, share: float) -> float:
        """Time from due to done within which this share of the window's frames stayed.

        The nearest-rank quantile: one of the measured times, 0 before the first frame.
        """
        if not self._recent:
            return 0.0
        ordered = sorted(late_s for _, late_s in self._recent)
        return 1000.0 * ordered[max(0, math.ceil(share * len(ordered)) - 1)]


def wait_until(due_s: float, stop: threading.Event, clock: Clock = time.monotonic) -> bool:
    """Wait for a moment of the clock; False when `stop` was set before."""
    while (left_s := due_s - clock()) > 0:
        if stop.wait(left_s):
            return False
    return not stop.is_set()


def silent(hz: float, last_heard_s: float, now_s: float) -> bool:
    """Whether the sender of regular messages has fallen silent; never for irregular ones (0 Hz)."""
    return hz > 0 and now_s - last_heard_s > SILENT_PERIODS / hz
