"""How a camera's picture lies after the camera was moved: what viewers tell of it."""

import msgspec


class Shift(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How a picture lies against what the same camera showed at the start of the run."""

    right_px: float
    """How far to the right what was in its middle is now."""
    down_px: float
    roll_deg: float
    """By how much it has turned about its middle, clockwise."""
