"""Whether a body is believed, by how well it fits: one rule for one view and for two."""

from typing import Final

from common.bus.messages import Status

LOST_SCORE: Final = 0.35
"""A body whose S is lower than this in every view is not believed."""
LOST_FRAMES: Final = 5
"""After so many frames of it in a row the body is lost."""


def status_of(badly: int, otherwise: Status) -> Status:
    """The status of a body.

    Args:
        badly: For how many frames it has fitted badly.
        otherwise: What it is while it fits.
    """
    if badly >= LOST_FRAMES:
        return "lost"
    return "predicted" if badly else otherwise
