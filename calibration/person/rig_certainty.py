"""Uncertainty of a rig found by the person: its covariance, and the numbers that are too
uncertain."""

import math
from typing import Final

import numpy as np

from calibration.person.rig_fit import Fit
from calibration.tracks.rig_guess import FOCALS, LATE, RIG, pinholes
from calibration.tracks.sight_lines import Numbers
from common.body.body import Vector

STEP: Final = 1e-4
"""Step of each number in numerical derivatives."""
UNSURE_FOCAL, UNSURE_TURN_DEG, UNSURE_FRAMES = 0.04, 2.0, 0.3
"""Standard deviations above which a number counts as unknown: synthetic rigs within them were
right to 5 % of focal length, 3 degrees and half a frame (seeds from 1000 on,
`benchmarks/wild_rigs.py`)."""
CLOCK_FRAMES: Final = 0.15
"""Smallest standard deviation of a clock, frames: joints are interpolated linearly between
frames (synthetic rigs, seeds from 1000 on)."""


def covariance_of(found: Fit) -> Numbers:
    """(guess, guess) covariance of the result."""
    covariance: Numbers = np.asarray(np.linalg.pinv(found.jacobian.T @ found.jacobian), np.float64)
    return covariance


def late_errors_frames(covariance: Numbers, period_s: float) -> Vector:
    """(clips,) standard deviations of the clocks, frames."""
    posterior = np.sqrt(np.diag(covariance)[LATE:]) / period_s
    errors: Vector = np.hypot(posterior, CLOCK_FRAMES)
    return errors


def unsure_of(found: Fit, period_s: float) -> tuple[str, ...]:
    """The numbers of a rig that are too uncertain to be relied on, each with its standard
    deviation.

    Args:
        found: The rig, with all its numbers free.
        period_s: Time between frames of view 2.
    """
    return unsure_words(found.guess, covariance_of(found), period_s)


def unsure_words(guess: Vector, covariance: Numbers, period_s: float) -> tuple[str, ...]:
    """The same for a guess and its covariance."""
    errors = np.sqrt(np.diag(covariance))
    focal = float(errors[FOCALS].max())
    turn_deg = turn_error_deg(guess, covariance)
    late_frames = float(late_errors_frames(covariance, period_s).max())
    words = {
        f"focal lengths to {100 * focal:.0f} % only": focal > UNSURE_FOCAL,
        f"turn between the cameras to {turn_deg:.1f} degrees only": turn_deg > UNSURE_TURN_DEG,
        f"clocks to {late_frames:.1f} frames only": late_frames > UNSURE_FRAMES,
    }
    return tuple(word for word, is_unsure in words.items() if is_unsure)


def turn_error_deg(guess: Vector, covariance: Numbers) -> float:
    """Standard deviation of one camera's turn relative to the other, about any axis."""
    turn = _turn(guess)
    axes = np.zeros((3, len(guess)))
    for n in range(FOCALS.stop, RIG):
        moved = guess.copy()
        moved[n] += STEP
        off = (_turn(moved) @ turn.T) / STEP
        axes[:, n] = (off[2, 1], off[0, 2], off[1, 0])
    return math.degrees(math.sqrt(float(np.trace(axes @ covariance @ axes.T))))


def _turn(guess: Vector) -> Numbers:
    one, other = pinholes(guess)
    turn: Numbers = other.R @ one.R.T
    return turn
