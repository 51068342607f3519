"""Whether a stretch of the best path was a performance, and of which posture."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from recognizer.features import Bearings, Rows, bearings
from recognizer.forward import forward
from recognizer.path_network import COUNT, LAST, ONSET, SCALE, PathNetwork
from recognizer.postures import Array

LEAST_FRAMES: Final = 10
"""Shortest performance, frames: the quickest squat takes 1.5 s, anything shorter is a twitch."""
LEAST_STATES: Final = 3
"""Number of a posture's five states that must be met: a part of a posture is not the posture."""
MISFIT: Final = 42.0
"""Nats per frame by which a performance may fit worse than those of the training data: some one
and a half per entry, as people differ. A hand at the head fits a raised arm worse by 150 and
more."""
RIVAL: Final = 9.0
"""Nats per frame by which a held posture may fit worse than one with motion."""
DRIFT, DRIFT_SHARE = 0.09, 0.3
"""Deviation of the travel from the posture's over a performance, leg lengths in five frames
times its weight, and as a share of it: people walk slower or faster. Steps back are no walk."""


class Event(NamedTuple):
    """One performance."""

    name: str
    first: int
    last: int
    """First and last frame, counted in calls of `step`."""
    posterior: float
    """Probability of this posture among all and the filler, in [0, 1]."""
    times: int
    """Number of repetitions: strides, kicks, circles."""


def event_of(network: PathNetwork, over: NDArray[np.int64], rows: Rows) -> Event | None:
    """A performance, if it was one: the likeliest of the possible postures.

    Args:
        network: The network of all postures.
        over: (LAST + 1,) record of the best path.
        rows: (n, 20) its frames.
    """
    model, first, last = network.model, int(over[ONSET]), int(over[LAST])
    shown, logs = bearings(rows), model.log_emission(rows)
    totals = forward(model.start, model.transition, logs)
    held = [_holds(network, p, shown, logs[:, p]) for p in range(len(model.names))]
    among = np.where(held, totals, -np.inf)
    posture = int(among.argmax())
    if among[posture] < totals.max() - RIVAL * len(rows):
        return None
    filler = (model.fit[posture] - MISFIT) * len(rows)
    shares = np.exp(SCALE * (np.append(among, filler) - among[posture]))
    posterior = float(shares[posture] / shares.sum())
    return Event(model.names[posture], first, last, posterior, max(1, int(over[COUNT])))


def _holds(network: PathNetwork, posture: int, shown: Bearings, logs: Array) -> bool:
    """Whether frames show the posture completely.

    Args:
        network: The network of all postures.
        posture: Index of the posture.
        shown: (n, 27) the frames.
        logs: (n, s) their log densities in the posture's states.
    """
    model, state = network.model, logs.argmax(axis=1)
    meant = model.mean[posture, state, -3:].mean(axis=0)
    drift = np.linalg.norm(shown[:, -3:].mean(axis=0) - meant)
    return bool(
        len(shown) >= LEAST_FRAMES
        and len(np.unique(state)) >= LEAST_STATES
        and network.far[posture, state].any()
        and logs.max(axis=1).mean() >= model.fit[posture] - MISFIT
        and drift <= DRIFT + DRIFT_SHARE * np.linalg.norm(meant)
    )
