"""Smoothed angles: a constant-velocity Kalman filter over all of them, across the seam at 180."""

from typing import Final, NamedTuple

import numpy as np

from common.body.body import Vector


class Smoothing(NamedTuple):
    """Noise parameters of the filter.

    Chosen with 3 to 6 degrees of white noise on the true angles of two performers, at the recorded
    pace and at twice that pace. The error is the least there, or within 6 % of it.
    """

    noise_deg: float = 6.0
    """Standard deviation of a measured angle."""
    acceleration_deg_s2: float = 1000.0
    """Standard deviation of the acceleration between two frames."""


START_SPEED_DEG_S: Final = 200.0
"""Standard deviation of the speed at the first measurement: a limb may be moving already."""


class State(NamedTuple):
    """The filter's state; a step returns a new one."""

    settings: Smoothing
    period_s: float
    x: Vector
    """(2, n) the angles, degrees, and their speeds, degrees a second."""
    P: Vector | None
    """(2, 2) covariance of an angle and its speed, the same for all; None until the first
    measurement."""


def init(n: int, period_s: float, settings: Smoothing = Smoothing()) -> State:
    """A filter for n angles before any measurement.

    Args:
        n: Number of angles.
        period_s: Time between frames; the default of a step's time.
        settings: Noise parameters.
    """
    return State(settings, period_s, np.zeros((2, n)), None)


def step(state: State, angles_deg: Vector | None, dt_s: float) -> tuple[State, Vector, Vector]:
    """One instant: prediction at constant speed, then correction by the measurement.

    The prediction is first brought to the measurement's turn, so that 179 and -179 are two degrees
    apart. The result is in that turn too: near the measurement, and beyond +-180 rather than a
    whole turn away from it.

    Args:
        state: The filter's state.
        angles_deg: Measured angles (n,); None without a measurement: the result is the prediction.
        dt_s: Time since the step before.

    Returns:
        The state, the smoothed angles (n,) and their speeds (n,), degrees a second; NaN before
        the first measurement.
    """
    if state.P is None:
        if angles_deg is None:
            unknown = np.full(state.x.shape[1], np.nan)
            return state, unknown, unknown.copy()
        state = _started(state, angles_deg)
    else:
        state = _stepped(state, state.P, angles_deg, dt_s)
    smooth_deg, speed_deg_s = state.x.copy()
    return state, smooth_deg, speed_deg_s


def _started(state: State, angles_deg: Vector) -> State:
    variances = (state.settings.noise_deg**2, START_SPEED_DEG_S**2)
    return state._replace(x=np.stack([angles_deg, np.zeros_like(angles_deg)]), P=np.diag(variances))


def _stepped(state: State, before: Vector, angles_deg: Vector | None, dt_s: float) -> State:
    moved = np.array([[1.0, dt_s], [0.0, 1.0]])
    pushed = state.settings.acceleration_deg_s2 * np.array([0.5 * dt_s**2, dt_s])
    x, P = moved @ state.x, moved @ before @ moved.T + np.outer(pushed, pushed)
    if angles_deg is not None:
        x[0] += 360.0 * np.round((angles_deg - x[0]) / 360.0)
        gain = P[:, 0] / (P[0, 0] + state.settings.noise_deg**2)
        x, P = x + np.outer(gain, angles_deg - x[0]), P - np.outer(gain, P[0])
    return state._replace(x=x, P=P)
