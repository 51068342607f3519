"""Delay of each view's reports: its link's constant part, not single hiccups."""

from typing import Final, NamedTuple

from common.bus.messages import ViewerNumber, place_in_rig
from integrator.pairing import with_item

LOOKS_AT: Final = 30
"""Number of moments at which reports came; their smallest delay is the link's."""
LONGEST_S: Final = 0.5
"""Longest wait for a view, seconds: later bodies are of little use live."""
SLOW_PERIODS: Final = 2.0
"""Delay of a link, frame periods, from which on it is reported."""


class Link(NamedTuple):
    """One view's link."""

    came_s: float = float("-inf")
    """Time of its last report."""
    late_s: tuple[float, ...] = ()
    """Delays of the last reports; of reports that came together, as after an interruption, the
    smallest."""
    is_reported: bool = False
    """True: it was reported as slow."""


class State(NamedTuple):
    """The state of every view's link."""

    period_s: float
    links: tuple[Link, ...] = (Link(), Link())
    news: tuple[str, ...] = ()
    """The reports so far, one line each."""


def init(period_s: float, cameras: int = 2) -> State:
    """The state of that many views before any report."""
    return State(period_s, (Link(),) * cameras)


def heard(state: State, viewer: ViewerNumber, now_s: float, late_s: float) -> State:
    """Process a report that came now, with its delay since capture."""
    link = state.links[place_in_rig(viewer)]
    late = (*link.late_s, late_s)
    if now_s - link.came_s < state.period_s / 2 and link.late_s:
        late = (*link.late_s[:-1], min(link.late_s[-1], late_s))
    return _with(state, viewer, link._replace(came_s=now_s, late_s=late[-LOOKS_AT:]))


def lag_s(state: State) -> float:
    """How much longer the slowest view's reports are waited for than others."""
    slowest = max((min(link.late_s) for link in state.links if link.late_s), default=0.0)
    return min(LONGEST_S, max(0.0, slowest))


def told(state: State, since_s: float) -> tuple[State, list[str]]:
    """Lines about slow links, one each time that a link becomes slow.

    Args:
        state: The present state.
        since_s: Time since the run began.
    """
    lines: list[str] = []
    for viewer, link in enumerate(state.links, start=1):
        if len(link.late_s) < LOOKS_AT:
            continue
        slow_s, bound_s = min(link.late_s), SLOW_PERIODS * state.period_s
        if slow_s > bound_s and not link.is_reported:
            waits = "bodies wait for it" if slow_s <= LONGEST_S else "bodies go without it"
            lines.append(
                f"{since_s:.1f} s: view {viewer} is heard {slow_s:.2f} s late (its link is slow, "
                f"or its clock was set); {waits}"
            )
        is_reported = slow_s > (bound_s / 2 if link.is_reported else bound_s)
        state = _with(state, viewer, link._replace(is_reported=is_reported))
    return state._replace(news=(*state.news, *lines)), lines


def _with(state: State, viewer: ViewerNumber, link: Link) -> State:
    return state._replace(links=with_item(state.links, place_in_rig(viewer), link))
