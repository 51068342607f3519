"""The guides that a viewer gets: the newest one, and how often it came too late."""

import time

from common.bus.inbox import Inbox
from common.bus.messages import Guide, ViewerNumber


class Guides:
    """The newest guide, and the number of guides that came too late."""

    def __init__(self, inbox: Inbox[Guide], viewer: ViewerNumber) -> None:
        """Guides for this viewer."""
        self.misses = 0
        self.newest: Guide | None = None
        self._inbox, self._viewer = inbox, viewer

    def of_frame(self, index: int, wait_s: float) -> Guide | None:
        """The guide that takes this viewer's last frame into account; else the newest, counted as a
        miss.

        A guide of a rig without this viewer's camera is ignored.
        """
        until_s = time.monotonic() + wait_s
        while self.heard < index:
            left_s = until_s - time.monotonic()
            guide = self._inbox.take(max(0.0, left_s))
            if guide is not None and len(guide.frames) >= self._viewer:
                self.newest = guide
            elif left_s <= 0:
                self.misses += 1
                break
        return self.newest

    @property
    def malformed(self) -> int:
        """Number of malformed messages received as guides."""
        return self._inbox.malformed

    @property
    def foreign(self) -> int:
        """Number of guides from other runs."""
        return self._inbox.foreign

    @property
    def heard(self) -> int:
        """The last frame of this viewer that a guide takes into account; -1: none."""
        return -1 if self.newest is None else self.newest.frames[self._viewer - 1]
