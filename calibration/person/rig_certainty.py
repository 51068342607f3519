"""How certain a rig by the person is: its covariance, and what is not known well enough."""

import math
from typing import Final

import numpy as np

from calibration.person.rig_fit import Fit
from calibration.tracks.rig_guess import FOCALS, LATE, RIG, pinholes
from calibration.tracks.sight_lines import Numbers
from common.body.body import Vector

STEP: Final = 1e-4
"""By which numbers are moved to see what moves with them."""
UNSURE_FOCAL, UNSURE_TURN_DEG, UNSURE_FRAMES = 0.04, 2.0, 0.3
"""Error bars, one sigma, above which something is not known: synthetic rigs within them were right
to 5 % of focal length, 3 degrees and half a frame (seeds from 1000 on,
`benchmarks/wild_rigs.py`)."""
CLOCK_FRAMES: Final = 0.15
"""No clock is known better, frames: between frames joints are taken to go straight on (synthetic
rigs, seeds from 1000 on)."""


def covariance_of(found: Fit) -> Numbers:
    """(guess, guess) of what was found."""
    covariance: Numbers = np.asarray(np.linalg.pinv(found.jacobian.T @ found.jacobian), np.float64)
    return covariance


def late_errors_frames(covariance: Numbers, period_s: float) -> Vector:
    """(clips,) how uncertain the clocks are, frames, one sigma."""
    posterior = np.sqrt(np.diag(covariance)[LATE:]) / period_s
    errors: Vector = np.hypot(posterior, CLOCK_FRAMES)
    return errors


def unsure_of(found: Fit, period_s: float) -> tuple[str, ...]:
    """What of a rig is not known well enough to be relied on, with its error bar (one sigma).

    Args:
        found: The whole rig, all of it free.
        period_s: Between frames of view 2.
    """
    covariance = covariance_of(found)
    errors = np.sqrt(np.diag(covariance))
    focal = float(errors[FOCALS].max())
    turn_deg = turn_error_deg(found.guess, covariance)
    late_frames = float(late_errors_frames(covariance, period_s).max())
    words = {
        f"focal lengths to {100 * focal:.0f} % only": focal > UNSURE_FOCAL,
        f"turn between the cameras to {turn_deg:.1f} degrees only": turn_deg > UNSURE_TURN_DEG,
        f"clocks to {late_frames:.1f} frames only": late_frames > UNSURE_FRAMES,
    }
    return tuple(word for word, is_unsure in words.items() if is_unsure)


def turn_error_deg(guess: Vector, covariance: Numbers) -> float:
    """How far the turn of one camera against the other may be off, about any axis, one sigma."""
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
