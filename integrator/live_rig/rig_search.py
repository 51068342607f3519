"""When a run requests a rig from its person, and whether it accepts the result."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from calibration.tracks.joint_tracks import (
    JOINTS,
    LEAST_SURE,
    Row,
    is_upright,
    row_of,
)
from calibration.tracks.lateness import LEAST_LATE
from common.body.observation import Box, Landmarks
from common.bus.instant import Instant, TwoViews
from common.bus.messages import View, ViewerNumber
from common.rig.camera import Rig
from integrator.live_rig.rig_job import Job, Solution, Solved, Stand, Trusted, Unsolved, packed

ASKS_S: Final = (4.0, 8.0, 16.0, 32.0)
"""Seconds of motion in both views after which a rig is requested."""
MOVED: Final = 0.04
"""Mean distance that joints must move for the person to count as moving, heights of the person."""
STILL_S: Final = 1.0
"""Seconds without motion after which further instants are not gathered."""
MOST_GAP_MM: Final = 35.0
"""Largest mean distance between a believable rig's sight lines of one joint, millimetres: 15 to
21 for two performers (docs/measurements.md)."""
MOST_TURN_DEG: Final = 15.0
"""Largest standard deviation of camera 2's yaw, degrees: 4 to 10 for two performers
(docs/measurements.md)."""
BETTER: Final = 0.7
"""Ratio of the views' distance with a new rig to that with the one in use, below which the new
one may replace it."""
BETTER_MM: Final = 5.0
"""Smallest gain in the views' distance for that, millimetres."""
MORE: Final = 4.0
"""Factor of motion from which on a rig replaces the one in use whatever it gains: two
performers' error of 31 and 33 mm after 4 s became 27 after 16 s (docs/measurements.md)."""


class State(NamedTuple):
    """Gathered observations, requests, and the rig in use."""

    period_s: float
    stature_m: float
    rows: tuple[tuple[bytes, ...], tuple[bytes, ...]] = ((), ())
    """Rows of view 1 and view 2, packed, while a person moves; an empty row where some are left
    out."""
    last_s: tuple[float, float] = (-math.inf, -math.inf)
    """Time of each view's last row."""
    gap: bool = True
    """The last rows are empty."""
    size_px: tuple[int, int] = (0, 0)
    """Size of the pictures."""
    moved_s: float = 0.0
    """How long a person has moved."""
    posed: tuple[float, NDArray[np.float64]] | None = None
    """Time of the last motion, and the posture then: (15, 2) in view 1, in heights."""
    asked: int = 0
    waits: bool = False
    """A request is not answered yet."""
    rig: Rig | None = None
    """The accepted rig; None: it is assumed."""
    taken: int = 0
    """The number of the request that gave it."""
    late_s: float = 0.0
    """Time by which the times of view 2 are set back already."""
    refusal: str = ""
    """Why the last one was rejected."""
    moved: tuple[ViewerNumber, ...] = ()
    """Moved cameras: they are searched for, the others keep their places."""
    stood: Stand | None = None
    """Observations from before that."""
    is_stale: bool = False
    """The pending request is outdated: cameras were moved since."""

    @property
    def is_over(self) -> bool:
        """There will be no further requests."""
        return self.asked == len(ASKS_S) and not self.waits


def init(period_s: float, stature_m: float) -> State:
    """The state before any observation.

    Args:
        period_s: Time between frames.
        stature_m: Assumed stature of the person.
    """
    return State(period_s, stature_m)


def anew(
    state: State,
    rig: Rig | None,
    moved: tuple[ViewerNumber, ...] = (),
    stood: Stand | None = None,
) -> State:
    """A new search: earlier observations say nothing about the cameras' present places.

    Args:
        state: The search so far.
        rig: The rig in use; None: it is assumed.
        moved: Cameras that are known to have been moved.
        stood: Observations from before that.
    """
    return init(state.period_s, state.stature_m)._replace(
        last_s=state.last_s,
        rig=rig,
        late_s=state.late_s,
        moved=moved,
        stood=stood,
        waits=state.waits,
        is_stale=state.waits,
    )


def step(state: State, views: TwoViews) -> tuple[State, Job | None]:
    """Process one instant, with at least one of both reports; return the next request, if any."""
    if state.asked == len(ASKS_S):
        return state, None
    state = _gathered(state, views)
    if state.waits or state.moved_s < ASKS_S[state.asked]:
        return state, None
    first, second = (b"".join(rows) for rows in state.rows)
    job = Job(
        state.size_px,
        state.stature_m,
        state.period_s,
        (first, second),
        state.rig,
        state.moved,
        state.late_s,
        state.stood,
    )
    state = state._replace(asked=state.asked + 1, waits=True)
    return (state._replace(rows=((), ())) if state.asked == len(ASKS_S) else state), job


