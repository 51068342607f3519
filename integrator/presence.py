"""Which viewers report, and why one does not: the lines when a view is lost and found again."""

from typing import Final, NamedTuple

from common.bus.control_messages import Ended
from common.bus.messages import CameraFault, View, ViewerNumber, place_in_rig
from common.bus.rate import silent
from integrator.pairing import with_item

OVER_S: Final = 0.5
"""Difference of two clips' ends, seconds, from which on it is reported; they never end at once."""
CLOSING_S: Final = 0.25
"""Time, seconds, within which a viewer's end and its departure from the bus may arrive in either
order."""
GONE_S: Final = 60.0
"""How long the last viewer is waited for, seconds, after it was killed or its video failed: it
may be restarted, which takes some seconds, half a minute on a busy machine."""
MOST_NEWS: Final = 20
"""Number of lines kept for the end of the run; a flickering link would fill the log."""

NEVER_S: Final = float("inf")


class State(NamedTuple):
    """The state of each viewer; one that is no part of the run counts as ended from the start."""

    period_s: float
    began_s: float = NEVER_S
    """Time of the run's first report, by the room's clock; from then on silence counts."""
    heard_s: tuple[float, ...] = (0.0, 0.0)
    """Time of each viewer's last report."""
    gone_s: tuple[float, ...] = (NEVER_S, NEVER_S)
    """Time since when each is off the bus."""
    over_s: tuple[float, ...] = (NEVER_S, NEVER_S)
    """Time since when each has ended."""
    why_over: tuple[str, ...] = ("", "")
    fault: tuple[CameraFault, ...] = ("", "")
    """Fault of each viewer's last picture."""
    lost_for: tuple[str, ...] = ("", "")
    """The reported cause of each lost view; "" while it is present."""
    news: tuple[str, ...] = ()
    """All lines so far."""


def init(period_s: float, viewers: tuple[ViewerNumber, ...], cameras: int = 2) -> State:
    """The viewers of a run before any report, on a rig of that many cameras."""
    numbers = range(1, cameras + 1)
    sound: CameraFault = ""
    return State(
        period_s,
        heard_s=(0.0,) * cameras,
        gone_s=(NEVER_S,) * cameras,
        over_s=tuple(NEVER_S if number in viewers else -NEVER_S for number in numbers),
        why_over=("",) * cameras,
        fault=(sound,) * cameras,
        lost_for=("",) * cameras,
    )


def heard(state: State, report: View, now_s: float) -> State:
    """A viewer reports: it is present, whatever the bus says."""
    own = place_in_rig(report.viewer)
    if state.began_s == NEVER_S:
        state = state._replace(began_s=now_s, heard_s=(now_s,) * len(state.heard_s))
    return state._replace(
        heard_s=with_item(state.heard_s, own, now_s),
        gone_s=with_item(state.gone_s, own, NEVER_S),
        fault=with_item(state.fault, own, report.fault),
    )


def came(state: State, viewer: ViewerNumber, now_s: float) -> State:
    """A viewer is on the bus; after an absence or an end it must report to be present again."""
    own = place_in_rig(viewer)
    missed = state.gone_s[own] != NEVER_S or state.over_s[own] != NEVER_S
    return state._replace(
        heard_s=with_item(state.heard_s, own, now_s),
        gone_s=with_item(state.gone_s, own, now_s if missed else NEVER_S),
        over_s=with_item(state.over_s, own, NEVER_S),
    )


def went(state: State, viewer: ViewerNumber, now_s: float) -> State:
    """A viewer is no longer on the bus."""
    return state._replace(gone_s=with_item(state.gone_s, place_in_rig(viewer), now_s))


def ended(state: State, said: Ended, now_s: float) -> State:
    """A viewer has ended."""
    own = place_in_rig(said.viewer)
    return state._replace(
        over_s=with_item(state.over_s, own, now_s),
        why_over=with_item(state.why_over, own, said.why),
    )


def going(state: State, now_s: float) -> bool:
    """Whether any report can still come."""
    return any(
        (over_s == NEVER_S or why_over) and now_s - min(over_s, gone_s) <= GONE_S
        for over_s, why_over, gone_s in zip(state.over_s, state.why_over, state.gone_s, strict=True)
    )


def step(state: State, now_s: float) -> tuple[State, list[str]]:
    """Changes of the viewers' state since the step before, a line for each."""
    if now_s < state.began_s:
        return state, []
    causes = tuple(_cause(state, own, now_s) for own in range(len(state.over_s)))
    told = [
        f"{now_s - state.began_s:.1f} s: {line}"
        for own in range(len(causes))
        for line in _changed(own, state, causes)
    ]
    lost_for = tuple(
        cause and (before or cause) for cause, before in zip(causes, state.lost_for, strict=True)
    )
    news = (*state.news, *told)[-MOST_NEWS:]
    return state._replace(lost_for=lost_for, news=news), told


def _cause(state: State, own: int, now_s: float) -> str:
    """Why a view is lost; "" while it is present, and for a viewer that is no part of the run."""
    if state.over_s[own] == -NEVER_S:
        return ""
    if state.over_s[own] != NEVER_S:
        last = now_s - state.over_s[own] <= OVER_S or not going(state, now_s)
        return state.lost_for[own] if last else state.why_over[own] or "its clip is over"
    if state.gone_s[own] != NEVER_S:
        closing = now_s - state.gone_s[own] <= CLOSING_S
        return state.lost_for[own] if closing else "it was killed, or its link is cut"
    if silent(1.0 / state.period_s, state.heard_s[own], now_s):
        return "it says nothing: it hangs, or its camera gives no picture"
    return f"its camera's picture is {state.fault[own]}" if state.fault[own] else ""


def _changed(own: int, state: State, causes: tuple[str, ...]) -> list[str]:
    """The line for a view that is lost or found; another cause for the same loss is no news."""
    before, cause = state.lost_for[own], causes[own]
    if bool(cause) == bool(before):
        return []
    if before:
        return [f"view {own + 1} is back"]
    left = [n for n, why in enumerate(causes) if not why and state.over_s[n] == NEVER_S]
    return [f"view {own + 1} is lost ({cause}); {_going_on(left)}"]


def _going_on(left: list[int]) -> str:
    """The line about the remaining views."""
    if not left:
        return "nobody looks now"
    if len(left) == 1:
        return f"view {left[0] + 1} goes on alone"
    return f"views {', '.join(str(n + 1) for n in left)} go on"
