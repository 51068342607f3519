"""Who is who at an instant: known people get their observations, new ones a life."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from common.body.observation import Observation
from common.bus.instant import Instant
from common.bus.messages import MOST_PEOPLE
from integrator import merge_state
from integrator.people import corrections, owners
from integrator.people.corrections import Double, Swap, alone_in
from integrator.people.known_life import NO_TRACK, Life
from integrator.people.owners import Group
from integrator.people.sight_gaps import Gap, People, with_instant
from integrator.rig.undistortion import undistorted_instant, undistorted_rig

MOST: Final = MOST_PEOPLE + 1
"""Upper bound of the number of people who are known: as many as a scene has, and one who is out of
sight and may come back."""
FIRST: Final = 1
"""The first person's number; 0 is that of a run that follows one person."""
BORN_S: Final = 1.0 / 3.0
"""How long views must show a new person before they get a number, seconds."""


SOON_S: Final = 2.0 / 15.0
"""The same where the only view shows them surely: mean confidence of the landmarks above SURELY,
which two people seen as one hardly have."""
SURELY: Final = 0.7


class Coming(NamedTuple):
    """Observations that show no known person."""

    tracks: tuple[int, ...]
    """By view, the viewer's number; NO_TRACK: it does not show them."""
    since_s: float


class State(NamedTuple):
    """The integrator's state for any number of people."""

    room: merge_state.State
    """Of the person with the lowest number in sight, or without a person: rig, cameras, times. Of a
    run that follows one person, all there is."""
    lives: tuple[Life, ...] = ()
    coming: tuple[Coming, ...] = ()
    gaps: tuple[Gap, ...] = ()
    doubles: tuple[Double, ...] = ()
    swaps: tuple[Swap, ...] = ()
    fresh: int = FIRST
    """The next number that no person has had."""


def recognised(state: State, instant: Instant, now_s: float) -> tuple[State, list[tuple[int, ...]]]:
    """The state with those who are new, and each person's observation by view: its index, or -1.

    Args:
        state: Of the instant before.
        instant: The viewers' reports.
        now_s: Capture time.

    Raises:
        ValueError: When there is no rig.
    """
    rig = state.room.rig
    if rig is None:
        raise ValueError("several people need a rig")
    shown = undistorted_instant(rig, instant)
    people = [() if view is None else view.people for view in shown.views]
    plain = undistorted_rig(rig)
    gaps = with_instant(state.gaps, plain, people)
    found = owners.owned(plain, people, state.lives, now_s, gaps)
    pairs = owners.doubles(plain, people, state.lives, found.known, now_s)
    mistaken = owners.mistaken(people, found.known, gaps)
    lives, known = corrections.loosened(state.lives, found.known, mistaken, state.room)
    swapped = owners.exchanged(people, lives, known)
    lives, swaps = corrections.themselves(lives, swapped, state.swaps, now_s)
    lives, indices, doubles = corrections.of_one(lives, known, pairs, state.doubles, now_s)
    state = state._replace(lives=tuple(lives), swaps=swaps, doubles=doubles)
    lives, coming, fresh = list(state.lives), [], state.fresh
    for group in found.groups:
        tracks = _tracks(people, group.indices)
        since_s = next((one.since_s for one in state.coming if one.tracks == tracks), now_s)
        shown_s = now_s - since_s + 0.5 * state.room.period_s
        if shown_s < _wait_s(group, people, state) or len(lives) >= MOST:
            coming.append(Coming(tracks, since_s))
            continue
        lives.append(born(state.room, fresh, tracks, now_s))
        indices.append(group.indices)
        fresh += 1
    state = state._replace(lives=tuple(lives), coming=tuple(coming), gaps=gaps, fresh=fresh)
    return state, indices


def _wait_s(group: Group, people: People, state: State) -> float:
    """How long a new person must be shown: not at all where no person is known and it is clear, or
    there is no other view that could tell."""
    alone = state.room.alone
    if (group.is_clear or alone) and not state.lives:
        return 0.0
    seen = [one for one in seen_of(people, group.indices) if one is not None]
    is_sure = all(
        one.landmarks is not None and float(np.mean(one.landmarks.confidence)) > SURELY
        for one in seen
    )
    return SOON_S if alone and is_sure else BORN_S


def born(room: merge_state.State, number: int, tracks: tuple[int, ...], now_s: float) -> Life:
    """A new person, with nothing of another.

    Args:
        room: The integrator's state of any person in it.
        number: Never another person's.
        tracks: By view, the viewer's number.
        now_s: Capture time.
    """
    never = (-math.inf,) * len(tracks)
    return Life(number, alone_in(room), now_s, now_s, tracks, never)


def seen_of(
    people: Sequence[Sequence[Observation]], indices: Sequence[int]
) -> tuple[Observation | None, ...]:
    """Observations by view, by their indices; None for -1.

    Args:
        people: Of each view.
        indices: One for each view.
    """
    return tuple(
        each[index] if index >= 0 else None for each, index in zip(people, indices, strict=True)
    )


def _tracks(people: Sequence[Sequence[Observation]], indices: Sequence[int]) -> tuple[int, ...]:
    return tuple(NO_TRACK if one is None else one.track for one in seen_of(people, indices))
