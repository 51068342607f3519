"""Facade or flank, settled between the two viewers: exactly one sees the facade (section 4.3)."""

from typing import NamedTuple

from common.body.observation import Facing


class Sight(NamedTuple):
    """One viewer's input to the arbiter."""

    before: Facing
    """Its facing at the frame before."""
    vote: Facing
    """Its own vote for the present frame."""
    width_px: float
    """W_u-body: the width of the upper body."""
    th_low_px: float
    th_high_px: float


def arbitrate(first: Sight, second: Sight, scale_ratio: float = 1.0) -> tuple[Facing, Facing]:
    """The facings of viewers 1 and 2, given that one of them sees the facade and the other the
    flank.

    If one viewer alone changed its vote, both would see the same. Two distances from thresholds are
    compared: how far the changed viewer's width lies beyond the one that it crossed, and how far
    the other's lies from the one that it would have to cross. If the first is larger both facings
    change; otherwise the change is reverted. At a tie both stay as they were: the print's > in
    rules 1 and 2 and >= in rules 3 and 4 amount to that. When both change at once, or none does,
    the votes stand.

    Args:
        first: Viewer 1; its `before` differs from viewer 2's.
        second: Viewer 2.
        scale_ratio: Factor from viewer 2's pixels to viewer 1's scale. 1.0 compares raw pixels as
            printed, which a larger picture in one view biases.

    Source: section 4.3, rules (1)-(4) (P48); the start is (facade, flank) (P47).
    """
    if (first.vote == first.before) == (second.vote == second.before):
        return first.vote, second.vote
    strength_1 = _strength_px(first)
    strength_2 = _strength_px(second) * scale_ratio
    if first.vote != first.before:
        believed = strength_1 > strength_2
        return (first.vote, first.before) if believed else (first.before, second.before)
    believed = strength_2 > strength_1
    return (second.before, second.vote) if believed else (first.before, second.before)


def _strength_px(sight: Sight) -> float:
    """Distance of the width from the threshold that was, or would have to be, crossed."""
    changed = sight.vote != sight.before
    to_facade = (sight.vote == "facade") == changed
    return abs(sight.width_px - (sight.th_high_px if to_facade else sight.th_low_px))
