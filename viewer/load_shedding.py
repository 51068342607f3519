"""Load shedding: a late viewer skips the landmark network, or some of its looks."""

from typing import Final, Literal

import msgspec

from common.bus.messages import View
from viewer.captured_frame import CapturedFrame

LATE: Final = 0.15
"""Delay, in frame periods, up to which a viewer keeps its landmarks."""
LATE_OF_SEVERAL: Final = 0.5
"""The same where everyone is followed: without landmarks people cannot be kept apart, so a late
viewer carries them on, as far as that goes (`viewer/people/looks_in_turn.py`)."""
LASTS_S: Final = 1.0 / 3.0
"""Duration of load shedding once begun, seconds: five frames at 15 Hz. At most that many frames
in a row go without landmarks."""
TOLD: Final = 0.02
"""Share of a run's frames that may go without landmarks before it is reported."""


class LoadShedder:
    """Decides which frames are processed without landmarks.

    A machine with too many rooms would otherwise delay every body of every room; silhouettes alone
    still give the joints in between.
    """

    def __init__(self, period_s: float, people: Literal[1, "all"]) -> None:
        """Start for a given frame period, and the people who are followed."""
        self.frames = 0
        """Number of frames processed without landmarks."""
        self.in_turn = 0
        """Number of frames in which some people were not looked at."""
        self._late_s = (LATE if people == 1 else LATE_OF_SEVERAL) * period_s
        self._lasts = max(1, round(LASTS_S / period_s))
        self._left = self._in_a_row = 0
        self._is_hurried = False
        """Whether the frame that is worked on is late."""

    def of_frame(self, frame: CapturedFrame, late_s: float) -> CapturedFrame:
        """The frame, marked as late where its delay requires load shedding."""
        self._left = self._lasts if late_s > self._late_s else max(self._left - 1, 0)
        self._is_hurried = self._left > 0 and self._in_a_row < self._lasts
        if not self._is_hurried:
            self._in_a_row = 0
            return frame
        self._in_a_row += 1
        self.frames += 1
        return msgspec.structs.replace(frame, hurried=True)

    def reported(self, view: View) -> None:
        """Count a report: a late frame was looked into where anyone in it has landmarks."""
        self.in_turn += any(one.carried for one in view.people)
        is_looked_into = any(one.landmarks is not None for one in view.people)
        self.frames -= is_looked_into and self._is_hurried

    def odd(self, frames: int) -> tuple[str, ...]:
        """The reports at the end of that many frames; none where few were affected."""
        cure = "give this machine fewer rooms, a smaller size or fewer frames a second"
        left_out = (
            (self.frames, "frames came too late to be looked into, only their outlines were told"),
            (
                self.in_turn,
                "frames came late: people were looked at in turn, the others carried on",
            ),
        )
        return tuple(
            f"{count} of {frames} {what}: {cure}"
            for count, what in left_out
            if count > TOLD * frames
        )
