"""The two views that see a person best, for methods that take two silhouettes."""

from itertools import combinations
from typing import Final, NamedTuple

import numpy as np
from msgspec import structs

from common.body.body import Vector
from common.body.observation import Observation
from common.bus.instant import Seen, TwoSeen
from common.raster.silhouette_report import centroid_px, unpack
from common.rig.camera import Camera, Rig, ray

Places = tuple[int, int]
"""Numbers of two of the rig's cameras, the lower first."""

CUT: Final = 0.5
"""Weight of a view that shows a part of the person, relative to one that shows all of them."""
KEPT: Final = 1.5
"""Weight of the previous pair, relative to another: the networks' memory belongs to it."""


def best_pair(before: Places | None, rig: Rig, seen: Seen) -> Places:
    """The pair of an instant.

    Two views stay the pair while both see the whole person. Otherwise it is chosen among the views
    that see the person, whole ones first, by lines of sight nearest to a right angle.

    Args:
        before: The pair of the instant before; None at the first.
        rig: V cameras without distortion; a rig's only camera is both.
        seen: The person in each view, without distortion; None where it has none.
    """
    shown = {n: person for n, person in enumerate(seen) if person is not None}
    whole = {n for n, person in shown.items() if not person.cut}
    if len(rig.cameras) <= 2:
        return 0, len(rig.cameras) - 1
    if not shown or whole.issuperset(before or (-1,)):
        return before or (0, 1)
    if len(shown) == 1:
        (own,) = shown
        other = next(n for n in (*(before or ()), 0, 1) if n != own)
        return min(own, other), max(own, other)
    lines = {n: _sight_line(person, rig.cameras[n]) for n, person in shown.items()}
    worth = {
        pair: _sine(lines[pair[0]], lines[pair[1]])
        * CUT ** len(set(pair) - whole)
        * (KEPT if pair == before else 1.0)
        for pair in combinations(shown, 2)
    }
    return max(worth, key=lambda pair: worth[pair])


def _sight_line(person: Observation, camera: Camera) -> Vector:
    """Towards the middle of a silhouette, (3,) unit length, world."""
    return ray(camera, centroid_px(unpack(person)))


def _sine(one: Vector, other: Vector) -> float:
    return float(np.linalg.norm(np.cross(one, other)))


class Two(NamedTuple):
    """A pair of views, for methods that take two."""

    rig: Rig
    """Two cameras; the only one of a rig twice."""
    seen: TwoSeen

    @property
    def first_seen(self) -> tuple[int, Observation]:
        """Place and person of the first view that shows one, as one at least does."""
        return next((n, person) for n, person in enumerate(self.seen) if person is not None)


def two_of(rig: Rig, seen: Seen, pair: Places) -> Two:
    """The views of a pair; an only camera's view is paired with None."""
    one, other = pair
    cameras = tuple(rig.cameras[n] for n in pair)
    own = rig if cameras == rig.cameras else structs.replace(rig, cameras=cameras)
    return Two(own, (seen[one], None if one == other else seen[other]))
