"""One figure of a benchmark, and the minimum time of a call."""

import time
from collections.abc import Callable
from typing import NamedTuple


class Measured(NamedTuple):
    """One figure."""

    what: str
    value: float
    unit: str
    target: float | None = None
    """Required value: a rate shall reach it, a time shall not exceed it."""

    @property
    def met(self) -> bool | None:
        """Whether the requirement is met; None without one."""
        if self.target is None:
            return None
        return self.value >= self.target if self.unit.endswith("/s") else self.value <= self.target


def least_s(
    run: Callable[[], object], repeats: int, clock: Callable[[], float] = time.perf_counter
) -> float:
    """Minimum seconds of a call; the first one, which may compile, does not count."""
    run()
    least = float("inf")
    for _ in range(repeats):
        began = clock()
        run()
        least = min(least, clock() - began)
    return least
