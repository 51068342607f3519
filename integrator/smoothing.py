"""Calm angles: a constant-velocity Kalman filter over all of them, the seam at 180 included."""

from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from filterpy.common import Q_discrete_white_noise
from filterpy.kalman import predict, update

from common.body import Vector


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
    """(2 n,): each angle, degrees, followed by its speed, degrees a second."""
    P: Vector | None
    """(2 n, 2 n) covariance of `x`; None until something was measured."""


def init(n: int, period_s: float, settings: Smoothing = Smoothing()) -> State:
    """A filter for n angles that has measured nothing.

    Args:
        n: How many angles.
        period_s: Time between frames; what a step of no given time takes.
        settings: How much is believed.
    """
    return State(settings, period_s, np.zeros(2 * n), None)


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
    n = len(state.x) // 2
    if state.P is None:
        if angles_deg is None:
            return state, np.full(n, np.nan), np.full(n, np.nan)
        state = _started(state, angles_deg)
        return state, state.x[::2].copy(), state.x[1::2].copy()
    model = _model(n, dt_s, state.settings)
    x, P = predict(state.x, state.P, model.F, model.Q)
    if angles_deg is not None:
        x[::2] += 360.0 * np.round((angles_deg - x[::2]) / 360.0)
        x, P = update(x, P, angles_deg, model.R, model.H)
    return state._replace(x=x, P=P), x[::2].copy(), x[1::2].copy()


def _started(state: State, angles_deg: Vector) -> State:
    x = np.zeros_like(state.x)
    x[::2] = angles_deg
    spread = np.tile([state.settings.noise_deg**2, START_SPEED_DEG_S**2], len(angles_deg))
    return state._replace(x=x, P=np.diag(spread))


class _Model(NamedTuple):
    F: Vector
    Q: Vector
    H: Vector
    R: Vector


@lru_cache(maxsize=16)
def _model(n: int, dt_s: float, settings: Smoothing) -> _Model:
    """The filter's matrices for n independent angles, all alike."""
    one = np.eye(n, dtype=np.float64)
    return _Model(
        F=np.kron(one, np.array([[1.0, dt_s], [0.0, 1.0]])),
        Q=Q_discrete_white_noise(2, dt_s, settings.acceleration_deg_s2**2, block_size=n),
        H=np.kron(one, np.array([[1.0, 0.0]])),
        R=settings.noise_deg**2 * one,
    )
