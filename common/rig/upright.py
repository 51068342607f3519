"""How the picture that is worked on lies: upright, with square pixels, shifted."""

import msgspec

Size = tuple[int, int]
"""Width and height, pixels."""


class Upright(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How the picture that is worked on comes from that of the file."""

    width: int
    """Of the file's picture at the working size, as `--size` bounds it; `height` likewise."""
    height: int
    quarters: int
    """By how many quarter turns it is turned clockwise, after its pixels were made square."""
    square_width: int
    """Of the same with square pixels; `square_height` likewise."""
    square_height: int

    @property
    def size(self) -> Size:
        """Of the picture that is worked on."""
        return swapped((self.square_width, self.square_height), self.quarters)


class Shift(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How a picture lies against what the same camera showed at the start of the run."""

    right_px: float
    """How far to the right what was in its middle is now."""
    down_px: float
    roll_deg: float
    """By how much it has turned about its middle, clockwise."""


Uprights = tuple[Upright | None, ...]
"""Of each view, in the order of the rig's cameras; None: the picture that is worked on is the
file's, made smaller."""


def swapped(size: Size, quarters: int) -> Size:
    """The size of a picture after quarter turns."""
    return (size[1], size[0]) if quarters % 2 else size
