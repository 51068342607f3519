"""What both views saw in the last seconds, kept for the case that a camera is moved."""

from typing import Final, NamedTuple

from calibration.tracks.joint_tracks import LEAST_SURE, row_of
from common.bus.instant import TwoViews
from common.bus.messages import View
from common.rig.camera import Rig
from integrator.live_rig.rig_job import Stand, packed

KEPT_S: Final = 8.0
"""So long is kept what was seen."""
NOTICED_S: Final = 1.0
"""So long before a move is told the camera may have been moved already."""


class State(NamedTuple):
    """The last frames in which both views were sure of somebody."""

    rows: tuple[tuple[float, bytes, bytes], ...] = ()
    """When, and what each view saw."""


def step(state: State, views: TwoViews) -> State:
    """One instant more.

    Args:
        state: What was kept.
        views: Of the instant.
    """
    first, second = views
    if first is None or second is None or not (_shows(first) and _shows(second)):
        return state
    one, other = row_of(first), row_of(second)
    if min(one[2].mean(), other[2].mean()) < LEAST_SURE:
        return state
    row = (first.captured_s, packed(one), packed(other))
    return State((*(kept for kept in state.rows if kept[0] > row[0] - KEPT_S), row))


def stand_before(state: State, rig: Rig, now_s: float) -> Stand:
    """What was seen before a move that is told now, and the rig that was right then."""
    kept = [row for row in state.rows if row[0] < now_s - NOTICED_S]
    return Stand(rig, (b"".join(row[1] for row in kept), b"".join(row[2] for row in kept)))


def _shows(view: View) -> bool:
    return view.person is not None and view.person.landmarks is not None
