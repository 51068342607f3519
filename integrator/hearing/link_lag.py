"""How late each view's reports come: what its link always takes, not what a hiccup does."""

from typing import Final, NamedTuple

from common.bus.messages import ViewerNumber
from integrator.pairing import with_item

LOOKS_AT: Final = 30
"""Moments at which reports came: the quickest of so many tells what the link takes."""
LONGEST_S: Final = 0.5
"""Nobody is waited for longer: bodies that come later than that are of little use live."""
SLOW_PERIODS: Final = 2.0
"""A link that takes so many periods is worth a word."""


class Link(NamedTuple):
    """One view's."""

    came_s: float = float("-inf")
    """When its last report came."""
    late_s: tuple[float, ...] = ()
    """How late the last ones were. Of those that came at once, after a cut say, the least."""
    is_told: bool = False
    """That it is slow."""


class State(NamedTuple):
    """What is known of each view's link."""

    period_s: float
    links: tuple[Link, ...] = (Link(), Link())
    news: tuple[str, ...] = ()
    """What was told, a line each."""


def init(period_s: float, cameras: int = 2) -> State:
    """Nothing was heard of so many views."""
    return State(period_s, (Link(),) * cameras)


def heard(state: State, viewer: ViewerNumber, now_s: float, late_s: float) -> State:
    """A report came now, so long after its picture was taken."""
    link = state.links[viewer - 1]
    late = (*link.late_s, late_s)
    if now_s - link.came_s < state.period_s / 2 and link.late_s:
        late = (*link.late_s[:-1], min(link.late_s[-1], late_s))
    return _with(state, viewer, link._replace(came_s=now_s, late_s=late[-LOOKS_AT:]))


def lag_s(state: State) -> float:
    """How long the slowest view's reports are to be waited for beyond what others are."""
    slowest = max((min(link.late_s) for link in state.links if link.late_s), default=0.0)
    return min(LONGEST_S, max(0.0, slowest))


def told(state: State, since_s: float) -> tuple[State, list[str]]:
    """What is to be said of slow links, once each time that one becomes so.

    Args:
        state: As it is.
        since_s: Seconds since the run began.
    """
    lines: list[str] = []
    for viewer, link in enumerate(state.links, start=1):
        if len(link.late_s) < LOOKS_AT:
            continue
        slow_s, bound_s = min(link.late_s), SLOW_PERIODS * state.period_s
        if slow_s > bound_s and not link.is_told:
            waits = "bodies wait for it" if slow_s <= LONGEST_S else "bodies go without it"
            lines.append(
                f"{since_s:.1f} s: view {viewer} is heard {slow_s:.2f} s late (its link is slow, "
                f"or its clock was set); {waits}"
            )
        is_told = slow_s > (bound_s / 2 if link.is_told else bound_s)
        state = _with(state, viewer, link._replace(is_told=is_told))
    return state._replace(news=(*state.news, *lines)), lines


def _with(state: State, viewer: ViewerNumber, link: Link) -> State:
    return state._replace(links=with_item(state.links, viewer - 1, link))
