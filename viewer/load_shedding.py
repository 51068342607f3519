"""A viewer that is late leaves out what costs most: the look at what its silhouette holds."""

from typing import Final

import msgspec

from viewer.captured_frame import CapturedFrame

LATE: Final = 0.15
"""Shares of a frame's period that a viewer may be late without being in a hurry."""
LASTS_S: Final = 1.0 / 3.0
"""For how long it is then in a hurry, five frames of 15 a second; so many looks in a row are left
out at most."""
TOLD: Final = 0.02
"""What share of a run's frames may be hurried without a word."""


class LoadShedder:
    """Which frames are in a hurry.

    A machine with more rooms than it has the time for would otherwise be late with every body of
    every room; silhouettes alone, in between, still show where the joints are.
    """

    def __init__(self, period_s: float) -> None:
        """Of frames so far apart."""
        self.frames = 0
        """How many were in a hurry."""
        self._period_s = period_s
        self._lasts = max(1, round(LASTS_S / period_s))
        self._left = self._in_a_row = 0

    def of_frame(self, frame: CapturedFrame, late_s: float) -> CapturedFrame:
        """A frame that was due so long ago, as one in a hurry where there is need."""
        self._left = self._lasts if late_s > LATE * self._period_s else max(self._left - 1, 0)
        if not self._left or self._in_a_row >= self._lasts:
            self._in_a_row = 0
            return frame
        self._in_a_row += 1
        self.frames += 1
        return msgspec.structs.replace(frame, hurried=True)

    def odd(self, frames: int) -> str:
        """What is reported at the end of so many frames; "" where few were in a hurry."""
        if self.frames <= TOLD * frames:
            return ""
        return (
            f"{self.frames} of {frames} frames came too late to be looked into, only their outlines"
            " were told: give this machine fewer rooms, a smaller size or fewer frames a second"
        )
