"""Calm angles: a constant-velocity Kalman filter over all of them, the seam at 180 included."""

from functools import lru_cache
from typing import Any, Final, NamedTuple

import numpy as np

from common.body.body import Vector
from common.compiled import compiled


class Smoothing(NamedTuple):
    """How much is believed of what is measured.

    With 3 to 6 degrees of white noise on the true angles of r01 and r04 this errs least, or within
    6 % of it, at the pace that was filmed and at twice that pace.
    """

    noise_deg: float = 6.0
    """Standard deviation of a measured angle."""
    acceleration_deg_s2: float = 1000.0
    """Standard deviation of the acceleration between two frames."""


START_SPEED_DEG_S: Final = 200.0
"""Standard deviation of the speed at the first measurement: a limb may be moving already."""


class State(NamedTuple):
    """A value: stepping it leaves it as it was."""

    settings: Smoothing
    period_s: float
    x: Vector
    """(2, n): the angles, degrees, and their speeds, degrees a second."""
    P: Vector | None
    """(2, 2) covariance of an angle and its speed: all are measured together and alike, so it is
    the same for each, and no angle tells of another. None until something was measured."""


def init(n: int, period_s: float, settings: Smoothing = Smoothing()) -> State:
    """A filter for n angles that has measured nothing.

    Args:
        n: How many angles.
        period_s: Time between frames; what a step of no given time takes.
        settings: How much is believed.
    """
    return State(settings, period_s, np.zeros((2, n)), None)


def step(state: State, angles_deg: Vector | None, dt_s: float) -> tuple[State, Vector, Vector]:
    """One instant: predicted at constant speed, then drawn to what was measured.

    The prediction is brought to the measurement's turn first, so that 179 and -179 are two
    degrees apart. What comes out is in that turn too: near the measurement, and beyond +-180
    rather than a whole turn away from it.

    Args:
        state: What is remembered.
        angles_deg: Measured angles (n,); None where there is no measurement: the prediction is
            the answer then.
        dt_s: Time since the step before.

    Returns:
        The state, the smooth angles (n,) and their speeds (n,), degrees a second; NaN as long as
        nothing was measured.
    """
    if state.P is None:
        if angles_deg is None:
            unknown = np.full(state.x.shape[1], np.nan)
            return state, unknown, unknown.copy()
        state = _started(state, angles_deg)
    else:
        state = _stepped(state, state.P, angles_deg, dt_s)
    return state, state.x[0].copy(), state.x[1].copy()


def _stepped(state: State, before: Vector, angles_deg: Vector | None, dt_s: float) -> State:
    x, P = _predicted(state.x, before, dt_s, _noise(dt_s, state.settings))
    if angles_deg is None:
        return state._replace(x=x, P=P)
    _correct(x, P, angles_deg, state.settings.noise_deg**2)
    return state._replace(x=x, P=P)


@compiled
def _predicted(x: Any, P: Any, dt_s: float, noise: Any) -> tuple[Any, Any]:
    """What constant speed leads to, (2, n), and its covariance, (2, 2)."""
    ahead, due = x.copy(), P + noise
    ahead[0] += dt_s * x[1]
    due[0, 0] += dt_s * (P[0, 1] + P[1, 0] + dt_s * P[1, 1])
    due[0, 1] += dt_s * P[1, 1]
    due[1, 0] += dt_s * P[1, 1]
    return ahead, due


@compiled
def _correct(x: Any, P: Any, angles_deg: Any, noise: float) -> None:
    """Draw what was predicted, brought to their turn, to what was measured."""
    gain, speed_gain = P[0, 0] / (P[0, 0] + noise), P[1, 0] / (P[0, 0] + noise)
    for i in range(len(angles_deg)):
        x[0, i] += 360.0 * np.round((angles_deg[i] - x[0, i]) / 360.0)
        off = angles_deg[i] - x[0, i]
        x[0, i] += gain * off
        x[1, i] += speed_gain * off
    top, beside = P[0, 0], P[0, 1]
    P[0, 0], P[0, 1] = top - gain * top, beside - gain * beside
    P[1, 0], P[1, 1] = P[1, 0] - speed_gain * top, P[1, 1] - speed_gain * beside


def _started(state: State, angles_deg: Vector) -> State:
    x = np.stack([angles_deg, np.zeros_like(angles_deg)])
    return state._replace(x=x, P=np.diag([state.settings.noise_deg**2, START_SPEED_DEG_S**2]))


@lru_cache(maxsize=16)
def _noise(dt_s: float, settings: Smoothing) -> Vector:
    """(2, 2) what an unknown acceleration, the same all through a step, adds to the covariance."""
    moved = [[0.25 * dt_s**4, 0.5 * dt_s**3], [0.5 * dt_s**3, dt_s**2]]
    return np.array(moved) * settings.acceleration_deg_s2**2
