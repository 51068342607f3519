"""The viewers' reports, matched by capture time."""

from typing import Final, NamedTuple, Protocol, TypeVar

from common.bus.instant import Instant, instant_of
from common.bus.messages import View, ViewerNumber, place_in_rig

QUEUE: Final = 128
"""Largest number of one viewer's reports that wait for others: eight seconds at 15 Hz; a process
that was stopped for longer has to catch up."""

NEVER_S: Final = float("-inf")


Item = TypeVar("Item")


class Taken(Protocol):
    """A report of a frame."""

    @property
    def captured_s(self) -> float:
        """Capture time."""

    @property
    def next_s(self) -> float | None:
        """Earliest capture time of its camera's next frame; None: unknown."""


class State(NamedTuple):
    """Reports waiting for others of their instant, by view in the rig's order, and counts of
    losses."""

    period_s: float
    waiting: tuple[tuple[View, ...], ...]
    """Reports of each viewer, oldest first."""
    over: tuple[bool, ...]
    """Viewers that have ended: they are not waited for."""
    away: tuple[bool, ...]
    """Viewers that are absent: they are not waited for until they report again."""
    next_s: tuple[float, ...]
    """Earliest capture time of each viewer's next frame, as it reported itself."""
    passed_s: tuple[float, ...]
    """Smallest capture time of a viewer's report that still counts: earlier instants have gone
    out."""
    dropped: int = 0
    """Number of reports dropped from a full queue."""
    late: int = 0
    """Number of reports that came after their instant had gone out, or after their viewer had
    ended."""


class _Due(NamedTuple):
    """The next instant to go out."""

    reports: tuple[View, ...]
    """Its candidate reports, oldest first."""
    middle_s: float
    """The reports of the instant: each was captured within half a period of it."""
    awaited: tuple[ViewerNumber, ...]
    """Viewers that may still report a frame of it."""


def init(period_s: float, viewers: tuple[ViewerNumber, ...] = (1, 2), cameras: int = 2) -> State:
    """The initial state.

    Args:
        period_s: Time between frames; views may lie half of it from their instant.
        viewers: Viewers of this run; a single viewer's reports pass through.
        cameras: Number of the rig's cameras: an instant has as many views.
    """
    return State(
        period_s,
        waiting=((),) * cameras,
        over=tuple(number not in viewers for number in range(1, cameras + 1)),
        away=(False,) * cameras,
        next_s=(NEVER_S,) * cameras,
        passed_s=(NEVER_S,) * cameras,
    )


def step(state: State, report: View) -> tuple[State, list[Instant]]:
    """Accept a report; return the instants complete now, in the order of time.

    An instant goes out when each view either has its frame of it, or can have none any more: it
    reported a later one, or that it captures none before. So the output depends on each viewer's
    reports, not on the order of their arrival, as long as no queue overflows and nothing was called
    overdue.
    """
    own = place_in_rig(report.viewer)
    if state.over[own]:
        return state._replace(late=state.late + 1), []
    queue = (*state.waiting[own], report)
    state = state._replace(
        waiting=with_item(state.waiting, own, queue[-QUEUE:]),
        dropped=state.dropped + max(0, len(queue) - QUEUE),
    )
    if report.captured_s > state.passed_s[own] - state.period_s:
        state = state._replace(away=with_item(state.away, own, False))
    if report.next_s is not None:
        state = state._replace(next_s=with_item(state.next_s, own, report.next_s))
    return _settled(state)


def are_together(earlier: Taken, later: Taken, period_s: float) -> bool:
    """Whether two views' frames are of one instant: half a period apart at most, and the earlier
    one's camera is not known to take another frame nearer to the later."""
    return later.captured_s - earlier.captured_s <= period_s / 2 and _is_nearest(earlier, later)


def _is_nearest(earlier: Taken, later: Taken) -> bool:
    """Whether a camera is not known to take another frame that is nearer to another's."""
    apart_s = later.captured_s - earlier.captured_s
    return earlier.next_s is None or abs(earlier.next_s - later.captured_s) >= apart_s


def begin(state: State, viewer: ViewerNumber) -> State:
    """A viewer that had ended, or was absent, is present again: it is waited for."""
    own = place_in_rig(viewer)
    return state._replace(
        over=with_item(state.over, own, False),
        away=with_item(state.away, own, False),
        next_s=with_item(state.next_s, own, NEVER_S),
    )


