"""What tells landmarks from outside the viewer's step: a process beside it, or files."""

from typing import Protocol

from common.bus.messages import Landmarks
from common.video.decoding import Decoded, Size


class OutsideSource(Protocol):
    """Sees one view's frames in their order; asked by the shells, never by a step."""

    @property
    def large(self) -> Size | None:
        """Size of the picture that it looks at; None: the working picture, or none."""

    @property
    def odd(self) -> tuple[str, ...]:
        """What went wrong so far, a line each."""

    def people(self, decoded: Decoded, wait_s: float) -> tuple[Landmarks, ...]:
        """The landmarks of every person in a frame, in pixels of the working picture.

        Args:
            decoded: The frame, with a picture of the size `large`, if that is one.
            wait_s: How long to wait for the answer; nobody is there when it does not come.
        """
