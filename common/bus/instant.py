"""What the viewers report of one instant, in the order of the rig's cameras."""

from collections.abc import Mapping
from typing import TypeVar

import msgspec

from common.body.observation import Observation
from common.bus.messages import View

Seen = tuple[Observation | None, ...]
"""A person as each camera sees them, in the rig's order; None where one does not."""
TwoSeen = tuple[Observation | None, Observation | None]
"""The same of two cameras, for what takes two."""
TwoViews = tuple[View | None, View | None]
"""What two cameras report."""

Item = TypeVar("Item")


class Instant(msgspec.Struct, frozen=True):
    """What the viewers report of one instant."""

    views: tuple[View | None, ...]
    """In the order of the rig's cameras, place n - 1 is camera n; None where it reports nothing."""

    @property
    def newest(self) -> View:
        """The view whose frame was taken last; of an instant one at least is there."""
        return max((v for v in self.views if v is not None), key=lambda view: view.clock_s)

    @property
    def detections(self) -> Seen:
        """The person as each view sees them."""
        return tuple(None if view is None else view.person for view in self.views)


def instant_of(views: Mapping[int, View], cameras: int) -> Instant:
    """The instant of views by their viewers' numbers, of a rig of so many cameras."""
    return Instant(tuple(views.get(number) for number in range(1, cameras + 1)))


def first_two(each: tuple[Item | None, ...]) -> tuple[Item | None, Item | None]:
    """Of cameras 1 and 2, for what takes two; None where there is none."""
    first, second = (*each, None)[:2]
    return first, second
