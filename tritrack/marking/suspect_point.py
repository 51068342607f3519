"""Which clicked point to look at first: that without which all others fit best."""

from collections.abc import Callable, Sequence
from typing import Final

import msgspec

from animator.marking.sheet import Seen, Sheet

NOISE_PX2: Final = 1e-6
"""Sums of squares that differ by less are the same, and points that are off by less are not."""


def suspect_point(
    sheet: Sheet, views: Sequence[int], seen_by: Callable[[Sheet, int], Seen]
) -> tuple[int, int] | None:
    """Camera (its place in `views`) and mark; None where nothing is off, or nothing could show it.

    A point with leverage draws the fit to itself, so that what is farthest off may be another. So
    each is left out in turn. Where that tells nothing, as of three points on a line, it is the
    farthest off.

    Args:
        sheet: The points.
        views: Numbers of the cameras, 1 or 2.
        seen_by: What points tell of a camera.
    """
    found = []
    for camera, number in enumerate(views):
        seen = seen_by(sheet, number)
        for mark, off_px in enumerate(seen.off_px):
            rest = None if off_px is None else seen_by(without(sheet, mark, number), number)
            if off_px is not None and rest is not None and rest.known:
                gain_px2 = _squares(seen) - _squares(rest)
                found.append((round(gain_px2 / NOISE_PX2), off_px, camera, mark))
    best = max(found, default=None)
    return None if best is None or best[0] <= 1 else best[2:]


def without(sheet: Sheet, mark: int, number: int) -> Sheet:
    """The sheet as if a mark had not been clicked in camera 1 or 2."""
    own = sheet.marks[mark]
    px = (None, own.px[1]) if number == 1 else (own.px[0], None)
    left = msgspec.structs.replace(own, px=px)
    marks = (*sheet.marks[:mark], left, *sheet.marks[mark + 1 :])
    return msgspec.structs.replace(sheet, marks=marks)


def _squares(seen: Seen) -> float:
    return sum(off_px**2 for off_px in seen.off_px if off_px is not None)
