"""An instant of several people: each has a life of their own, and a number of their own."""

from collections.abc import Sequence

from common.bus.control_messages import Command
from common.bus.instant import Instant
from integrator import commands, merge, merge_state
from integrator.diagnostics import Present
from integrator.live_rig import rig_change
from integrator.measuring.known_body import Measured
from integrator.people import hidden_person, one_of_all
from integrator.people.lived_instant import Merged, ended, lived, of_one
from integrator.people.recognition import State, recognised, seen_of
from integrator.person import Waiting
from integrator.single.sight import Annotations


def step(
    state: State, instant: Instant, annotations: Annotations = Annotations()
) -> tuple[State, Merged]:
    """One instant: the views' observations become people, and each person a body.

    Args:
        state: From `State(merge_state.init(...))` or the step before.
        instant: The viewers' reports.
        annotations: The user's inputs, where one person is followed.
    """
    if state.room.settings.people == 1:
        return one_of_all.step(state, instant, annotations)
    now_s = instant.newest.captured_s
    people = [() if view is None else view.people for view in instant.views]
    state, owned = recognised(state, instant, now_s)
    own = [of_one(instant, indices) for indices in owned]
    merged = [
        hidden_person.lived(life, each, instant, now_s)
        if state.room.alone and max(indices) < 0
        else lived(life, each, seen_of(people, indices), now_s)
        for life, each, indices in zip(state.lives, own, owned, strict=True)
    ]
    state = state._replace(lives=ended([life for life, _, _ in merged], now_s))
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
    bodies, of_each = tuple(each[1] for each in shown), tuple(each[3] for each in shown)
    room = _agreed(first[0].state, [life.state for life, *_ in shown])
    return state._replace(room=room), Merged(bodies, first[2], first[3], of_each)


def present(state: State, merged: Merged) -> list[Present]:
    """The people of an instant, for what is noticed of them.

    Args:
        state: After it.
        merged: What it gave.
    """
    lives = {life.number: life.state for life in state.lives}
    each = zip(merged.bodies, merged.of_each or (merged.of_first,), strict=True)
    return [
        Present(
            body.person,
            own.detections,
            isinstance(lives.get(body.person, state.room).person.body, Measured),
        )
        for body, own in each
    ]


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


def _agreed(room: merge_state.State, states: Sequence[merge_state.State]) -> merge_state.State:
    """The room with the agreement of the person who agrees best with its rig: a wrong rig
    contradicts everybody, a mistake about who is who in a view one of them."""
    believed = {n: told.believed for n, each in enumerate(states) if (told := each.agreement.told)}
    if not believed:
        return room
    return room._replace(agreement=states[max(believed, key=believed.__getitem__)].agreement)


def _without_people(state: State, instant: Instant) -> tuple[State, Merged]:
    """An instant in which no person is known."""
    empty = of_one(instant, (-1,) * len(instant.views))
    room, body, guide = merge.step(state.room._replace(person=Waiting()), empty)
    return state._replace(room=room), Merged((body,), guide, empty)
