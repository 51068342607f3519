"""The summary's facts about cameras that were moved during a run."""

from collections.abc import Iterable
from functools import reduce
from typing import NamedTuple

from common.bus.messages import Body
from common.npz_file import Facts


class Move(NamedTuple):
    """A camera was moved."""

    camera: int
    at_s: float
    confirmed_s: float | None = None
    """Time at which the person confirmed its new place; None where that did not happen."""


Moves = tuple[Move, ...]


def step(moves: Moves, body: Body) -> Moves:
    """The facts after one more body."""
    waiting = {move.camera for move in moves if move.confirmed_s is None}
    if not (waiting or body.moved):
        return moves
    confirmed = waiting - {*body.moved}
    told = (
        move._replace(confirmed_s=body.captured_s)
        if move.camera in confirmed and move.confirmed_s is None
        else move
        for move in moves
    )
    return (*told, *(Move(n, body.captured_s) for n in body.moved if n not in waiting))


def facts_of_moves(moves: Moves) -> Facts:
    """Which cameras were moved and when, and when the person confirmed their new place.

    `moved_cameras` is missing where none was.
    """
    return {"moved_cameras": [move._asdict() for move in moves]} if moves else {}


def moved_facts(bodies: Iterable[Body]) -> Facts:
    """The same for all bodies of a run."""
    start: Moves = ()
    return facts_of_moves(reduce(step, bodies, start))
