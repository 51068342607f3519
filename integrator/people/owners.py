"""Whom each view's observations show: known people first, then groups of one new person each."""

from collections.abc import Sequence
from itertools import combinations, permutations, product, starmap
from operator import itemgetter
from typing import Final, NamedTuple

import numpy as np

from calibration.gate.sight_clash import MEETS_M
from common.body.clothes import TAKEN, colour_distance, exchange_gain
from common.body.observation import Observation
from common.rig.camera import Rig
from integrator.belief import NOBODY
from integrator.people.known_life import PELVIS, Life, Places
from integrator.people.observation_cost import HIDDEN, NEAR_M, UNLIKE, cost_of, hidden_shares
from integrator.people.sight_gaps import (
    Apart,
    Gap,
    People,
    Place,
    sight_gap_m,
)

AMONG: Final = 0.5
"""Share of the next best gap below which that of two observations is clearly one person's."""
WRONG_M: Final = 0.02
"""By how much another's gap must be smaller for two observations not to be of one person."""
GAP_COST: Final = 0.5
"""Cost of two observations of one person whose sight lines are MEETS_M apart; it grows with the
square."""
FARTHEST: Final = 2.0
"""In that unit, the distance from which on it grows no more."""
ROUNDS: Final = 3
"""How often views are asked whom they show, each knowing what the others said."""
SURE_AFTER: Final = 5
"""Number of instants after which such a mean contradicts what was taken for one person."""


class Group(NamedTuple):
    """Observations of one person who is not known."""

    indices: tuple[int, ...]
    """By view, of the observation; -1: none."""
    is_clear: bool
    """All views show them, and no other observation could be theirs."""


class Owned(NamedTuple):
    """The observations of an instant, by person."""

    known: tuple[tuple[int, ...], ...]
    """For each known person, by view, the index of the observation; -1: none."""
    groups: tuple[Group, ...]
    """Observations that show no known person, those of one person together."""


def owned(
    rig: Rig, people: People, lives: Sequence[Life], now_s: float, gaps: Sequence[Gap]
) -> Owned:
    """The observations by person.

    Args:
        rig: V cameras without distortion.
        people: Of each view, without distortion.
        lives: The known people.
        now_s: Capture time.
        gaps: With this instant.
    """
    costs = []
    for view, camera in enumerate(rig.cameras):
        own = np.array(
            [[cost_of(camera, view, life, each, now_s) for each in people[view]] for life in lives]
        ).reshape(len(lives), len(people[view]))
        hidden = hidden_shares(camera, [life.expected_m(now_s) for life in lives])
        costs.append(own + HIDDEN * hidden[:, None])
    known = _agreed(people, costs, Apart(people, gaps))
    _attach(people, known, gaps)
    taken = {(view, own[view]) for own in known for view in range(len(people))}
    unknown = [
        (view, index)
        for view, each in enumerate(people)
        for index, one in enumerate(each)
        if (view, index) not in taken and _is_person(one)
    ]
    groups = _grouped(people, unknown, gaps)
    return Owned(tuple(map(tuple, known)), groups)


def _agreed(people: People, costs: Sequence[np.ndarray], apart: Apart) -> list[list[int]]:
    """For each person, by view, the index of their observation, so that each view's are cheap and
    the sight lines of all views meet; -1: none.

    A view that shows one of two people may take them for the other: alone it does not know. So
    views are asked in turn, each with what the others say, first by each of them once.

    Args:
        people: Of each view.
        costs: Of each view, (people, observations).
        apart: Gaps.
    """
    views = range(len(people))
    tried = [
        _asked_in_turn(people, costs, apart, [*views[first:], *views[:first]]) for first in views
    ]
    return min(tried, key=itemgetter(0))[1]


