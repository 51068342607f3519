"""Reports that the integrator may not have heard: they are said again when it is back."""

from collections import deque
from collections.abc import Iterable
from typing import Final

from common.bus.inbox import Alive
from common.bus.messages import View

HUB: Final = "integrator"
MOST: Final = 128
"""Reports that are kept, eight seconds at 15 frames a second: longer than a new start takes."""


class ResendBuffer:
    """The reports of late, up to those that a guide has heard of."""

    def __init__(self) -> None:
        """Nothing was said."""
        self._kept: deque[View] = deque(maxlen=MOST)
        self._gone = False

    def said(self, report: View) -> None:
        """Keep a report that was published."""
        self._kept.append(report)

    def again(self, heard: int, alive: Iterable[Alive]) -> list[View]:
        """What is to be said once more, oldest first: nothing but when the integrator came back.

        Args:
            heard: The last frame of this viewer that a guide has heard of.
            alive: Who came and went since.
        """
        while self._kept and self._kept[0].frame <= heard:
            self._kept.popleft()
        back = False
        for one in alive:
            if one.name == HUB:
                back |= self._gone and one.alive
                self._gone = not one.alive
        return list(self._kept) if back else []
