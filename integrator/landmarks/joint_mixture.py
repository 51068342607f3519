"""The most probable place of a joint, from the silhouettes' proposal and each view's landmarks."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Floats, Vector
from common.compiled import compiled


class Spread(NamedTuple):
    """Error distribution of one kind of evidence: a mixture of three parts.

    The evidence is right, roughly right, or belongs to something else, which may be anywhere: that
    part is uniform, and exerts no pull.
    """

    right: float
    """Standard deviation of the part that is right, at confidence 1."""
    unsure: float
    """Growth of that standard deviation from confidence 1 to confidence 0."""
    roughly: float
    """Standard deviation of the part that is roughly right."""
    often: float
    """Share of roughly right among what is not right; a doubted proposal has less of it."""
    far: float
    """Half width of the uniform part, in standard deviations of the roughly right part."""

    def right_of(self, confidence: NDArray[np.float64]) -> NDArray[np.float64]:
        """Standard deviation of the right part, by the evidence's confidence."""
        return self.right + self.unsure * (1.0 - confidence)


PROPOSED: Final = Spread(right=0.014, unsure=0.061, roughly=0.09, often=0.95, far=8)
"""Spread of joints that silhouettes propose, metres."""
SHOWN: Final = Spread(right=0.012, unsure=0.035, roughly=0.051, often=0.55, far=2)
"""Spread of landmarks beside their ray, statures. This and the spreads above were chosen on two
performers and synthetic people (docs/measurements.md)."""
OUTLIER_PENALTY: Final = 4.5
"""Penalty of the uniform part's log probability, while nothing is doubted."""
LEAST, MOST = 0.01, 0.98
"""Bounds of the probability that any evidence is right."""
ROUNDS: Final = 4
"""Rounds of weighted least squares from each start."""
SECOND: Final = 0.02
"""Confidence below which second places are left out."""
HELD: Final = 4.0
"""Precision of a proposed joint without other evidence, 1 / m^2."""
EACH_TWO: Final = 3
"""Number of views up to which any rays of any two of them are a start."""
NONE, BOTH = -1, 2
"""Index for no ray of a view, and the number of rays of a view."""


class Evidence(NamedTuple):
    """The evidence on one joint."""

    proposed_m: Vector
    """(3,) the proposed joint."""
    inlier_probability: float
    """Probability that the proposed joint is right."""
    centres_m: Floats
    """(V, 3) the cameras."""
    directions: Floats
    """(V, BOTH, 3) unit directions of each view's rays: first place, then second place."""
    inliers: Floats
    """(V, BOTH) probability that each ray is right; 0: there is none."""
    spreads_m: Vector
    """(1 + V,) standard deviations of the proposed joint and of each view's landmark, if right."""
    roughly_m: float
    """Standard deviation of the proposed joint, if roughly right."""
    often: float
    """Probability that it is roughly right, if it is not right."""
    stature_m: float


@compiled
def most_probable(given: Evidence, place_m: Vector, precision: Vector) -> float:
    """The highest log probability of the place of one joint.

    Rounds of weighted least squares (the EM algorithm of Dempster 1977) climb to a peak. They start
    at the proposal, at the point of each ray nearest to it, and where the rays of two views meet.
    The highest peak counts.

    Args:
        given: The evidence.
        place_m: (3,) is set to the place.
        precision: (6,) is set to xx, xy, xz, yy, yz, zz of its inverse covariance, 1 / m^2.
    """
    best = -np.inf
    normal, right, here = np.zeros(6), np.zeros(3), np.zeros(3)
    taken = np.full(len(given.centres_m), NONE)
    while True:
        if _start(given, taken, here):
            for _ in range(ROUNDS):
                _weigh(given, here, normal, right)
                _solve(normal, right, here)
            found = _weigh(given, here, normal, right)
            if found > best:
                best = found
                place_m[:] = here
                precision[:] = normal
        if not _next(taken):
            return best


@compiled
def _next(taken: NDArray[np.int64]) -> bool:
    """Advance to the next choice of rays, (V,) of NONE or a ray of at most two views; False at the
    end.

    The last view's ray changes first.
    """
    while True:
        view = len(taken) - 1
        while view >= 0 and taken[view] == BOTH - 1:
            taken[view] = NONE
            view -= 1
        if view < 0:
            return False
        taken[view] += 1
        several = (taken != NONE).sum()
        if several < 2 or (several == 2 and _is_tried(taken)):
            return True
        if several > 2:
            taken[view] = BOTH - 1  # whatever the views after it show, there are more than two


@compiled
def _is_tried(taken: NDArray[np.int64]) -> bool:
    """Whether the rays of two views are a start: of many views, the likeliest ones of neighbours
    in the order of the cameras, so that the cost of a joint grows with the views alone."""
    views = len(taken)
    is_tried = views <= EACH_TWO
    for view in range(views):
        is_tried = is_tried or (taken[view] == 0 and taken[(view + 1) % views] == 0)
    return is_tried


@compiled
def _start(given: Evidence, taken: NDArray[np.int64], here: Vector) -> bool:
    """Set the start for a choice of rays; False where there is none."""
    here[:] = given.proposed_m
    one = other = NONE
    for view in range(len(taken)):
        if taken[view] != NONE:
            if given.inliers[view, taken[view]] <= 0.0:
                return False
            _drop(given.centres_m[view], given.directions[view, taken[view]], here)
            one, other = other, view
    if NONE in (one, other):
        return True
    return _meet(
        given.centres_m[one],
        given.directions[one, taken[one]],
        given.centres_m[other],
        given.directions[other, taken[other]],
        here,
    )


