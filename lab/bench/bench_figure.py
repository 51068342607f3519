"""One figure of a benchmark, and the least time of a call."""

import time
from collections.abc import Callable
from typing import NamedTuple


class Measured(NamedTuple):
    """One figure."""

    what: str
    value: float
    unit: str
    target: float | None = None
    """What the design asks for: a rate is to reach it, a time is not to exceed it."""

    @property
    def met(self) -> bool | None:
        """Whether the target is reached; None where there is none."""
        if self.target is None:
            return None
        return self.value >= self.target if self.unit.endswith("/s") else self.value <= self.target


def least_s(
    run: Callable[[], object], repeats: int, clock: Callable[[], float] = time.perf_counter
) -> float:
    """Least seconds of a call; the first one, which may compile, does not count."""
    run()
    least = float("inf")
    for _ in range(repeats):
        began = clock()
        run()
        least = min(least, clock() - began)
    return least
