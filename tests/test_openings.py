"""The opening posture of several people in a picture: each is measured by pixels of their own."""

import msgspec
import numpy as np
import pytest
from posing import picture, posed, stretched

from common.body.body import Vector
from common.body.observation import Measure
from common.bus.messages import View
from common.raster.silhouette_report import people_of, silhouette_view
from common.raster.similarity import Mask
from viewer.paper.measure import measure_front, measure_side
from viewer.people.openings import NEAR_PX, TOUCHED, with_opening, with_openings

HIGH, WIDE = 130, 330
FIGURE_PX = 160
"""Width of the picture of one figure, who stands in its middle."""


def at(pose: Vector, left: int) -> Mask:
    """A figure in a wide picture, whose own picture begins at a column."""
    mask = np.zeros((HIGH, WIDE), np.bool_)
    mask[:120, left : left + FIGURE_PX] = picture(pose)
    return mask


def view_of(*masks: Mask) -> View:
    people = tuple(person for mask in masks for person in people_of(mask))
    return msgspec.structs.replace(silhouette_view(1, masks[0]), people=people)


def alone(mask: Mask) -> Measure:
    (person,) = people_of(mask)
    return measure_front(mask, person.box)


def test_each_of_two_who_stand_apart_is_measured_as_if_alone() -> None:
    """Who only stands may be the flank of somebody in the posture, and gives a depth alone."""
    first, second = at(stretched(), 0), at(posed(), 170)
    one, other = with_openings(view_of(first, second)).people
    assert (one.measure, one.refusal) == (alone(first), "")
    (person,) = people_of(second)
    assert other.measure == measure_side(second, person.box)
    assert "arms" in other.refusal
    other, one = with_openings(view_of(second, first)).people
    assert one.measure == alone(first)


@pytest.mark.parametrize("gap_px", [NEAR_PX, 4 * NEAR_PX])
def test_who_touches_another_is_not_measured(gap_px: int) -> None:
    """The arm that goes on in another's silhouette may be theirs: no length comes of it."""
    first = at(stretched(), 0)
    right = int(np.flatnonzero(first.any(axis=0))[-1])
    second = np.zeros_like(first)
    second[30:110, right + gap_px : right + gap_px + 20] = True
    seen = with_openings(view_of(first, second)).people
    touches = gap_px == NEAR_PX
    assert [one.measure is None for one in seen] == [touches, touches]
    assert (seen[0].refusal == TOUCHED) == touches
    followed = with_opening(view_of(first, second), first, None).people
    assert (followed[0].measure is None) == touches
    assert followed[1].measure is None, "one is followed"


def test_who_is_partly_outside_is_not_measured() -> None:
    mask = at(stretched(), 0)
    left = int(np.flatnonzero(mask.any(axis=0))[0])
    (seen,) = with_openings(view_of(np.roll(mask, -left, axis=1))).people
    assert seen.measure is None
    assert "outside" in seen.refusal
