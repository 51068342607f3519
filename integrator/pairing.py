"""The viewers' reports, matched by when they were taken."""

from typing import Final, NamedTuple, Protocol, TypeVar

from common.bus.instant import Instant, instant_of
from common.bus.messages import View, ViewerNumber

QUEUE: Final = 128
"""How many reports of one viewer wait for the others: eight seconds at 15 frames a second, after
which who was stopped has all that was said meanwhile to catch up with."""

NEVER_S: Final = float("-inf")


Item = TypeVar("Item")


class Taken(Protocol):
    """What was made of a frame."""

    @property
    def captured_s(self) -> float:
        """When it was taken."""

    @property
    def next_s(self) -> float | None:
        """When its camera takes the next, at the earliest; None: that is not known."""


class State(NamedTuple):
    """What waits for the others of its instant, by view in the rig's order, and what was lost."""

    period_s: float
    waiting: tuple[tuple[View, ...], ...]
    """Reports of each viewer, oldest first."""
    over: tuple[bool, ...]
    """Viewers that say nothing more: nobody waits for them."""
    away: tuple[bool, ...]
    """Viewers that were waited for in vain, or are known to be gone: nobody waits for them, until
    they report again."""
    next_s: tuple[float, ...]
    """Before this no further frame of a viewer is taken, as it said itself."""
    passed_s: tuple[float, ...]
    """A report of a viewer must be younger than this: its instant has gone out already."""
    dropped: int = 0
    """Reports that a full queue pushed out."""
    late: int = 0
    """Reports that came after their instant had gone out, or after their viewer had ended."""


class _Due(NamedTuple):
    """What goes out next."""

    reports: tuple[View, ...]
    """Of one instant, oldest first."""
    middle_s: float
    """The instant: each of them was taken within half a period of it."""
    awaited: tuple[ViewerNumber, ...]
    """Viewers that may still say something of it."""


def init(period_s: float, viewers: tuple[ViewerNumber, ...] = (1, 2), cameras: int = 2) -> State:
    """Nothing waits.

    Args:
        period_s: Time between frames; half of it is how far views may lie from their instant.
        viewers: Those that report in this run; a single viewer's reports pass through.
        cameras: Of the rig: so many views an instant has.
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
    """Take a report in; give out what is complete now, in the order of time.

    An instant goes out when each view either has its frame of it there, or can have none any more:
    it has said something later, or that it takes no picture before. So what goes out follows from
    what each viewer said, not from how they were heard interleaved, as long as no queue overflows
    and nothing was called overdue.
    """
    own = report.viewer - 1
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
    one's camera, which may be the faster, is not known to take another nearer to the later."""
    return later.captured_s - earlier.captured_s <= period_s / 2 and _is_nearest(earlier, later)


def _is_nearest(earlier: Taken, later: Taken) -> bool:
    """Whether a camera is not known to take another frame that is nearer to another's."""
    apart_s = later.captured_s - earlier.captured_s
    return earlier.next_s is None or abs(earlier.next_s - later.captured_s) >= apart_s


def begin(state: State, viewer: ViewerNumber) -> State:
    """A viewer that had ended, or was away, is there again: it is waited for."""
    own = viewer - 1
    return state._replace(
        over=with_item(state.over, own, False),
        away=with_item(state.away, own, False),
        next_s=with_item(state.next_s, own, NEVER_S),
    )


def awaited(state: State, viewer: ViewerNumber) -> State:
    """A viewer that was waited for in vain is worth waiting for, as one now waits longer."""
    return state._replace(away=with_item(state.away, viewer - 1, False))


def away(state: State, viewer: ViewerNumber) -> tuple[State, list[Instant]]:
    """A viewer is known to be gone: nothing waits for it until it reports again."""
    return _settled(state._replace(away=with_item(state.away, viewer - 1, True)))


def end(state: State, viewer: ViewerNumber) -> tuple[State, list[Instant]]:
    """A viewer has said its last: what waits for it goes out, and nothing waits for it again."""
    return _settled(state._replace(over=with_item(state.over, viewer - 1, True)))


def overdue(state: State, now_s: float, wait_s: float) -> tuple[State, list[Instant]]:
    """Let reports out that have waited for others long enough (live runs only).

    Those that are still awaited are away then, and what else waits for them goes out, too.

    Args:
        state: What waits.
        now_s: The room's clock.
        wait_s: How old a report may grow by that clock.
    """
    due = _due(state)
    oldest_s = min((queue[0].clock_s for queue in state.waiting if queue), default=now_s)
    if due is None or oldest_s + wait_s >= now_s:
        return state, []
    for viewer in due.awaited:
        state = state._replace(away=with_item(state.away, viewer - 1, True))
    return _settled(state)


def _settled(state: State) -> tuple[State, list[Instant]]:
    """Give out every instant that nothing to come can change."""
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

    It is the last of the views' oldest reports that was taken within half a period of the oldest
    of all. All those are of it that were taken up to half a period later, until one is reached to
    which a camera that is in takes another frame nearer.
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
    """Whether a viewer that has said nothing may still have a frame of an instant."""
    own = viewer - 1
    if state.waiting[own] or state.over[own] or state.away[own]:
        return False
    return state.next_s[own] - middle_s <= state.period_s / 2


def _without_late(state: State) -> State:
    """Reports whose instant has gone out already are counted, and are no more."""
    kept = tuple(
        tuple(report for report in queue if report.captured_s > passed_s)
        for queue, passed_s in zip(state.waiting, state.passed_s, strict=True)
    )
    late = sum(map(len, state.waiting)) - sum(map(len, kept))
    return state._replace(waiting=kept, late=state.late + late)


def _taken(state: State, due: _Due) -> tuple[State, Instant]:
    """An instant goes out: what was taken before its newest report, should it still come, is late,
    and so is a frame of the instant where its viewer has said nothing."""
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
    """What each view has, with that of one of them replaced."""
    return (*each[:place], item, *each[place + 1 :])
