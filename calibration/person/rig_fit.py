"""The rig, the person's lengths and the delays that explain both views best."""

from collections.abc import Callable
from typing import Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from calibration.person.rig_evidence import Evidence, Sides, own_moments
from calibration.person.rig_residuals import UNSEEN, Explained, explained, misfits
from calibration.tracks import person_prior as prior
from calibration.tracks.rig_guess import LATE
from calibration.tracks.sight_lines import Numbers
from common.body.body import Vector

EXCHANGE_COST: Final = 0.5
"""Log likelihood that exchanged sides must gain for a part."""

NEAR_FRAMES: Final = np.arange(-3, 4) / 4
"""Steps from a clock to better ones, frames. Landmarks err less between frames than at them, so
the objective has a local maximum at each whole frame, which a fit does not cross by itself."""


ANYWHERE: Final = 10.0
"""Range around the prior clock, sigmas, in which better ones are searched."""


class Fit(NamedTuple):
    """The result of a fit."""

    guess: Vector
    cost: float
    sides: tuple[Sides, ...]
    jacobian: Numbers
    """(residuals, free) Jacobian."""


def fitted(start: Vector, evidence: Evidence, free: Sides, rounds: int, steps: int) -> Fit:
    """The best guess near a start.

    Args:
        start: A guess.
        evidence: The data.
        free: (guess,) which numbers may change.
        rounds: How often the exchanged sides are decided again.
        steps: Iterations of the fit in each round.
    """
    found, sides, jacobian = in_rounds(
        start,
        free,
        (lambda guess: sides_of(guess, evidence), lambda guess, at: misfits(guess, evidence, at)),
        rounds,
        steps,
    )
    return Fit(found.guess, found.cost, sides, jacobian)


class Best(NamedTuple):
    """The best guess, and half the sum of its squared residuals."""

    guess: Vector
    cost: float


Decided = TypeVar("Decided")


def in_rounds(
    start: Vector,
    free: Sides | NDArray[np.int64],
    objective: tuple[Callable[[Vector], Decided], Callable[[Vector, Decided], Vector]],
    rounds: int,
    steps: int,
) -> tuple[Best, Decided, Numbers]:
    """The best guess near a start, what was decided for it, and its (residuals, free) Jacobian.

    Args:
        start: A guess.
        free: Which of its numbers may change.
        objective: What a guess decides, as exchanged sides, and the residuals by that.
        rounds: At least one: how often that is decided again.
        steps: Iterations of the fit in each round.
    """
    from scipy.optimize import least_squares

    decide, residuals = objective
    guess = start.copy()

    def with_free(values: Vector) -> Vector:
        whole = guess.copy()
        whole[free] = values
        return whole

    for _ in range(rounds):
        decided = decide(guess)
        found = least_squares(
            lambda values, at=decided: residuals(with_free(values), at),
            guess[free],
            x_scale="jac",
            max_nfev=steps,
            ftol=1e-5,
            xtol=1e-6,
        )
        guess = with_free(found.x)
    return Best(guess, float(found.cost)), decided, found.jac


def on_time(guess: Vector, evidence: Evidence) -> Vector:
    """The guess with the delay of view 2 in each clip that makes its sight lines meet best."""
    found = guess.copy()
    for n, clip in enumerate(evidence.clips):
        period_s = float(np.median(np.diff(clip.second.times_s)))
        believed_s, sigma_s = evidence.known.mean[LATE + n], evidence.known.sigma[LATE + n]
        anywhere = np.arange(-ANYWHERE * sigma_s, ANYWHERE * sigma_s + period_s, period_s)
        tried = [
            *(believed_s + anywhere).tolist(),
            *(guess[LATE + n] + period_s * NEAR_FRAMES).tolist(),
        ]
        costs, share = [], own_moments(clip) / len(clip.first.times_s)
        for late_s in tried:
            found[LATE + n] = late_s
            believed = 2.0 * np.log1p(((late_s - believed_s) / sigma_s) ** 2 / 2.0)
            costs.append(2.0 * share * _apart(found, evidence, n) + believed)
        found[LATE + n] = tried[int(np.argmin(costs))]
    return found


def _apart(guess: Vector, evidence: Evidence, number: int) -> float:
    """Cost of a clip, each part with its sides as they fit better."""
    whole = [np.full((len(evidence.clips[number].first.times_s), 3), other) for other in (0, 1)]
    both = [explained(guess, evidence, number, sides.astype(bool)) for sides in whole]
    return float(np.minimum(*(_costs(one) for one in both)).sum())


def sides_of(guess: Vector, evidence: Evidence) -> tuple[Sides, ...]:
    """For each clip, the moments at which one view's sides of a part must be exchanged."""
    found = []
    for n, clip in enumerate(evidence.clips):
        costs = []
        for other in (False, True):
            sides = np.full((len(clip.first.times_s), 3), other)
            costs.append(_costs(explained(guess, evidence, n, sides)))
        found.append((costs[1] + EXCHANGE_COST < costs[0]) & (np.arange(3) != prior.TRUNK))
    return tuple(found)


def _costs(one: Explained) -> NDArray[np.float64]:
    """(n, 3) cost of each part."""
    unseen = np.log1p(UNSEEN**2 / 2)
    gaps = np.where(one.used, np.where(one.met.before, np.log1p(one.met.gap**2 / 2), 5.0), unseen)
    lengths = np.where(one.lengths_used, np.log1p(one.lengths**2 / 2), unseen)
    costs = np.zeros((len(gaps), 3))
    for part in range(3):
        costs[:, part] = gaps[:, part == prior.PART_OF_JOINT].sum(axis=1)
        costs[:, part] += lengths[:, part == prior.PART_OF_SEGMENT].sum(axis=1)
    return costs
