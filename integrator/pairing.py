"""Two viewers' reports, matched by when they were taken."""

from typing import Final, NamedTuple, Protocol, TypeVar

from common.bus.messages import Report, ViewerNumber
from common.bus.pair import Pair

QUEUE: Final = 128
"""How many reports of one viewer wait for the other: eight seconds at 15 frames a second, after
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
    """What waits for its partner, and what was lost."""

    period_s: float
    waiting: tuple[tuple[Report, ...], tuple[Report, ...]]
    """Reports of viewer 1 and viewer 2, oldest first."""
    over: tuple[bool, bool]
    """Viewers that say nothing more: nobody waits for them."""
    away: tuple[bool, bool] = (False, False)
    """Viewers that were waited for in vain, or are known to be gone: nobody waits for them, until
    they report again."""
    next_s: tuple[float, float] = (NEVER_S, NEVER_S)
    """Before this no further frame of viewer n is taken, as it said itself."""
    passed_s: tuple[float, float] = (NEVER_S, NEVER_S)
    """A report of viewer n must be younger than this: its instant has gone out already."""
    dropped: int = 0
    """Reports that a full queue pushed out."""
    late: int = 0
    """Reports that came after their instant had gone out, or after their viewer had ended."""


def init(period_s: float, viewers: tuple[ViewerNumber, ...] = (1, 2)) -> State:
    """Nothing waits.

    Args:
        period_s: Time between frames; half of it is how far a pair may lie apart.
        viewers: Those that report in this run; a single viewer's reports pass through.
    """
    return State(period_s, ((), ()), (1 not in viewers, 2 not in viewers))


def step(state: State, report: Report) -> tuple[State, list[Pair]]:
    """Take a report in; give out what is complete now, in the order of time.

    A report goes out with the other viewer's of the same instant (`are_together`),
    or alone as soon as the other viewer has said something later, or that it takes no picture
    before. So what goes out follows from what each viewer said, not from how the two were heard
    interleaved, as long as no queue overflows and nothing was called overdue.
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
    apart_s = later.captured_s - earlier.captured_s
    is_nearest = earlier.next_s is None or abs(earlier.next_s - later.captured_s) >= apart_s
    return apart_s <= period_s / 2 and is_nearest


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


def away(state: State, viewer: ViewerNumber) -> tuple[State, list[Pair]]:
    """A viewer is known to be gone: nothing waits for it until it reports again."""
    return _settled(state._replace(away=with_item(state.away, viewer - 1, True)))


def end(state: State, viewer: ViewerNumber) -> tuple[State, list[Pair]]:
    """A viewer has said its last: what waits for it goes out, and nothing waits for it again."""
    return _settled(state._replace(over=with_item(state.over, viewer - 1, True)))


def overdue(state: State, now_s: float, wait_s: float) -> tuple[State, list[Pair]]:
    """Let reports out alone that have waited for their partner long enough (live runs only).

    Its viewer is away then, and what waits for it goes out, too.

    Args:
        state: What waits.
        now_s: The room's clock.
        wait_s: How old a report may grow by that clock.
    """
    for own in (0, 1):
        if state.waiting[own] and state.waiting[own][0].clock_s + wait_s < now_s:
            return away(state, 2 if own == 0 else 1)
    return state, []


def _settled(state: State) -> tuple[State, list[Pair]]:
    """Give out every pair that nothing to come can change."""
    pairs: list[Pair] = []
    while True:
        state = _without_late(state)
        first, second = state.waiting
        if first and second:
            own = 0 if first[0].captured_s < second[0].captured_s else 1
            earlier, later = (first[0], second[0]) if own == 0 else (second[0], first[0])
            if are_together(earlier, later, state.period_s):
                state, pair = _together(state)
            else:
                state, pair = _alone(state, own)
        elif (first or second) and not _awaited(state, 1 if first else 0):
            state, pair = _alone(state, 0 if first else 1)
        else:
            return state, pairs
        pairs.append(pair)


def _awaited(state: State, other: int) -> bool:
    """Whether a viewer that has said nothing may still have a partner for the oldest report."""
    if state.over[other] or state.away[other]:
        return False
    oldest = state.waiting[1 - other][0]
    return state.next_s[other] - oldest.captured_s <= state.period_s / 2


def _without_late(state: State) -> State:
    """Reports whose instant has gone out already are counted, and are no more."""
    kept = [
        tuple(report for report in queue if report.captured_s > passed_s)
        for queue, passed_s in zip(state.waiting, state.passed_s, strict=True)
    ]
    late = sum(len(queue) for queue in state.waiting) - len(kept[0]) - len(kept[1])
    return state._replace(waiting=(kept[0], kept[1]), late=state.late + late)


def _together(state: State) -> tuple[State, Pair]:
    (first, *others_1), (second, *others_2) = state.waiting
    newest_s = max(first.captured_s, second.captured_s)
    state = state._replace(
        waiting=(tuple(others_1), tuple(others_2)), passed_s=(newest_s, newest_s)
    )
    return state, Pair(first, second)


def _alone(state: State, own: int) -> tuple[State, Pair]:
    """The oldest report of one viewer; its partner, should it still come, will be late. One that
    waits is no partner of it."""
    report, *others = state.waiting[own]
    waits = bool(state.waiting[1 - own])
    partner_s = report.captured_s + (0.0 if waits else state.period_s / 2)
    state = state._replace(
        waiting=with_item(state.waiting, own, tuple(others)),
        passed_s=with_item((partner_s, partner_s), own, report.captured_s),
    )
    return state, Pair(report, None) if own == 0 else Pair(None, report)


def with_item(both: tuple[Item, Item], place: int, item: Item) -> tuple[Item, Item]:
    """What both views have, with that of one of them, 0 or 1, replaced."""
    return (item, both[1]) if place == 0 else (both[0], item)
