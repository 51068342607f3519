"""An instant of a run that follows one person: the first of everyone who is known."""

from collections.abc import Sequence

import msgspec

from common.body.observation import Observation
from common.bus.instant import Instant
from integrator import merge, merge_state
from integrator.measuring.known_body import Measured
from integrator.people.known_life import NO_TRACK, Life, after
from integrator.people.lived_instant import KEPT_S, Merged, ended, lived, of_one
from integrator.people.recognition import State, born, recognised, seen_of
from integrator.people.sight_gaps import People
from integrator.rig import same_person
from integrator.single.sight import Annotations

Lives = tuple[Life, ...]
"""By number, the followed one first."""


def step(
    state: State, instant: Instant, annotations: Annotations = Annotations()
) -> tuple[State, Merged]:
    """The followed person's body. They are never another: where the views show others alone, they
    are lost, until a view shows them again.

    Args:
        state: From `State(merge_state.init(...))` or the step before.
        instant: The viewers' reports.
        annotations: The user's inputs.
    """
    people = [() if view is None else view.people for view in instant.views]
    if not state.lives or _is_alone(state, people) or not _tells_apart(state.room):
        return _of_whoever(state, instant, people, annotations)
    now_s = instant.newest.captured_s
    first = state.lives[0]._replace(state=state.room)
    state, owned = recognised(state._replace(lives=(first, *state.lives[1:])), instant, now_s)
    number = min(life.number for life in state.lives)
    merged = []
    for life, indices in zip(state.lives, owned, strict=True):
        own, inputs = of_one(instant, indices), Annotations()
        if life.number == number:
            inputs = annotations
        merged.append((*lived(life, own, seen_of(people, indices), now_s, inputs), own))
    merged.sort(key=lambda each: each[0].number)
    life, body, guide, own = merged[0]
    lives = _with_performer(tuple(each[0] for each in merged), now_s)
    state = state._replace(room=lives[0].state, lives=lives)
    status = body.status if any(people) else "empty"
    body = msgspec.structs.replace(body, person=0, status=status)
    return _kept(state, now_s), Merged((body,), guide, own)


def _with_performer(lives: Lives, now_s: float) -> Lives:
    """The people, the followed one first: where they have been out of sight for KEPT_S, who was
    measured in the opening posture is followed. That is a wish to be: the same person in other
    clothes cannot be told from another."""
    first, others = lives[0], lives[1:]
    if first.unseen_s(now_s) <= KEPT_S:
        return lives
    performer = next((each for each in others if _performed(each, now_s)), None)
    if performer is None:
        return lives
    rest = tuple(each for each in others if each is not performer)
    return (performer._replace(number=first.number), *rest)


def _performed(life: Life, now_s: float) -> bool:
    """Whether a person in sight was measured in the opening posture."""
    return life.seen_s == now_s and isinstance(life.state.person.body, Measured)


def _kept(state: State, now_s: float) -> State:
    """The state without others who are gone; who was followed and ever believed stays."""
    first, others = state.lives[:1], state.lives[1:]
    if not any(life.was_believed for life in first):
        first = ended(first, now_s)
    lives = first + ended(others, now_s)
    room = lives[0].state if lives and not first else state.room
    return state._replace(lives=lives, room=room)


def _tells_apart(room: merge_state.State) -> bool:
    """Whether places tell people apart: an assumed rig of several views does not."""
    return room.rig is not None and (room.alone or room.scale_source != "assumed")


def _is_alone(state: State, people: People) -> bool:
    """Whether no other person is known, and no view shows a person other than before."""
    if len(state.lives) > 1 or state.coming:
        return False
    (life,) = state.lives
    return all(
        len(each) < 2 and all(one.track == track for one in each)
        for each, track in zip(people, life.tracks, strict=True)
    )


def _of_whoever(
    state: State, instant: Instant, people: People, annotations: Annotations
) -> tuple[State, Merged]:
    """The body of the person whom the views show: the only one, or who is followed from now on."""
    now_s = instant.newest.captured_s
    room, body, guide = merge.step(state.room, instant, annotations)
    indices = room.same.chosen or tuple(0 if each else -1 for each in people)
    seen = seen_of(people, indices)
    lives, fresh = state.lives, state.fresh
    if any(seen):
        if not lives:
            lives, fresh = (born(room, fresh, _tracks(seen), now_s),), fresh + 1
        lives = (after(lives[0]._replace(state=room), body, seen, now_s),)
    state = (
        _kept(state._replace(room=room, lives=lives, fresh=fresh), now_s)
        if lives
        else state._replace(room=room)
    )
    return state, Merged((body,), guide, same_person.of_person(instant, room.same.chosen))


def _tracks(seen: Sequence[Observation | None]) -> tuple[int, ...]:
    return tuple(NO_TRACK if one is None else one.track for one in seen)
