"""The body's place in the picture, by shifts of the drawn model (section 3.2)."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.kinematics import ALL_LIMBS
from common.compiled import compiled
from common.raster.bits import ONES, Bits, popcount
from common.raster.kernel import CENTRE_X, CENTRE_Y, draw_limbs, score
from viewer.paper.posed_model import PosedModel

SHIFTS_PX: Final = (0, -1, 1, -2, 2, -5, 5)
"""The printed candidates and 0, the present place, the smallest first: ties stay (P27)."""

UPRIGHT: Final = 0b111111
"""Limbs drawn: trunk, head and legs. The arms still have the angles of the frame before, and
would pull the body after them (by 60 mm while they were lowered)."""

MOST_PASSES: Final = 3
"""Number of passes: one leaves an error of a pixel at shifts of 3, 4, 6 and more (P27)."""


@compiled
def extent(bits: Bits) -> tuple[int, int, int, int]:
    """Extent of packed pixels: first row and one past the last, words likewise."""
    top, bottom, begin, end = bits.shape[0], 0, bits.shape[1], 0
    for row in range(bits.shape[0]):
        for word in range(bits.shape[1]):
            if bits[row, word]:
                top, bottom = min(top, row), row + 1
                begin, end = min(begin, word), max(end, word + 1)
    return top, bottom, begin, end


@compiled
def shifted_counts(
    model: Bits, within: tuple[int, int, int, int], seen: Bits, width: int, right: int, down: int
) -> tuple[int, int]:
    """Number of pixels of a shifted model inside the picture, and of those that are seen.

    Args:
        model: Packed rows (H, words).
        within: Extent of the model.
        seen: The silhouette, packed alike.
        width: Width of the picture, pixels.
        right: Shift to the right, pixels, less than 64 either way.
        down: Shift downwards.
    """
    height, words = model.shape
    top, bottom, begin, end = within
    last_ones = ONES >> np.uint64(64 * words - width)
    drawn = hit = 0
    for row in range(max(top, -down), min(bottom, height - down)):
        for word in range(max(0, begin - (right < 0)), min(words, end + (right > 0))):
            bits = model[row, word]
            if right > 0:
                bits <<= np.uint64(right)
                if word > 0:
                    bits |= model[row, word - 1] >> np.uint64(64 - right)
            elif right < 0:
                bits >>= np.uint64(-right)
                if word + 1 < words:
                    bits |= model[row, word + 1] << np.uint64(64 + right)
            if word == words - 1:
                bits &= last_ones
            drawn += popcount(bits)
            hit += popcount(bits & seen[row + down, word])
    return drawn, hit


@compiled
def best_shift(
    model: Bits, seen: Bits, seen_px: int, width: int, shifts: NDArray[np.int64], passes: int
) -> tuple[int, int, float, int]:
    """(right, down, score, matches) of the best shift of the drawn model: x, then y."""
    within = extent(model)
    place = np.zeros(2, np.int64)
    best, matches = -1.0, 0
    for axis in range(2):
        for _ in range(passes):
            start = place[axis]
            winner = start
            for shift in shifts:
                if shift == 0 and best >= 0.0:
                    continue
                place[axis] = start + shift
                drawn, hit = shifted_counts(model, within, seen, width, place[0], place[1])
                matches += 1
                value = score(hit, drawn, seen_px)
                if value > best:
                    best, winner = value, start + shift
            place[axis] = winner
            if winner == start:
                break
    return place[0], place[1], best, matches


def located(model: PosedModel, limbs: int = ALL_LIMBS) -> PosedModel:
    """The model shifted to its best place: columns first, then rows (P27, P28).

    Args:
        model: The model so far.
        limbs: The limbs drawn, as bits.
    """
    drawn = np.zeros_like(model.seen)
    draw_limbs(model.body, model.pose, model.view, limbs, model.width, drawn)
    right, down, value, matches = best_shift(
        drawn, model.seen, model.seen_px, model.width, _SHIFTS, MOST_PASSES
    )
    view = model.view.copy()
    view[CENTRE_X] += right
    view[CENTRE_Y] += down
    return model._replace(view=view, score=value, matches=model.matches + matches)


_SHIFTS = np.array(SHIFTS_PX)