@compiled
def _drop(centre_m: Vector, direction: Vector, here: Vector) -> None:
    """Move a place to the nearest point of a ray."""
    along = 0.0
    for i in range(3):
        along += (here[i] - centre_m[i]) * direction[i]
    for i in range(3):
        here[i] = centre_m[i] + along * direction[i]


@compiled
def _meet(centre_m: Vector, one: Vector, other_m: Vector, two: Vector, here: Vector) -> bool:
    """Set the middle of the shortest line between two rays; False where they are parallel."""
    cosine = along = along_other = 0.0
    for i in range(3):
        apart = centre_m[i] - other_m[i]
        cosine += one[i] * two[i]
        along += one[i] * apart
        along_other += two[i] * apart
    sine_squared = 1.0 - cosine * cosine
    if sine_squared < 1e-6:
        return False
    for i in range(3):
        near = centre_m[i] + one[i] * (cosine * along_other - along) / sine_squared
        far = other_m[i] + two[i] * (along_other - cosine * along) / sine_squared
        here[i] = 0.5 * (near + far)
    return True


@compiled
def _weigh(given: Evidence, here: Vector, normal: Vector, right: Vector) -> float:
    """The log probability of a place, and the normal equations of the next, better place."""
    square = 0.0
    for i in range(3):
        square += (here[i] - given.proposed_m[i]) ** 2
    inlier_probability, spread_m = given.inlier_probability, given.spreads_m[0]
    unlikely = 1.0 - inlier_probability
    is_right = _bell(square, spread_m, inlier_probability, 3)
    is_rough = _bell(square, given.roughly_m, unlikely * given.often, 3)
    total = is_right + is_rough + _anywhere(given.roughly_m, unlikely, given.often, PROPOSED, 3)
    weight = (is_right / spread_m**2 + is_rough / given.roughly_m**2) / total + HELD
    normal[0] = normal[3] = normal[5] = weight
    normal[1] = normal[2] = normal[4] = 0.0
    for i in range(3):
        right[i] = weight * given.proposed_m[i]
    found = math.log(total)
    for view in range(len(given.centres_m)):
        if given.inliers[view, 0] > 0.0:
            found += _look(given, view, here, normal, right)
    return found


@compiled
def _look(given: Evidence, view: int, here: Vector, normal: Vector, right: Vector) -> float:
    """The log probability by one view's rays, whose terms are added to the normal equations.

    Each ray pulls by the probability that the joint is on it.
    """
    likeliest, another = given.directions[view]
    inlier_probability, other = given.inliers[view]
    centre_m, spread_m, roughly_m = (
        given.centres_m[view],
        given.spreads_m[1 + view],
        SHOWN.roughly * given.stature_m,
    )
    square = _beside(centre_m, likeliest, here)
    unlikely = 1.0 - inlier_probability - other
    is_right = _bell(square, spread_m, inlier_probability, 2)
    is_rough = _bell(square, roughly_m, unlikely * SHOWN.often, 2)
    is_other = _bell(_beside(centre_m, another, here), spread_m, other, 2) if other > 0.0 else 0.0
    total = is_right + is_rough + is_other + _anywhere(roughly_m, unlikely, SHOWN.often, SHOWN, 2)
    weight = (is_right / spread_m**2 + is_rough / roughly_m**2) / total
    _pull(centre_m, likeliest, weight, normal, right)
    if is_other > 0.0:
        _pull(centre_m, another, is_other / spread_m**2 / total, normal, right)
    return math.log(total)


@compiled
def _beside(centre_m: Vector, along: Vector, here: Vector) -> float:
    """Squared distance of a place from a ray."""
    x, y, z = here[0] - centre_m[0], here[1] - centre_m[1], here[2] - centre_m[2]
    deep = x * along[0] + y * along[1] + z * along[2]
    return max(0.0, x * x + y * y + z * z - deep * deep)


@compiled
def _pull(centre_m: Vector, along: Vector, weight: float, normal: Vector, right: Vector) -> None:
    """Add a ray's terms to the normal equations."""
    at = centre_m[0] * along[0] + centre_m[1] * along[1] + centre_m[2] * along[2]
    k = 0
    for i in range(3):
        right[i] += weight * (centre_m[i] - at * along[i])
        for j in range(i, 3):
            normal[k] += weight * ((1.0 if i == j else 0.0) - along[i] * along[j])
            k += 1


@compiled
def _bell(square: float, spread_m: float, often: float, axes: int) -> float:
    """A normal density of so many axes at a squared distance (m^2), times its part's weight."""
    return often * math.exp(-square / (2 * spread_m * spread_m)) / spread_m**axes


@compiled
def _anywhere(roughly_m: float, unlikely: float, often: float, kind: Spread, axes: int) -> float:
    """Density of the uniform part: neither right nor roughly right."""
    beyond = unlikely * (1.0 - often) / (kind.far * roughly_m) ** axes
    return beyond * math.exp(-OUTLIER_PENALTY * often / kind.often) + 1e-30


@compiled
def _solve(normal: Vector, right: Vector, place: Vector) -> None:
    """Set the place that solves symmetric normal equations (xx, xy, xz, yy, yz, zz)."""
    a, b, c, d, e, f = normal[0], normal[1], normal[2], normal[3], normal[4], normal[5]
    m00, m01, m02 = d * f - e * e, c * e - b * f, b * e - c * d
    m11, m12, m22 = a * f - c * c, b * c - a * e, a * d - b * b
    whole = a * m00 + b * m01 + c * m02
    x, y, z = right[0], right[1], right[2]
    place[0] = (m00 * x + m01 * y + m02 * z) / whole
    place[1] = (m01 * x + m11 * y + m12 * z) / whole
    place[2] = (m02 * x + m12 * y + m22 * z) / whole
