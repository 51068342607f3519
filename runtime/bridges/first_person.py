"""The first person of each instant, for protocols that know one person alone."""

import math
from collections.abc import Iterable, Iterator

from common.bus.messages import Body


def of_first(bodies: Iterable[Body]) -> Iterator[Body]:
    """Of each instant's bodies that of the lowest number in sight; none where all are lost.

    Number 0, of a run that follows one person or of an instant without a person, is always taken.

    Args:
        bodies: Those of an instant come one after another, by number.
    """
    taken_s = -math.inf
    for body in bodies:
        is_in_sight = body.status not in ("empty", "lost")
        if body.person == 0 or (is_in_sight and body.captured_s != taken_s):
            taken_s = body.captured_s
            yield body
