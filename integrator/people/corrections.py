"""What was wrong about who is who, put right: another's observation, exchanged numbers, one person
taken for two."""

from collections.abc import Sequence
from typing import Final, NamedTuple

from integrator import merge_state
from integrator.measuring.known_body import Measured
from integrator.people.known_life import NO_TRACK, Life
from integrator.person import Waiting

ONE_S: Final = 0.5
"""How long two people, each shown by views that do not show the other, must be in one place to be
one."""
LONG_S: Final = 2.0
"""Age from which a person is surely not another, seconds."""
SWAPPED_S: Final = 0.4
"""How long two people must wear each other's clothes to be exchanged back, seconds."""

Indices = tuple[int, ...]
"""A person's observations: by view the index, or -1."""


class Double(NamedTuple):
    """Two people in one place, each shown by views that do not show the other."""

    numbers: tuple[int, int]
    since_s: float


class Swap(NamedTuple):
    """Two people who wear each other's clothes."""

    numbers: tuple[int, int]
    since_s: float


def alone_in(room: merge_state.State) -> merge_state.State:
    """The integrator's state before it knows anything of a person."""
    start = merge_state.Start(
        room.alone, room.scale_source, times=room.times, uprights=room.uprights
    )
    fresh = merge_state.init(room.rig, room.period_s, room.settings, room.method, start)
    return room._replace(
        person=fresh.person,
        facing=fresh.facing,
        same=fresh.same,
        agreement=fresh.agreement,
        pair=fresh.pair,
    )


def loosened(
    lives: Sequence[Life],
    known: Sequence[Indices],
    mistaken: Sequence[tuple[int, int]],
    room: merge_state.State,
) -> tuple[list[Life], list[Indices]]:
    """The people and the observations in which no person has one of another: who had is seen by the
    other views alone from now on, and their pose begins anew, with the body if it was measured.

    Args:
        lives: The people.
        known: Their observations.
        mistaken: Of whom, by place, which view shows another.
        room: The integrator's state of any person in it.
    """
    freed, indices = list(lives), list(known)
    for place, view in mistaken:
        life = freed[place]
        tracks = tuple(NO_TRACK if n == view else old for n, old in enumerate(life.tracks))
        freed[place] = life._replace(state=_anew(life, room), tracks=tracks, joints_m=None)
        indices[place] = tuple(-1 if n == view else own for n, own in enumerate(indices[place]))
    return freed, indices


def _anew(life: Life, room: merge_state.State) -> merge_state.State:
    """The state of a person whose pose begins anew; a body measured in the opening posture is
    theirs."""
    fresh, body = alone_in(room), life.state.person.body
    return fresh._replace(person=Waiting(body)) if isinstance(body, Measured) else fresh


def themselves(
    lives: Sequence[Life],
    pairs: Sequence[tuple[int, int]],
    swaps: Sequence[Swap],
    now_s: float,
) -> tuple[list[Life], tuple[Swap, ...]]:
    """The people with the numbers, and the clothes, of those who have worn each other's for
    SWAPPED_S; and who wear each other's since when.

    Args:
        lives: The people.
        pairs: Who, by place, wear each other's clothes now.
        swaps: Who did in the instant before.
        now_s: Capture time.
    """
    own, after = list(lives), []
    before = {one.numbers: one.since_s for one in swaps}
    for i, j in pairs:
        one, other = own[i], own[j]
        numbers = one.number, other.number
        since_s = before.get(numbers, now_s)
        if now_s - since_s < SWAPPED_S:
            after.append(Swap(numbers, since_s))
            continue
        own[i] = one._replace(number=other.number, colours=other.colours, coloured=other.coloured)
        own[j] = other._replace(number=one.number, colours=one.colours, coloured=one.coloured)
    return own, tuple(after)


def of_one(
    lives: Sequence[Life],
    known: Sequence[Indices],
    pairs: Sequence[tuple[int, int]],
    doubles: Sequence[Double],
    now_s: float,
) -> tuple[list[Life], list[Indices], tuple[Double, ...]]:
    """The people and the observations where two have been shown as one for ONE_S: the older has
    them. The younger was the older all along, or is hidden by them if known for LONG_S.

    Args:
        lives: The people.
        known: Their observations.
        pairs: Who, by place, are shown as one now.
        doubles: Who were in the instant before.
        now_s: Capture time.
    """
    before = {one.numbers: one.since_s for one in doubles}
    indices, after, gone = list(known), list[Double](), set[int]()
    for older, younger in pairs:
        numbers = lives[older].number, lives[younger].number
        since_s = before.get(numbers, now_s)
        after.append(Double(numbers, since_s))
        if now_s - since_s >= ONE_S and indices[younger] == known[younger]:
            indices[older] = tuple(map(max, indices[older], known[younger]))
            indices[younger] = (-1,) * len(known[younger])
            if now_s - lives[younger].born_s < LONG_S:
                gone.add(younger)
    left = [place for place in range(len(lives)) if place not in gone]
    return [lives[place] for place in left], [indices[place] for place in left], tuple(after)
