"""Each person's own views of an instant, as evidence about the rig."""

from collections.abc import Mapping

import msgspec

from common.bus.messages import Body, View
from integrator.people.lived_instant import Merged


def own_views(reports: Mapping[int, View], merged: Merged) -> list[tuple[Body, dict[int, View]]]:
    """What is evidence about the rig: each person in the views where no other is close to them, as
    of two who are close one view may have shown the other for a moment.

    Args:
        reports: All views of an instant, by number.
        merged: What it gave.
    """
    if not merged.of_each:  # one person is followed, or no person is known
        return [(merged.bodies[0], dict(reports))]
    return [
        (body, {n: _alone(own.views[n - 1], report) for n, report in reports.items()})
        for body, own in zip(merged.bodies, merged.of_each, strict=True)
    ]


def _alone(own: View | None, whole: View) -> View:
    """A person's view; without people where another is close to them."""
    if own is not None and _is_apart(own, whole):
        return own
    return msgspec.structs.replace(whole, people=())


def _is_apart(own: View, whole: View) -> bool:
    """Whether the person of a view touches no other one there."""
    person = own.person
    return person is not None and not any(
        person.box.meets(other.box) for other in whole.people if other.track != person.track
    )
