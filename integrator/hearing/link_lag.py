"""How late each view's reports come: what its link always takes, not what a hiccup does."""

from typing import Final, NamedTuple

from common.bus.messages import ViewerNumber

LOOKS_AT: Final = 30
"""Reports: the quickest of so many tells what the link takes. Who froze and catches up is late in a
few of them only."""
LONGEST_S: Final = 0.5
"""Nobody is waited for longer: bodies that come later than that are of little use live."""


class State(NamedTuple):
    """How late the last reports of each view came, seconds."""

    period_s: float
    of_late: tuple[tuple[float, ...], tuple[float, ...]] = ((), ())
    told: tuple[bool, bool] = (False, False)
    """That it is slow."""
    news: tuple[str, ...] = ()


def init(period_s: float) -> State:
    """Nothing was heard."""
    return State(period_s)


def heard(state: State, viewer: ViewerNumber, late_s: float) -> State:
    """A report came, so long after its picture was taken."""
    first, second = state.of_late
    if viewer == 1:
        return state._replace(of_late=((*first, late_s)[-LOOKS_AT:], second))
    return state._replace(of_late=(first, (*second, late_s)[-LOOKS_AT:]))


def lag_s(state: State) -> float:
    """How long the slower view's reports are to be waited for beyond what others are."""
    slowest = max((min(of_late) for of_late in state.of_late if of_late), default=0.0)
    return min(LONGEST_S, max(0.0, slowest))


def told(state: State, now_s: float) -> tuple[State, list[str]]:
    """What is to be said of slow links, once each time that one becomes so.

    Args:
        state: As it is.
        now_s: Seconds since the run began.
    """
    lines: list[str] = []
    flags = list(state.told)
    for own, of_late in enumerate(state.of_late):
        if len(of_late) < LOOKS_AT:
            continue
        slow_s = min(of_late)
        if slow_s > state.period_s and not flags[own]:
            lines.append(
                f"{now_s:.1f} s: view {own + 1} is heard {slow_s:.2f} s late: its link is slow, or "
                "its clock was set; "
                + ("bodies wait for it" if slow_s <= LONGEST_S else "bodies go without it")
            )
        flags[own] = slow_s > state.period_s * (0.5 if flags[own] else 1.0)
    return state._replace(told=(flags[0], flags[1]), news=(*state.news, *lines)), lines
