"""Sizes of working pictures."""

from typing import Final

SMALLEST: Final = 32
LARGEST: Final = 4096
"""Bounds of each side, pixels."""


def size_of(text: str) -> tuple[int, int]:
    """A picture size as it is written, `160x120`.

    Raises:
        ValueError: When it is no size, or none between 32x32 and 4096x4096.
    """
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise ValueError(f"size must look like 160x120, got {text!r}")
    if not all(SMALLEST <= int(side) <= LARGEST for side in (width, height)):
        raise ValueError(
            f"size must be from {SMALLEST}x{SMALLEST} to {LARGEST}x{LARGEST} pixels, got {text}"
        )
    return int(width), int(height)


def size_within(source: tuple[int, int], bound: tuple[int, int]) -> tuple[int, int]:
    """The largest size of the source's shape within the bound; never larger than the source."""
    shrink = min(1.0, bound[0] / source[0], bound[1] / source[1])
    return max(1, round(source[0] * shrink)), max(1, round(source[1] * shrink))


def working_size(source: tuple[int, int], bound: tuple[int, int]) -> tuple[int, int]:
    """The size at which a source's pictures are worked on: the largest of its shape within the
    bound, which is turned as the source is. So an upright video has as many pixels as a wide one.
    """
    is_turned = (source[0] < source[1]) != (bound[0] < bound[1])
    return size_within(source, bound[::-1] if is_turned else bound)