def answered(state: State, answer: Solution) -> tuple[State, Solved | None]:
    """Process an answer; return it where its rig is the run's from now on."""
    if state.is_stale:
        return state._replace(waits=False, is_stale=False), None
    state = state._replace(waits=False, refusal=refusal_of(answer))
    if isinstance(answer, Unsolved) or state.refusal:
        return state, None
    if state.rig is not None and not is_better(state, answer):
        return state, None
    late_s = set_back_s(answer, state.period_s)
    return state._replace(rig=answer.rig, late_s=late_s, taken=state.asked), answer


def set_back_s(solved: Solved, period_s: float) -> float:
    """Time by which the times of view 2 shall be set back; 0 for less than a share of a frame."""
    return solved.late_s if abs(solved.late_s) >= LEAST_LATE * period_s else 0.0


def refusal_of(answer: Solution) -> str:
    """Why a rig is not believed, "" for a believable one."""
    if isinstance(answer, Unsolved):
        return answer.refusal
    trust = answer.trust
    odd = [word for word in trust.odd if word != "late"]
    if odd or answer.gap_mm > MOST_GAP_MM:
        return f"both views stay {trust.apart_mm:.0f} mm apart ({', '.join(odd) or 'gaps'})"
    if answer.turn_error_deg > MOST_TURN_DEG:
        return f"camera 2 is known to {answer.turn_error_deg:.0f} degrees only"
    return ""


def why_none(state: State) -> str:
    """Why the person gave no rig."""
    if state.waits:
        return "what the person tells was not found in time"
    if state.refusal:
        return f"the person tells none ({state.refusal})"
    return f"both cameras saw somebody move for {state.moved_s:.0f} s, of {ASKS_S[0]:.0f} needed"


def is_better(state: State, solved: Solved) -> bool:
    """Whether a believable rig is clearly better than the one in use, by all observations.

    It is better where views agree clearly more by it, or as much where far more motion was seen. A
    moved camera is always placed by the person first: its picture shows its turn alone, and views
    may seem to agree where it is a step aside.
    """
    new, old = solved.trust, solved.before
    if old is None or not _holds(old) or (state.moved and not state.taken):
        return True
    gain_mm = old.apart_mm - new.apart_mm
    if ASKS_S[state.asked - 1] >= MORE * ASKS_S[state.taken - 1]:
        return gain_mm >= 0.0
    return gain_mm > BETTER_MM and new.apart_mm < BETTER * old.apart_mm


def _holds(trust: Trusted) -> bool:
    return set(trust.odd) <= {"late"}


def _gathered(state: State, views: TwoViews) -> State:
    """The state with an instant in which a person moves before both views."""
    first, second = views
    seen = None if first is None else _sure_person(first)
    if first is None or second is None or seen is None or _sure_person(second) is None:
        return _left_out(state, views)
    size_px = (first.width, first.height)
    if size_px != (second.width, second.height):
        return state
    state = state._replace(size_px=size_px)
    now_s, pose = first.captured_s, _pose(*seen)
    posed = state.posed
    if posed is None or float(np.abs(pose - posed[1]).mean()) >= MOVED:
        posed = now_s, pose
    state = state._replace(posed=posed)
    if now_s - posed[0] > STILL_S:
        return _left_out(state, views)
    state = _with_row(_with_row(state, 0, row_of(first)), 1, row_of(second))
    return state._replace(moved_s=state.moved_s + state.period_s, gap=False)


def _sure_person(view: View) -> tuple[Box, Landmarks] | None:
    """Box and landmarks of an upright person whose landmarks are sure, if a view shows one."""
    person = view.person
    if person is None or person.landmarks is None or not is_upright(person.landmarks):
        return None
    is_sure = float(np.mean(person.landmarks.confidence)) >= LEAST_SURE
    return (person.box, person.landmarks) if is_sure else None


def _pose(box: Box, shown: Landmarks) -> NDArray[np.float64]:
    """(15, 2) the landmarks about their middle, in heights of the silhouette."""
    joints_px = np.array(shown.joints_px)
    return (joints_px - joints_px.mean(axis=0)) / max(box.bottom - box.top, 1)


def _left_out(state: State, views: TwoViews) -> State:
    """The state with a marked gap: no interpolation goes across it."""
    if state.gap:
        return state
    newest = Instant(views).newest
    for view in (0, 1):
        none = np.zeros(JOINTS)
        row = (newest.captured_s, np.zeros((JOINTS, 2)), none, 0.0, 0.0)
        state = _with_row(state, view, row)
    return state._replace(gap=True)


def _with_row(state: State, view: int, row: Row) -> State:
    """The state with one more row of a view, by its own camera's increasing time."""
    time_s = row[0] + (state.late_s if view else 0.0)
    if time_s <= state.last_s[view]:
        return state
    rows, last_s = list(state.rows), list(state.last_s)
    rows[view] = (*rows[view], packed((time_s, *row[1:])))
    last_s[view] = time_s
    return state._replace(rows=(rows[0], rows[1]), last_s=(last_s[0], last_s[1]))