def awaited(state: State, viewer: ViewerNumber) -> State:
    """An absent viewer is waited for again, as waits are longer now."""
    return state._replace(away=with_item(state.away, place_in_rig(viewer), False))


def away(state: State, viewer: ViewerNumber) -> tuple[State, list[Instant]]:
    """A viewer is absent: it is not waited for until it reports again."""
    return _settled(state._replace(away=with_item(state.away, place_in_rig(viewer), True)))


def end(state: State, viewer: ViewerNumber) -> tuple[State, list[Instant]]:
    """A viewer has ended: what waits for it goes out, and it is not waited for again."""
    return _settled(state._replace(over=with_item(state.over, place_in_rig(viewer), True)))


def overdue(state: State, now_s: float, wait_s: float) -> tuple[State, list[Instant]]:
    """Release reports that have waited long enough (live runs only).

    Viewers still missing then count as absent, and everything else that waits for them goes out
    too.

    Args:
        state: The waiting reports.
        now_s: The room's clock.
        wait_s: Longest age of a waiting report, by that clock.
    """
    due = _due(state)
    oldest_s = min((queue[0].clock_s for queue in state.waiting if queue), default=now_s)
    if due is None or oldest_s + wait_s >= now_s:
        return state, []
    for viewer in due.awaited:
        state = state._replace(away=with_item(state.away, place_in_rig(viewer), True))
    return _settled(state)


def _settled(state: State) -> tuple[State, list[Instant]]:
    """Output every instant that no future report can change."""
    instants: list[Instant] = []
    while True:
        state = _without_late(state)
        due = _due(state)
        if due is None or due.awaited:
            return state, instants
        state, instant = _taken(state, due)
        instants.append(instant)


def _due(state: State) -> _Due | None:
    """The instant of the oldest report; None where nothing waits.

    Its time is that of the last of the views' oldest reports within half a period of the oldest of
    all. It contains all reports captured up to half a period later, until one is reached for which
    a camera already in the instant takes another frame nearer to it.
    """
    waiting = sorted((q[0] for q in state.waiting if q), key=lambda report: report.captured_s)
    if not waiting:
        return None
    half_s = state.period_s / 2
    reports, middle_s = waiting[:1], waiting[0].captured_s
    for report in waiting[1:]:
        nearest = all(_is_nearest(one, report) for one in reports)
        if not nearest or report.captured_s - middle_s > half_s:
            break
        reports.append(report)
        if report.captured_s - reports[0].captured_s <= half_s:
            middle_s = report.captured_s
    awaited = tuple(n for n in range(1, len(state.waiting) + 1) if _is_awaited(state, n, middle_s))
    return _Due(tuple(reports), middle_s, awaited)


def _is_awaited(state: State, viewer: ViewerNumber, middle_s: float) -> bool:
    """Whether a viewer without a report may still have a frame of an instant."""
    own = place_in_rig(viewer)
    if state.waiting[own] or state.over[own] or state.away[own]:
        return False
    return state.next_s[own] - middle_s <= state.period_s / 2


def _without_late(state: State) -> State:
    """Reports whose instant has gone out are counted and dropped."""
    kept = tuple(
        tuple(report for report in queue if report.captured_s > passed_s)
        for queue, passed_s in zip(state.waiting, state.passed_s, strict=True)
    )
    late = sum(map(len, state.waiting)) - sum(map(len, kept))
    return state._replace(waiting=kept, late=state.late + late)


def _taken(state: State, due: _Due) -> tuple[State, Instant]:
    """An instant goes out: a report captured before its newest one now counts as late, and so
    does a frame of the instant from a viewer without a report."""
    views: dict[int, View] = {report.viewer: report for report in due.reports}
    newest_s = due.reports[-1].captured_s
    waiting, passed_s = list(state.waiting), [newest_s] * len(state.waiting)
    for own, queue in enumerate(state.waiting):
        if own + 1 in views:
            waiting[own] = queue[1:]
        elif not queue:
            passed_s[own] = due.middle_s + state.period_s / 2
    state = state._replace(waiting=tuple(waiting), passed_s=tuple(passed_s))
    return state, instant_of(views, len(waiting))


def with_item(each: tuple[Item, ...], place: int, item: Item) -> tuple[Item, ...]:
    """Each view's value, with that of one of them replaced."""
    return (*each[:place], item, *each[place + 1 :])
