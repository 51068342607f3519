"""The views of one instant, in the order of the rig's cameras."""

from collections.abc import Mapping
from typing import TypeVar

import msgspec

from common.body.observation import Observation
from common.bus.messages import View

Seen = tuple[Observation | None, ...]
"""One person in every camera, in the rig's order; None where a camera does not see them."""
TwoSeen = tuple[Observation | None, Observation | None]
"""One person in two cameras, for methods that take two."""
TwoViews = tuple[View | None, View | None]
"""The views of two cameras."""

Item = TypeVar("Item")


class Instant(msgspec.Struct, frozen=True):
    """The views of one instant."""

    views: tuple[View | None, ...]
    """In the order of the rig's cameras, index n - 1 is camera n; None where it sent no view."""

    @property
    def newest(self) -> View:
        """The view whose frame was taken last; an instant has at least one."""
        return max((v for v in self.views if v is not None), key=lambda view: view.clock_s)

    @property
    def detections(self) -> Seen:
        """The person as each view sees them."""
        return tuple(None if view is None else view.person for view in self.views)


def instant_of(views: Mapping[int, View], cameras: int) -> Instant:
    """The instant for views by their viewers' numbers, in a rig of that many cameras."""
    return Instant(tuple(views.get(number) for number in range(1, cameras + 1)))


def first_two(each: tuple[Item | None, ...]) -> tuple[Item | None, Item | None]:
    """The views of cameras 1 and 2, for methods that take two; None for a missing one."""
    first, second = (*each, None)[:2]
    return first, second
