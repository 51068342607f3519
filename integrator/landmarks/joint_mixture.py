"""Where a joint most probably is, of what the outlines propose and what each view shows."""

import math
from typing import Any, Final, NamedTuple

import numpy as np

from common.compiled import compiled


class Spread(NamedTuple):
    """How far from the truth one kind of witness is.

    It is right, roughly right, or speaks of something else, which may be anywhere: then it says
    nothing, and does not pull.
    """

    right: float
    """Standard deviation of what is right, by one that is wholly sure ..."""
    unsure: float
    """... and how much it grows to one that is not sure at all."""
    roughly: float
    """Of what is roughly right."""
    often: float
    """How often what is not right is roughly right."""
    far: float
    """So many standard deviations off, what is roughly right is no likelier than anything else."""


PROPOSED: Final = Spread(right=0.014, unsure=0.061, roughly=0.072, often=0.95, far=8)
"""Of joints that outlines propose, metres."""
SHOWN: Final = Spread(right=0.016, unsure=0.014, roughly=0.051, often=0.55, far=2)
"""Of landmarks, statures beside their ray. All were chosen on r01, r04 and made-up people."""
LEAST, MOST = 0.01, 0.98
"""Nobody is believed more or less surely."""
ROUNDS: Final = 4
HELD: Final = 4.0
"""1 / m^2: so tightly a proposed joint is held where nothing else speaks."""
STARTS: Final = 4


class Witnesses(NamedTuple):
    """What is said of one joint."""

    proposed_m: Any
    """(3,)"""
    surety: float
    """How probably the proposed joint is right."""
    centres_m: Any
    """(2, 3) the cameras."""
    directions: Any
    """(2, 3) of its rays."""
    sureties: Any
    """(2,) how probably each landmark is right; 0: there is none."""
    spreads_m: Any
    """(3,) of the proposed joint and of both landmarks, where they are right."""
    roughly_m: float
    """Of the proposed joint, where it is roughly right."""
    stature_m: float


@compiled
def most_probable(told: Any, place_m: Any, precision: Any) -> float:
    """The log probability of the place of one joint where it is highest.

    From where each witness alone would have it, and from where both rays meet, rounds of weighted
    least squares (the EM algorithm of Dempster 1977) climb to the next peak; the highest counts.

    Args:
        told: Witnesses.
        place_m: (3,) gets the place.
        precision: (6,) gets xx, xy, xz, yy, yz, zz of its inverse covariance, 1 / m^2.
    """
    best = -np.inf
    normal, right, here = np.zeros(6), np.zeros(3), np.zeros(3)
    for start in range(STARTS):
        if not _start(told, start, here):
            continue
        for _ in range(ROUNDS):
            _weigh(told, here, normal, right)
            _solve(normal, right, here)
        found = _weigh(told, here, normal, right)
        if found > best:
            best = found
            place_m[:] = here
            precision[:] = normal
    return best


@compiled
def _start(told: Any, start: int, here: Any) -> bool:
    """Where to climb from; whether there is such a place."""
    if start == 0:
        here[:] = told.proposed_m
        return True
    if start < 3:
        view = start - 1
        along = 0.0
        for i in range(3):
            along += (told.proposed_m[i] - told.centres_m[view, i]) * told.directions[view, i]
        for i in range(3):
            here[i] = told.centres_m[view, i] + along * told.directions[view, i]
        return bool(told.sureties[view] > 0.0)
    if told.sureties[0] <= 0.0 or told.sureties[1] <= 0.0:
        return False
    one, two = told.directions[0], told.directions[1]
    cosine = first = second = 0.0
    for i in range(3):
        apart = told.centres_m[0, i] - told.centres_m[1, i]
        cosine += one[i] * two[i]
        first += one[i] * apart
        second += two[i] * apart
    sine_squared = 1.0 - cosine * cosine
    if sine_squared < 1e-6:
        return False
    for i in range(3):
        near = told.centres_m[0, i] + one[i] * (cosine * second - first) / sine_squared
        other = told.centres_m[1, i] + two[i] * (second - cosine * first) / sine_squared
        here[i] = 0.5 * (near + other)
    return True


@compiled
def _weigh(told: Any, here: Any, normal: Any, right: Any) -> float:
    """The log probability of a place, and the normal equations by which it is bettered."""
    square = 0.0
    for i in range(3):
        square += (here[i] - told.proposed_m[i]) ** 2
    total, weight = _likelihood(square, told.spreads_m[0], told.roughly_m, told.surety, PROPOSED, 3)
    weight += HELD
    normal[0] = normal[3] = normal[5] = weight
    normal[1] = normal[2] = normal[4] = 0.0
    for i in range(3):
        right[i] = weight * told.proposed_m[i]
    for view in range(2):
        if told.sureties[view] <= 0.0:
            continue
        centre, along = told.centres_m[view], told.directions[view]
        x, y, z = here[0] - centre[0], here[1] - centre[1], here[2] - centre[2]
        deep = x * along[0] + y * along[1] + z * along[2]
        square = max(0.0, x * x + y * y + z * z - deep * deep)
        roughly = SHOWN.roughly * told.stature_m
        said, weight = _likelihood(
            square, told.spreads_m[1 + view], roughly, told.sureties[view], SHOWN, 2
        )
        total += said
        at = centre[0] * along[0] + centre[1] * along[1] + centre[2] * along[2]
        k = 0
        for i in range(3):
            right[i] += weight * (centre[i] - at * along[i])
            for j in range(i, 3):
                normal[k] += weight * ((1.0 if i == j else 0.0) - along[i] * along[j])
                k += 1
    return total


@compiled
def _likelihood(
    square: float, right: float, roughly: float, surety: float, kind: Any, axes: int
) -> tuple[float, float]:
    """Of one witness who is so far off (squared, m^2): log probability, and weight, 1 / m^2."""
    is_right = surety * math.exp(-square / (2 * right * right)) / right**axes
    rest = (1.0 - surety) * kind.often / roughly**axes
    is_rough = rest * math.exp(-square / (2 * roughly * roughly))
    beyond = (1.0 - surety) * (1.0 - kind.often) / (kind.far * roughly) ** axes
    anywhere = beyond * math.exp(-4.5)
    total = is_right + is_rough + anywhere + 1e-30
    return math.log(total), (is_right / (right * right) + is_rough / (roughly * roughly)) / total


@compiled
def _solve(normal: Any, right: Any, place: Any) -> None:
    """The place of symmetric normal equations (xx, xy, xz, yy, yz, zz)."""
    a, b, c, d, e, f = normal[0], normal[1], normal[2], normal[3], normal[4], normal[5]
    m00, m01, m02 = d * f - e * e, c * e - b * f, b * e - c * d
    m11, m12, m22 = a * f - c * c, b * c - a * e, a * d - b * b
    whole = a * m00 + b * m01 + c * m02
    x, y, z = right[0], right[1], right[2]
    place[0] = (m00 * x + m01 * y + m02 * z) / whole
    place[1] = (m01 * x + m11 * y + m12 * z) / whole
    place[2] = (m02 * x + m12 * y + m22 * z) / whole
