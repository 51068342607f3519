"""Each person's own views of an instant: where no other person is close."""

from typing import Any

import msgspec
import pytest
from staging import report

from common.body.observation import Box
from common.bus.instant import Instant
from common.bus.messages import Body, Guide, View, ViewerNumber
from integrator.people.lived_instant import Merged
from integrator.people.own_views import own_views


def two_in_a_view(viewer: ViewerNumber, gap_px: int) -> tuple[View, View, View]:
    """A view of two people whose boxes are apart by some columns; and of each alone."""
    view = report(viewer, box=Box(left=10, right=40, top=10, bottom=100), track=3)
    (one,) = view.people
    right = Box(left=41 + gap_px, right=80, top=10, bottom=100)
    other = msgspec.structs.replace(one, box=right, track=4)
    both = msgspec.structs.replace(view, people=(other, one))
    return both, view, msgspec.structs.replace(view, people=(other,))


@pytest.mark.parametrize(("gap_px", "views"), [(5, [1, 2]), (-1, [1])])
def test_each_of_several_people_is_evidence_where_no_other_is_close(
    gap_px: int, views: list[int]
) -> None:
    """Of two who are close in view 2 that view may have shown the other for a moment."""
    moment = dict[str, Any](captured_s=0.0, clock_s=0.0, frame=0)
    bodies = tuple(Body(person=n, status="tracking", views="both", **moment) for n in (1, 2))
    first, second = two_in_a_view(1, 5), two_in_a_view(2, gap_px)
    each = (Instant((first[1], second[1])), Instant((first[2], second[2])))
    merged = Merged(bodies, Guide(frames=(0, 0), **moment), each[0], each)
    reports = {1: first[0], 2: second[0]}
    found = own_views(reports, merged)
    shown = [[n for n, view in own.items() if view.people] for _, own in found]
    assert ([body.person for body, _ in found], shown) == ([1, 2], [views, views])
    assert all(sorted(own) == [1, 2] for _, own in found), "a view without them is one all the same"
    assert [own[1].people[0].track for _, own in found] == [3, 4]
    alone = Merged(bodies[:1], merged.guide, each[0])
    assert own_views(reports, alone) == [(bodies[0], reports)]


def test_the_first_of_several_people_is_evidence_by_their_own_views_before_others_are_known() -> (
    None
):
    """The views' first is another, who has no number yet."""
    moment = dict[str, Any](captured_s=0.0, clock_s=0.0, frame=0)
    body = Body(person=1, status="tracking", views="both", **moment)
    first, second = two_in_a_view(1, 5), two_in_a_view(2, 5)
    own = Instant((first[1], second[1]))
    merged = Merged((body,), Guide(frames=(0, 0), **moment), own, (own,))
    found = own_views({1: first[0], 2: second[0]}, merged)
    assert found == [(body, {1: first[1], 2: second[1]})]
