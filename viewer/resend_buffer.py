"""Reports that a restarted integrator may have missed, kept to be sent again."""

from collections import deque
from collections.abc import Iterable
from typing import Final

from common.bus.inbox import Alive
from common.bus.messages import View

HUB: Final = "integrator"
MOST: Final = 128
"""Number of reports kept: eight seconds at 15 Hz, longer than a restart takes."""


class ResendBuffer:
    """The latest reports, after the last one that a guide takes into account."""

    def __init__(self) -> None:
        """No report yet."""
        self._kept: deque[View] = deque(maxlen=MOST)
        self._gone = False

    def said(self, report: View) -> None:
        """Keep a published report."""
        self._kept.append(report)

    def again(self, heard: int, alive: Iterable[Alive]) -> list[View]:
        """The reports to send again, oldest first: none unless the integrator came back.

        Args:
            heard: The last frame of this viewer that a guide takes into account.
            alive: Processes that came and went since.
        """
        while self._kept and self._kept[0].frame <= heard:
            self._kept.popleft()
        back = False
        for one in alive:
            if one.name == HUB:
                back |= self._gone and one.alive
                self._gone = not one.alive
        return list(self._kept) if back else []
