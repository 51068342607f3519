"""When a live run asks which camera contradicts all others, and by what."""

import math
from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

from calibration.gate.odd_camera import OddCamera
from calibration.tracks.joint_tracks import row_of
from common.bus.messages import View
from common.rig.camera import Rig
from integrator.live_rig.odd_job import OddAnswer, OddJob
from integrator.live_rig.rig_job import packed

ASKS_S: Final = (10.0, 20.0, 40.0)
"""Seconds of people in two views or more after which it is asked."""
MOST_ROWS: Final = 1_200
"""Number of a person's first rows that are kept of each view: 40 s at 30 frames a second."""
MOST_PEOPLE: Final = 6
"""Number of people whose rows are kept: as many as are known at once."""
MOST_TURNS: Final = 3
"""Number of times that a run turns a camera back."""

Rows = tuple[tuple[bytes, ...], ...]
"""Packed rows of a person, by view."""


class State(NamedTuple):
    """Gathered observations of a rig, and requests."""

    calibration: int
    """Number of the rig that they are evidence about."""
    rows: Mapping[int, Rows] = {}
    """By person's number."""
    last_s: tuple[float, ...] = ()
    """Time of each view's last row."""
    shown_s: float = 0.0
    """How long two views or more looked at a person."""
    asked: int = 0
    waits: bool = False
    """A request is not answered yet."""
    is_stale: bool = False
    """It is about another rig."""
    turns: int = 0
    """Number of cameras turned back so far."""

    @property
    def is_over(self) -> bool:
        """No further request will follow for this rig."""
        return self.asked == len(ASKS_S) or self.turns == MOST_TURNS


def anew(state: State, calibration: int) -> State:
    """A new search, with another rig: what was seen before is no evidence about it."""
    return State(
        calibration,
        last_s=state.last_s,
        waits=state.waits,
        is_stale=state.waits,
        turns=state.turns,
    )


def step(
    state: State, rig: Rig, people: Mapping[int, Mapping[int, View]], period_s: float
) -> tuple[State, OddJob | None]:
    """Process one instant; return the next request, if any.

    Args:
        state: Before it.
        rig: In use.
        people: By person's number, then by view: where no other person is close to them.
        period_s: Time between instants.
    """
    if state.is_over:
        return state, None
    cameras = len(rig.cameras)
    last_s = state.last_s or (-math.inf,) * cameras
    rows, shown = dict(state.rows), False
    for number, views in people.items():
        fresh = {n: view for n, view in views.items() if view.captured_s > last_s[n - 1]}
        if sum(map(_is_looked_at, fresh.values())) > 1:
            shown = True
            rows[number] = _with_rows(rows.get(number, ((),) * cameras), fresh)
    rows = _bounded(rows)
    newest = list(last_s)
    for views in people.values():
        for n, view in views.items():
            newest[n - 1] = max(newest[n - 1], view.captured_s)
    shown_s = state.shown_s + (period_s if shown else 0.0)
    state = state._replace(rows=rows, last_s=tuple(newest), shown_s=shown_s)
    if state.waits or shown_s < ASKS_S[state.asked]:
        return state, None
    tracks = tuple(tuple(b"".join(view) for view in own) for own in rows.values())
    state = state._replace(asked=state.asked + 1, waits=True)
    return (state._replace(rows={}) if state.is_over else state), OddJob(rig, tracks)


def answered(state: State, answer: OddAnswer) -> tuple[State, OddCamera | None]:
    """Process an answer; return the camera that is to be turned back."""
    was_stale = state.is_stale
    state = state._replace(waits=False, is_stale=False)
    if was_stale or not isinstance(answer, OddCamera):
        return state, None
    return state._replace(turns=state.turns + 1), answer


def _is_looked_at(view: View) -> bool:
    """Whether a view has landmarks of this very frame: a late one has none, or carries them on."""
    person = view.person
    return person is not None and person.landmarks is not None and not person.carried


def _with_rows(rows: Rows, views: Mapping[int, View]) -> Rows:
    """The rows with one more of each view, up to MOST_ROWS."""
    more = list(rows)
    for number, view in views.items():
        if len(more[number - 1]) < MOST_ROWS:
            more[number - 1] = (*more[number - 1], packed(row_of(view)))
    return tuple(more)


def _bounded(rows: dict[int, Rows]) -> dict[int, Rows]:
    """The rows without those of whom fewest are known, where there are too many people."""
    while len(rows) > MOST_PEOPLE:
        del rows[min(rows, key=lambda number: _count(rows[number]))]
    return rows


def _count(own: Sequence[Sequence[bytes]]) -> int:
    return max(map(len, own))
