"""A known person's instant: their observations become a body."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import msgspec

from common.body.observation import Observation
from common.bus.instant import Instant
from common.bus.messages import Body, Guide
from integrator import merge
from integrator.people.known_life import Life, after
from integrator.single.sight import Annotations

CONFIRMED_S: Final = 1.0
"""Time within which a new person must be believed once."""
KEPT_S: Final = 5.0
"""How long a person out of sight keeps their number, seconds."""


class Merged(NamedTuple):
    """What an instant gives."""

    bodies: tuple[Body, ...]
    """By number; one of number 0 where one person is followed, or no person is known."""
    guide: Guide
    """About the first of them in sight."""
    of_first: Instant
    """The views, with that person alone where several are followed."""
    of_each: tuple[Instant, ...] = ()
    """The same for each of the bodies of several people."""


def lived(
    life: Life,
    own: Instant,
    seen: Sequence[Observation | None],
    now_s: float,
    annotations: Annotations = Annotations(),
) -> tuple[Life, Body, Guide]:
    """A person after an instant, with their body and guide.

    Args:
        life: Before it.
        own: The views with this person alone.
        seen: By view, their observation; None: none.
        now_s: Capture time.
        annotations: The user's inputs.
    """
    state, body, guide = merge.step(life.state, own, annotations)
    chosen = state.same.chosen or (0,) * len(seen)
    kept = tuple(one if index >= 0 else None for one, index in zip(seen, chosen, strict=True))
    life = after(life._replace(state=state), body, kept, now_s)
    status = "lost" if body.status == "empty" else body.status
    return life, msgspec.structs.replace(body, person=life.number, status=status), guide


def ended(lives: Sequence[Life], now_s: float) -> tuple[Life, ...]:
    """The people without those who are gone, or were never believed."""
    return tuple(
        life
        for life in lives
        if life.unseen_s(now_s) <= KEPT_S
        and (life.was_believed or now_s - life.born_s <= CONFIRMED_S)
    )


def of_one(instant: Instant, indices: Sequence[int]) -> Instant:
    """The views with one person alone, by view the index of the observation; -1: none."""
    views = list(instant.views)
    for n, (view, index) in enumerate(zip(instant.views, indices, strict=True)):
        if view is not None:
            people = view.people[index : index + 1] if index >= 0 else ()
            views[n] = msgspec.structs.replace(view, people=people)
    return Instant(tuple(views))
