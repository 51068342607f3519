"""Both views' observations of the last seconds, kept in case a camera is moved."""

from typing import Final, NamedTuple

from calibration.tracks.joint_tracks import LEAST_SURE, row_of
from common.bus.instant import TwoViews
from common.bus.messages import View
from common.rig.camera import Rig
from integrator.live_rig.rig_job import Stand, packed

KEPT_S: Final = 8.0
"""How long observations are kept, seconds."""
NOTICED_S: Final = 1.0
"""How long before a reported move the camera may have been moved already, seconds."""


class State(NamedTuple):
    """The last frames in which both views were sure of a person."""

    rows: tuple[tuple[float, bytes, bytes], ...] = ()
    """Time, and each view's observation."""


def step(state: State, views: TwoViews) -> State:
    """Process one instant.

    Args:
        state: The kept observations.
        views: The views of the instant.
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
    """The observations before a move that is reported now, and the rig valid then."""
    kept = [row for row in state.rows if row[0] < now_s - NOTICED_S]
    return Stand(rig, (b"".join(row[1] for row in kept), b"".join(row[2] for row in kept)))


def _shows(view: View) -> bool:
    return view.person is not None and view.person.landmarks is not None
