"""Which viewers report, and why one does not: what is said when a view is lost and found again."""

from typing import Final, NamedTuple

from common.bus.control_messages import Ended
from common.bus.messages import CameraFault, View, ViewerNumber
from common.bus.rate import silent
from integrator.pairing import with_item

OVER_S: Final = 0.5
"""A clip that ends so much before the other's is worth a word; both never end at once."""
CLOSING_S: Final = 0.25
"""A viewer that ends says so and leaves the bus, and the two may be heard in either order."""
GONE_S: Final = 60.0
"""How long a viewer that was killed, or whose video broke, is waited for when no other is left: it
may be started again, which takes some seconds, half a minute on a busy machine."""
MOST_NEWS: Final = 20
"""Lines that are kept for the end of the run; a link that flickers would fill the log."""

NEVER_S: Final = float("inf")


class State(NamedTuple):
    """What is known of each viewer; one that is no part of the run counts as over from ever."""

    period_s: float
    began_s: float = NEVER_S
    """When the first report of the run came, by the room's clock; from then on silence counts."""
    heard_s: tuple[float, ...] = (0.0, 0.0)
    """When the last report of each came."""
    gone_s: tuple[float, ...] = (NEVER_S, NEVER_S)
    """Since when each is no longer on the bus."""
    over_s: tuple[float, ...] = (NEVER_S, NEVER_S)
    """Since when each has ended."""
    why_over: tuple[str, ...] = ("", "")
    fault: tuple[CameraFault, ...] = ("", "")
    """What is wrong with the last picture of each."""
    lost_for: tuple[str, ...] = ("", "")
    """Why each view is lost, as it was told; "" while it is not."""
    news: tuple[str, ...] = ()
    """All that was told, a line each."""


def init(period_s: float, viewers: tuple[ViewerNumber, ...], cameras: int = 2) -> State:
    """Nothing was heard of the viewers of a run, on a rig of so many cameras."""
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
    """A viewer reports: it is there, whatever the bus says."""
    own = report.viewer - 1
    if state.began_s == NEVER_S:
        state = state._replace(began_s=now_s, heard_s=(now_s,) * len(state.heard_s))
    return state._replace(
        heard_s=with_item(state.heard_s, own, now_s),
        gone_s=with_item(state.gone_s, own, NEVER_S),
        fault=with_item(state.fault, own, report.fault),
    )


def came(state: State, viewer: ViewerNumber, now_s: float) -> State:
    """A viewer is on the bus; where it was gone or over, it has yet to report to be back."""
    own = viewer - 1
    missed = state.gone_s[own] != NEVER_S or state.over_s[own] != NEVER_S
    return state._replace(
        heard_s=with_item(state.heard_s, own, now_s),
        gone_s=with_item(state.gone_s, own, now_s if missed else NEVER_S),
        over_s=with_item(state.over_s, own, NEVER_S),
    )


def went(state: State, viewer: ViewerNumber, now_s: float) -> State:
    """A viewer is no longer on the bus."""
    return state._replace(gone_s=with_item(state.gone_s, viewer - 1, now_s))


def ended(state: State, said: Ended, now_s: float) -> State:
    """A viewer has said its last."""
    own = said.viewer - 1
    return state._replace(
        over_s=with_item(state.over_s, own, now_s),
        why_over=with_item(state.why_over, own, said.why),
    )


def going(state: State, now_s: float) -> bool:
    """Whether anything is still to be expected."""
    return any(
        (over_s == NEVER_S or why_over) and now_s - min(over_s, gone_s) <= GONE_S
        for over_s, why_over, gone_s in zip(state.over_s, state.why_over, state.gone_s, strict=True)
    )


def step(state: State, now_s: float) -> tuple[State, list[str]]:
    """What has become of the viewers since the step before, a line for each change."""
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
    """Why a view is lost; "" while it is not, and for a viewer that is no part of the run."""
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
    """What to say where a view is lost or found; another cause for the same loss is no news."""
    before, cause = state.lost_for[own], causes[own]
    if bool(cause) == bool(before):
        return []
    if before:
        return [f"view {own + 1} is back"]
    left = [n for n, why in enumerate(causes) if not why and state.over_s[n] == NEVER_S]
    return [f"view {own + 1} is lost ({cause}); {_going_on(left)}"]


def _going_on(left: list[int]) -> str:
    """What is said of the views that are left."""
    if not left:
        return "nobody looks now"
    if len(left) == 1:
        return f"view {left[0] + 1} goes on alone"
    return f"views {', '.join(str(n + 1) for n in left)} go on"
