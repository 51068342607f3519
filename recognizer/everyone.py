"""The postures of several people: each has a stream of their own."""

from collections.abc import Callable, Iterator
from typing import Final, Generic, NamedTuple, TypeVar

from common.bus.messages import Body, Posture

MOST: Final = 8
"""Number of people whose streams are kept: of more, those whose body came last."""

One = TypeVar("One")


class Stream(NamedTuple, Generic[One]):
    """One person's stream."""

    person: int
    state: One
    last: Posture


class State(NamedTuple, Generic[One]):
    """The streams, the latest last."""

    fresh: One
    """The state of a stream before its first body."""
    streams: tuple[Stream[One], ...] = ()


def init(fresh: One) -> State[One]:
    """No person yet.

    Args:
        fresh: The recogniser's state before any body.
    """
    return State(fresh)


def step(
    state: State[One], body: Body, of_one: Callable[[One, Body], tuple[One, Posture]]
) -> tuple[State[One], Posture]:
    """Process one body, of any person.

    Args:
        state: The streams.
        body: The body.
        of_one: The step of one stream.
    """
    own = next((each.state for each in state.streams if each.person == body.person), state.fresh)
    after, posture = of_one(own, body)
    others = tuple(each for each in state.streams if each.person != body.person)
    kept = (*others, Stream(body.person, after, posture))[-MOST:]
    return state._replace(streams=kept), posture


def finished(
    state: State[One], of_one: Callable[[One, Posture], Posture | None]
) -> Iterator[Posture]:
    """The messages at the end of a run: the performances that it cuts off.

    Args:
        state: The streams.
        of_one: The end of one stream.
    """
    for each in state.streams:
        last = of_one(each.state, each.last)
        if last is not None:
            yield last
