"""The reports of one instant, in the order of the rig's cameras."""

from collections.abc import Mapping

import msgspec

from common.bus.messages import Report

Seen = tuple[Report | None, ...]
"""The reports in which a person is seen, in the order of the rig's cameras; None elsewhere."""
TwoViews = tuple[Report | None, Report | None]
"""The same of two cameras, for what takes two views."""


class Instant(msgspec.Struct, frozen=True):
    """What the viewers report of one instant."""

    views: tuple[Report | None, ...]
    """In the order of the rig's cameras, place n - 1 is camera n; None where it reports nothing."""

    @property
    def newest(self) -> Report:
        """The report whose frame was taken last; of an instant one at least is there."""
        return max((r for r in self.views if r is not None), key=lambda report: report.clock_s)

    @property
    def detections(self) -> Seen:
        """The reports in which a person is seen."""
        return tuple(None if r is None or r.box is None else r for r in self.views)


def instant_of(reports: Mapping[int, Report], cameras: int) -> Instant:
    """The instant of reports by their viewers' numbers, of a rig of so many cameras."""
    return Instant(tuple(reports.get(number) for number in range(1, cameras + 1)))


def two_views(seen: Seen) -> TwoViews:
    """Views 1 and 2, for what takes two; None where there is none."""
    first, second = (*seen, None)[:2]
    return first, second
