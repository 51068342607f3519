"""The clicked point to check first: the one without which all others fit best."""

from collections.abc import Callable, Sequence
from typing import Final

import msgspec

from animator.marking.sheet import Seen, Sheet

NOISE_PX2: Final = 1e-6
"""Tolerances: sums of squares that differ by less are equal, and points with a smaller error are
good."""


def suspect_point(
    sheet: Sheet, views: Sequence[int], seen_by: Callable[[Sheet, int], Seen]
) -> tuple[int, int] | None:
    """Camera (its index in `views`) and mark; None where all fit, or the fit cannot show it.

    A point with leverage pulls the fit to itself, so the largest residual may belong to another. So
    each is left out in turn. Where that does not help, as with three points on a line, it is the
    one with the largest residual.

    Args:
        sheet: The points.
        views: Numbers of the cameras, 1 or 2.
        seen_by: Evaluates the points of a camera.
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
    """The sheet without a mark's click in camera 1 or 2."""
    own = sheet.marks[mark]
    px = (None, own.px[1]) if number == 1 else (own.px[0], None)
    left = msgspec.structs.replace(own, px=px)
    marks = (*sheet.marks[:mark], left, *sheet.marks[mark + 1 :])
    return msgspec.structs.replace(sheet, marks=marks)


def _squares(seen: Seen) -> float:
    return sum(off_px**2 for off_px in seen.off_px if off_px is not None)
