"""One and the same person in all views: a view that follows another person is left out."""

from collections.abc import Sequence
from itertools import combinations
from typing import Final, NamedTuple

import msgspec
import numpy as np

from calibration.gate import sight_clash
from calibration.gate.sight_clash import Clash, Meeting, gap_m, row_of_landmarks
from common.body.body import Vector
from common.body.observation import Observation
from common.bus.instant import Instant
from common.rig.camera import Rig
from integrator.rig import person_choice
from integrator.rig.person_choice import AWAY_COST, Chosen

GONE: Final = 6
"""The view that is kept has lost the person after so many times as many instants as make evidence:
2 s; then the others count again."""


class Pair(NamedTuple):
    """Two views, and what they have shown of one person or of two."""

    views: tuple[int, int]
    clash: Clash = Clash()
    favour: float = 0.0
    """By how much the first view shows the expected person better than the other, and its
    landmarks are surer: the sum over the clashing instants."""
    absent: int = 0
    """Number of instants in a row in which the view that is kept shows no person."""

    @property
    def other_one(self) -> int:
        """The view that is left out where they follow different people."""
        return self.views[self.favour >= 0.0]


class State(NamedTuple):
    """Evidence, and the choice of the last instant."""

    chosen: Chosen = ()
    """Empty before the first instant."""
    pairs: tuple[Pair, ...] = ()
    left_out: tuple[int, ...] = ()
    """For each view, the number of instants in which it followed another person."""
    since_s: float | None = None
    """Time of the first of them."""

    @property
    def is_apart(self) -> bool:
        """Some views follow different people now."""
        return any(pair.clash.is_apart for pair in self.pairs)

    @property
    def met(self) -> int:
        """Number of instants in which two views have shown one person, as far as it counts."""
        return max((pair.clash.met for pair in self.pairs), default=0)


class Expected(NamedTuple):
    """What is known of the person before an instant."""

    place_m: Vector | None
    """(3,) world; None: no person is followed, or they are not believed."""
    lasting: int
    """Number of instants from which on evidence counts."""


def step(state: State, rig: Rig, shown: Instant, expected: Expected) -> State:
    """Process one instant, before anything else reads its views.

    Views whose sight lines clash for long follow different people, unless the rig is wrong. The
    view that shows the expected person is kept, at the start the one with the surer landmarks, as
    long as it shows a person.

    Args:
        state: Of the instant before, by the same rig.
        rig: V cameras without distortion.
        shown: Their views, without distortion.
        expected: The person.
    """
    people = [() if view is None else view.people for view in shown.views]
    costs = [
        person_choice.costs_of(camera, each, expected.place_m)
        for camera, each in zip(rig.cameras, people, strict=True)
    ]
    chosen = person_choice.chosen(rig, people, costs)
    seen = [each[index] if index >= 0 else None for each, index in zip(people, chosen, strict=True)]
    worth = [
        0.0 if person is None else _sure(person) - own[index] / AWAY_COST
        for person, own, index in zip(seen, costs, chosen, strict=True)
    ]
    now_s = shown.newest.captured_s
    pairs = tuple(
        _with_instant(pair, rig, seen, worth, (now_s, expected.lasting))
        for pair in state.pairs or _pairs(len(people))
    )
    out = _left_out(pairs)
    before, since_s = state.left_out or (0,) * len(people), state.since_s
    if any(_is_the_rigs(*each) for each in zip(state.pairs, pairs, strict=bool(state.pairs))):
        before, since_s = (0,) * len(people), None
    return State(
        tuple(-1 if n in out else index for n, index in enumerate(chosen)),
        pairs,
        tuple(count + (n in out) for n, count in enumerate(before)),
        now_s if out and since_s is None else since_s,
    )


def of_person(instant: Instant, chosen: Chosen) -> Instant:
    """The instant with the chosen person as the first of each view's people, and without people
    where a view does not see them."""
    if not any(chosen):
        return instant
    views = list(instant.views)
    for n, (view, index) in enumerate(zip(instant.views, chosen, strict=True)):
        if view is not None and index:
            first = view.people[index : index + 1] if index > 0 else ()
            others = tuple(each for place, each in enumerate(view.people) if place != index)
            views[n] = msgspec.structs.replace(view, people=(*first, *others) if first else ())
    return Instant(tuple(views))


def _is_the_rigs(before: Pair, pair: Pair) -> bool:
    """Whether what was taken for different people turns out to be the rig."""
    return before.clash.is_apart and not pair.clash.is_apart and bool(pair.clash.rows)


def _pairs(views: int) -> tuple[Pair, ...]:
    return tuple(Pair(pair) for pair in combinations(range(views), 2))


def _with_instant(
    pair: Pair,
    rig: Rig,
    seen: Sequence[Observation | None],
    worth: Sequence[float],
    now: tuple[float, int],
) -> Pair:
    """Two views after an instant."""
    one, other = pair.views
    first, second = seen[one], seen[other]
    now_s, lasting = now
    if first is None or second is None:
        kept = one if pair.other_one == other else other
        absent = pair.absent + 1 if pair.clash.is_apart and seen[kept] is None else 0
        over = absent > GONE * lasting
        return Pair(pair.views, Clash(pair.clash.met)) if over else pair._replace(absent=absent)
    if first.landmarks is None or second.landmarks is None:
        return pair
    rows = row_of_landmarks(now_s, first.landmarks), row_of_landmarks(now_s, second.landmarks)
    apart_m = gap_m((rig.cameras[one], rig.cameras[other]), first, second)
    clash = sight_clash.step(pair.clash, Meeting(apart_m, rows), lasting)
    if not clash.against:
        return Pair(pair.views, clash)
    is_new = clash.clashed > pair.clash.clashed and not pair.clash.is_apart
    better = worth[one] - worth[other] if is_new else 0.0
    return Pair(pair.views, clash, pair.favour + better)


def _left_out(pairs: Sequence[Pair]) -> set[int]:
    """The views that follow another person: first those apart from most views, of two alike the
    one that is less in favour."""
    out: set[int] = set()
    while apart := [each for each in pairs if each.clash.is_apart and not out & {*each.views}]:
        times = {
            n: (sum(n in each.views for each in apart), sum(n == each.other_one for each in apart))
            for each in apart
            for n in each.views
        }
        out.add(max(times, key=times.__getitem__))
    return out


def _sure(person: Observation) -> float:
    """Mean confidence of a person's landmarks."""
    return 0.0 if person.landmarks is None else float(np.mean(person.landmarks.confidence))
