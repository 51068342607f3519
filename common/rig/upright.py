"""How the working picture comes from the file's: turned upright, square pixels, shifted."""

import msgspec

Size = tuple[int, int]
"""Width and height, pixels."""


class Upright(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How the working picture comes from that of the file."""

    width: int
    """Width of the file's picture at the working size, as `--size` bounds it; `height` likewise."""
    height: int
    quarters: int
    """Clockwise quarter turns, after the pixels were made square."""
    square_width: int
    """The same with square pixels; `square_height` likewise."""
    square_height: int

    @property
    def size(self) -> Size:
        """Size of the working picture."""
        return swapped((self.square_width, self.square_height), self.quarters)


class Shift(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Displacement of a picture since the start of the run."""

    right_px: float
    """Motion of the picture's middle to the right, pixels."""
    down_px: float
    roll_deg: float
    """Clockwise rotation about the middle."""


Uprights = tuple[Upright | None, ...]
"""For each view, in the order of the rig's cameras; None: the working picture is the file's,
reduced."""


def swapped(size: Size, quarters: int) -> Size:
    """The size of a picture after quarter turns."""
    return (size[1], size[0]) if quarters % 2 else size