def _asked_in_turn(
    people: People, costs: Sequence[np.ndarray], apart: Apart, order: Sequence[int]
) -> tuple[float, list[list[int]]]:
    """Whom the views show where they are asked in an order, after the sum of the costs; an
    observation of no person costs 1."""
    known = [[-1] * len(people) for _ in costs[0]]
    for _ in range(ROUNDS):
        before, total = [list(own) for own in known], 0.0
        for view in order:
            own_costs = costs[view] + _clashes(people, known, apart, view)
            pairs = dict(_assigned(own_costs))
            total += len(people[view]) + sum(own_costs[pair] - 1.0 for pair in pairs.items())
            for row, own in enumerate(known):
                own[view] = pairs.get(row, -1)
        if known == before:
            break
    return total, known


def _clashes(people: People, known: Sequence[Sequence[int]], apart: Apart, view: int) -> np.ndarray:
    """Cost of a view's observations (people, observations) beside those of other views."""
    indices = range(len(people[view]))
    costs = [[_clash(apart, own, (view, index)) for index in indices] for own in known]
    return np.array(costs).reshape(len(known), len(indices))


def _clash(apart: Apart, own: Sequence[int], one: Place) -> float:
    """Cost of an observation beside those of other views that are held to be of one person."""
    gaps = [apart.gap(each, one) for each in _places(own) if each[0] != one[0]]
    far = [0.5 * (gap.mean_m + gap.last_m) / MEETS_M for gap in gaps if gap is not None]
    return GAP_COST * min(max(far, default=0.0), FARTHEST) ** 2


def doubles(
    rig: Rig, people: People, lives: Sequence[Life], known: Sequence[Sequence[int]], now_s: float
) -> list[tuple[int, int]]:
    """Pairs of known people, by their places, who may be one: each is shown by views that do not
    show the other, their sight lines meet, they are expected in one place, and their clothes are
    alike. Sight lines alone also meet where those of two people cross.

    Args:
        rig: V cameras without distortion.
        people: Of each view, without distortion.
        lives: The known people.
        known: Their observations.
        now_s: Capture time.
    """
    found, expected_m = [], [life.expected_m(now_s) for life in lives]
    for (i, one), (j, other) in combinations(enumerate(known), 2):
        own, theirs = (
            {view for view, index in enumerate(each) if index >= 0} for each in (one, other)
        )
        if not own or not theirs or own & theirs or _are_apart(expected_m[i], expected_m[j]):
            continue
        apart_m = max(
            sight_gap_m(rig, people, (a, one[a]), (b, other[b])) for a, b in product(own, theirs)
        )
        unlike = colour_distance(lives[i].colours_in(0), lives[j].colours_in(0))
        if apart_m < MEETS_M and unlike < UNLIKE:
            found.append((i, j))
    return found


def _are_apart(one_m: Places | None, other_m: Places | None) -> bool:
    """Whether two people are expected in different places."""
    if one_m is None or other_m is None:
        return False
    return float(np.linalg.norm(one_m[PELVIS] - other_m[PELVIS])) >= NEAR_M


def exchanged(
    people: People, lives: Sequence[Life], known: Sequence[Sequence[int]]
) -> list[tuple[int, int]]:
    """Pairs of known people, by their places, who wear each other's clothes: they were taken for
    each other where they crossed."""
    found = []
    for (i, one), (j, other) in combinations(enumerate(known), 2):
        better = [
            _gain((lives[i], lives[j]), (people[view][a], people[view][b]), view)
            for view, (a, b) in enumerate(zip(one, other, strict=True))
            if a >= 0 and b >= 0
        ]
        if better and float(np.mean(better)) > TAKEN:
            found.append((i, j))
    return found


def _gain(lives: tuple[Life, Life], seen: tuple[Observation, Observation], view: int) -> float:
    mine, theirs = (life.colours_in(view) for life in lives)
    return exchange_gain(mine, theirs, *(each.colours for each in seen))


def _assigned(costs: np.ndarray) -> list[tuple[int, int]]:
    """The cheapest rows and columns of a matrix, each at most once, none of 1 or more."""
    from scipy.optimize import linear_sum_assignment  # a quarter of a second: for several alone

    rows, columns = linear_sum_assignment(np.minimum(costs, 1.0))
    pairs = zip(rows.tolist(), columns.tolist(), strict=True)
    return [(row, column) for row, column in pairs if costs[row, column] < 1.0]


