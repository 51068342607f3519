"""The reports of one instant."""

from typing import NamedTuple

from common.bus.messages import Report

Seen = tuple[Report | None, Report | None]
"""Reports of viewer 1 and viewer 2 in which there is somebody."""


class Pair(NamedTuple):
    """What the viewers report of one instant; None where a viewer does not."""

    first: Report | None
    second: Report | None

    @property
    def newest(self) -> Report:
        """The report whose frame was taken last; of a pair one at least is there."""
        return max((r for r in self if r is not None), key=lambda report: report.clock_s)

    @property
    def detections(self) -> Seen:
        """The reports in which somebody is seen."""
        first, second = (None if r is None or r.box is None else r for r in self)
        return first, second
