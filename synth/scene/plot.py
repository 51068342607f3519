"""A scene so far: everybody's script, and whether they keep clear of each other."""

from itertools import combinations
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.motion.moves import Move
from synth.scene.floor import Ground
from synth.scene.script import Floor, Gesture, Script, Turn, Walk, length_m, places

APART_M: Final = 0.8
"""Smallest distance of two people who stand."""
PASSING_M: Final = 0.66
"""Smallest distance of the pelvises of two people who pass: shoulders and swinging arms."""
SPEED_M_S: Final = (0.85, 1.2)
"""Range of the mean speed of a walk."""
OFF_M: Final = 0.25
"""Largest distance of a way from the places where a person is in all pictures."""
LOOKED_S: Final = 0.1
"""Time between two comparisons of places."""
TRIES: Final = 25
"""Number of random choices before a beat is given up."""

SPOT_TRIES: Final = 300
"""Number of random choices of places for everybody."""


class Clash(Exception):
    """No way was found on which people keep clear of each other."""


class Contact(NamedTuple):
    """Two people who touch each other."""

    name: str
    people: tuple[int, int]
    from_s: float
    to_s: float


class Plot(NamedTuple):
    """What has been laid down until `now_s`."""

    scripts: tuple[Script, ...]
    """By person."""
    now_s: float
    out: frozenset[int] = frozenset()
    """People who are not in the room."""
    contacts: tuple[Contact, ...] = ()

    @property
    def there(self) -> list[int]:
        """People in the room."""
        return [who for who in range(len(self.scripts)) if who not in self.out]


def walked(plot: Plot, who: int, walk: Walk) -> Plot:
    """The plot with one more walk."""
    script = plot.scripts[who]
    return _with(plot, who, script._replace(walks=(*script.walks, walk)))


def turned_to(plot: Plot, who: int, facing_deg: float) -> Plot:
    """The plot in which a person turns now."""
    script = plot.scripts[who]
    return _with(plot, who, script._replace(turns=(*script.turns, Turn(plot.now_s, facing_deg))))


def gestured(plot: Plot, who: int, name: str, move: Move, lasts_s: float) -> Plot:
    """The plot with a gesture from now on."""
    script = plot.scripts[who]
    gesture = Gesture(name, plot.now_s, plot.now_s + lasts_s, move)
    return _with(plot, who, script._replace(gestures=(*script.gestures, gesture)))


def later(plot: Plot, lasts_s: float) -> Plot:
    """The plot after some time."""
    return plot._replace(now_s=plot.now_s + lasts_s)


def walk_through(from_s: float, points_m: Floor, rng: np.random.Generator) -> Walk:
    """A walk along some points at a random speed."""
    lasts_s = max(0.9, length_m(points_m) / rng.uniform(*SPEED_M_S))
    return Walk(from_s, from_s + lasts_s, points_m)


def spots(
    plot: Plot, who: list[int], allowed_m: Floor, apart_m: float, rng: np.random.Generator
) -> dict[int, Floor]:
    """Random places for some people, apart from each other and from all others in the room.

    Raises:
        Clash: When none were found.
    """
    fixed = [plot.scripts[other].end_m for other in plot.there if other not in who]
    for _ in range(SPOT_TRIES):
        tried = allowed_m[rng.integers(len(allowed_m), size=len(who))]
        every = np.array([*tried, *fixed])
        gaps = np.linalg.norm(every[:, None] - every, axis=2)
        if (gaps + 9.0 * np.eye(len(every)) >= apart_m).all():
            return dict(zip(who, tried, strict=True))
    raise Clash("no free places")


def refuse_clashes(before: Plot, after: Plot) -> None:
    """Raise where two people come too close between two plots and do not touch on purpose.

    Raises:
        Clash: Then.
    """
    time_s = np.arange(before.now_s, after.now_s + LOOKED_S, LOOKED_S)
    ways = {who: places(after.scripts[who], time_s) for who in before.there}
    for one, other in combinations(ways, 2):
        gaps_m: Vector = np.linalg.norm(ways[one] - ways[other], axis=1)
        if (gaps_m[~touching(after, (one, other), time_s)] < PASSING_M).any():
            raise Clash("too close")


def touching(plot: Plot, people: tuple[int, int], time_s: Vector) -> NDArray[np.bool_]:
    """Whether two people touch each other on purpose at each time, (n,)."""
    found = np.zeros(len(time_s), np.bool_)
    for contact in plot.contacts:
        if set(contact.people) == set(people):
            found |= (time_s >= contact.from_s) & (time_s <= contact.to_s)
    return found


def refuse_astray(ground: Ground, points_m: Floor) -> None:
    """Raise where points leave the places that all cameras see.

    Raises:
        Clash: Then.
    """
    off_m = np.linalg.norm(points_m[:, None] - ground.places_m, axis=2).min(axis=1)
    if (off_m > OFF_M).any():
        raise Clash("out of sight")


def _with(plot: Plot, who: int, script: Script) -> Plot:
    return plot._replace(scripts=(*plot.scripts[:who], script, *plot.scripts[who + 1 :]))