def _attach(people: People, known: list[list[int]], gaps: Sequence[Gap]) -> None:
    """Give those whom some views show the observations of other views whose sight lines meet
    theirs."""
    apart_m = Apart(people, gaps)

    def joined_m(own: Sequence[int], free: Place) -> float:
        return max(_unrivalled_m(people, apart_m, each, free) for each in _places(own))

    for view in range(len(people)):
        free = sorted(set(range(len(people[view]))) - {own[view] for own in known})
        lacking = [own for own in known if own[view] < 0 and max(own) >= 0]
        costs = [[joined_m(own, (view, index)) for index in free] for own in lacking]
        for row, column in _assigned(np.array(costs).reshape(len(lacking), len(free)) / MEETS_M):
            lacking[row][view] = free[column]


def _unrivalled_m(people: People, apart_m: Apart, own: Place, free: Place) -> float:
    """Gap between a person's observation and a free one of another view; infinite where another of
    the person's view is clearly nearer to the free one: it shows another, who has just come."""
    own_m = apart_m(own, free)
    rivals = (apart_m((own[0], index), free) for index in range(len(people[own[0]])))
    return np.inf if min(rivals) < min(AMONG * own_m, own_m - WRONG_M) else own_m


def _places(own: Sequence[int]) -> list[Place]:
    return [(view, index) for view, index in enumerate(own) if index >= 0]


def mistaken(
    people: People, known: Sequence[Sequence[int]], gaps: Sequence[Gap]
) -> list[tuple[int, int]]:
    """People, by their places, of whom a view shows another: that one's observation is much
    farther from the person's than another of the same view has been in the last instants."""
    apart_m, found = Apart(people, gaps), []
    for place, own in enumerate(known):
        for one, other in permutations(_places(own), 2):
            gap, view = apart_m.gap(one, other), other[0]
            if gap is None or gap.instants < SURE_AFTER:
                continue
            rivals = (apart_m.gap(one, (view, index)) for index in range(len(people[view])))
            sure = [each.mean_m for each in rivals if each and each.instants >= SURE_AFTER]
            if min(sure) < min(AMONG * gap.mean_m, gap.mean_m - WRONG_M):
                found.append((place, view))
                break
    return found


def _is_person(seen: Observation) -> bool:
    shown = seen.landmarks
    return shown is not None and float(np.mean(shown.confidence)) >= NOBODY


def _grouped(people: People, unknown: Sequence[Place], gaps: Sequence[Gap]) -> tuple[Group, ...]:
    """Unknown observations of one person together: those whose sight lines all meet, view after
    view so that the gaps' sum is least. The nearest two first would leave others for each other."""
    of_two = Apart(people, gaps)

    def apart_m(one: Place, other: Place) -> float:
        return np.inf if one[0] == other[0] else of_two(one, other)

    groups: list[tuple[Place, ...]] = []
    for view in range(len(people)):
        own = [one for one in unknown if one[0] == view]
        costs = [[max(of_two(each, one) for each in group) for one in own] for group in groups]
        pairs = dict(_assigned(np.array(costs).reshape(len(groups), len(own)) / MEETS_M))
        groups = [
            (*group, own[pairs[row]]) if row in pairs else group for row, group in enumerate(groups)
        ]
        groups += [(one,) for column, one in enumerate(own) if column not in pairs.values()]

    def is_clear(group: tuple[Place, ...]) -> bool:
        own_m = max(starmap(apart_m, combinations(group, 2)), default=0.0)
        others = set(unknown) - set(group)
        next_m = min(starmap(apart_m, product(group, others)), default=np.inf)
        return len(group) == len(people) and own_m <= AMONG * next_m

    views = range(len(people))
    return tuple(
        Group(tuple(dict(each).get(view, -1) for view in views), is_clear(each)) for each in groups
    )
