"""An instant of several people: each has a life of their own, and a number of their own."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import msgspec

from common.body.observation import Observation
from common.bus.control_messages import Command
from common.bus.instant import Instant
from common.bus.messages import Body, Guide
from integrator import commands, merge, merge_state
from integrator.live_rig import rig_change
from integrator.people import corrections, owners
from integrator.people.corrections import Double, Swap, alone_in
from integrator.people.known_life import NO_TRACK, Life, after
from integrator.people.owners import Group
from integrator.people.sight_gaps import Gap, with_instant
from integrator.person import Waiting
from integrator.rig import same_person
from integrator.rig.undistortion import undistorted_instant, undistorted_rig
from integrator.single.sight import Annotations

MOST: Final = 6
"""Upper bound of the number of people."""
FIRST: Final = 1
"""The first person's number; 0 is that of a run that follows one person."""
BORN_S: Final = 1.0 / 3.0
"""How long two views must show a new person before they get a number, seconds."""
ALONE_BORN_S: Final = 1.0
"""The same where one view of several shows them: another may see them soon."""
CONFIRMED_S: Final = 1.0
"""Time within which a new person must be believed once."""
KEPT_S: Final = 5.0
"""How long a person out of sight keeps their number, seconds."""


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


class Merged(NamedTuple):
    """What an instant gives."""

    bodies: tuple[Body, ...]
    """By number; one of number 0 where one person is followed, or no person is known."""
    guide: Guide
    """About the first of them in sight."""
    of_first: Instant
    """The views, with that person alone where several are followed."""


def step(
    state: State, instant: Instant, annotations: Annotations = Annotations()
) -> tuple[State, Merged]:
    """One instant: the views' observations become people, and each person a body.

    Args:
        state: From `State(merge_state.init(...))` or the step before.
        instant: The viewers' reports.
        annotations: The user's inputs, where one person in one view is followed.
    """
    if state.room.settings.people == 1:
        room, body, guide = merge.step(state.room, instant, annotations)
        chosen = same_person.of_person(instant, room.same.chosen)
        return state._replace(room=room), Merged((body,), guide, chosen)
    now_s = instant.newest.captured_s
    people = [() if view is None else view.people for view in instant.views]
    state, owned = _recognised(state, instant, now_s)
    own = [_of(instant, indices) for indices in owned]
    merged = [
        _lived(life, each, _seen(people, indices), now_s)
        for life, each, indices in zip(state.lives, own, owned, strict=True)
    ]
    state = _ended(state._replace(lives=tuple(life for life, _, _ in merged)), now_s)
    there = {life.number for life in state.lives}
    shown = [
        (life, body, guide, each)
        for (life, body, guide), each in zip(merged, own, strict=True)
        if life.number in there
    ]
    if not shown:
        return _without_people(state, instant)
    shown.sort(key=lambda each: each[0].number)
    first = next((each for each in shown if each[0].seen_s == now_s), shown[0])
    bodies = tuple(body for _, body, _, _ in shown)
    return state._replace(room=first[0].state), Merged(bodies, first[2], first[3])


def with_room(state: State, room: merge_state.State) -> State:
    """The state with the rig that the room has now: a new one is everybody's."""
    if room.calibration == state.room.calibration or room.rig is None:
        return state._replace(room=room)
    lives = tuple(
        life._replace(state=rig_change.with_rig(life.state, room.rig), joints_m=None)
        for life in state.lives
    )
    return state._replace(room=room, lives=lives, coming=(), gaps=(), doubles=())


def commanded(state: State, command: Command) -> State:
    """The state after a command to the integrator, which is for everyone."""
    lives = tuple(
        life._replace(state=commands.step(life.state, Annotations(), command)[0])
        for life in state.lives
    )
    return state._replace(lives=lives)


def _recognised(
    state: State, instant: Instant, now_s: float
) -> tuple[State, list[tuple[int, ...]]]:
    """The state with those who are new, and each person's observation by view."""
    rig = state.room.rig
    if rig is None:
        raise ValueError("several people need a rig")
    shown = undistorted_instant(rig, instant)
    people = [() if view is None else view.people for view in shown.views]
    plain = undistorted_rig(rig)
    gaps = with_instant(state.gaps, plain, people)
    found = owners.owned(plain, people, state.lives, now_s, gaps)
    pairs = owners.doubles(plain, people, state.lives, found.known)
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
        if shown_s < _wait_s(group, state) or len(lives) >= MOST:
            coming.append(Coming(tracks, since_s))
            continue
        lives.append(_born(state.room, fresh, tracks, now_s))
        indices.append(group.indices)
        fresh += 1
    state = state._replace(lives=tuple(lives), coming=tuple(coming), gaps=gaps, fresh=fresh)
    return state, indices


def _wait_s(group: Group, state: State) -> float:
    """How long a new person must be shown: not at all where no person is known and it is clear."""
    if group.is_clear and not state.lives:
        return 0.0
    shown = sum(index >= 0 for index in group.indices)
    return BORN_S if shown > 1 or len(group.indices) == 1 else ALONE_BORN_S


def _born(room: merge_state.State, number: int, tracks: tuple[int, ...], now_s: float) -> Life:
    """A new person, with nothing of another."""
    never = (-math.inf,) * len(tracks)
    return Life(number, alone_in(room), now_s, now_s, tracks, never)


def _lived(
    life: Life, own: Instant, seen: Sequence[Observation | None], now_s: float
) -> tuple[Life, Body, Guide]:
    """A person after an instant, with their body and guide."""
    state, body, guide = merge.step(life.state, own)
    chosen = state.same.chosen or (0,) * len(seen)
    kept = tuple(one if index >= 0 else None for one, index in zip(seen, chosen, strict=True))
    life = after(life._replace(state=state), body, kept, now_s)
    status = "lost" if body.status == "empty" else body.status
    return life, msgspec.structs.replace(body, person=life.number, status=status), guide


def _ended(state: State, now_s: float) -> State:
    """The state without those who are gone, or were never believed."""
    lives = tuple(
        life
        for life in state.lives
        if life.unseen_s(now_s) <= KEPT_S
        and (life.joints_m is not None or now_s - life.born_s <= CONFIRMED_S)
    )
    return state._replace(lives=lives)


def _without_people(state: State, instant: Instant) -> tuple[State, Merged]:
    """An instant in which no person is known."""
    empty = _of(instant, (-1,) * len(instant.views))
    room, body, guide = merge.step(state.room._replace(person=Waiting()), empty)
    return state._replace(room=room), Merged((body,), guide, empty)


def _of(instant: Instant, indices: Sequence[int]) -> Instant:
    """The views with one person alone, by view the index of the observation; -1: none."""
    views = list(instant.views)
    for n, (view, index) in enumerate(zip(instant.views, indices, strict=True)):
        if view is not None:
            people = view.people[index : index + 1] if index >= 0 else ()
            views[n] = msgspec.structs.replace(view, people=people)
    return Instant(tuple(views))


def _seen(
    people: Sequence[Sequence[Observation]], indices: Sequence[int]
) -> tuple[Observation | None, ...]:
    return tuple(
        each[index] if index >= 0 else None for each, index in zip(people, indices, strict=True)
    )


def _tracks(people: Sequence[Sequence[Observation]], indices: Sequence[int]) -> tuple[int, ...]:
    return tuple(NO_TRACK if one is None else one.track for one in _seen(people, indices))
