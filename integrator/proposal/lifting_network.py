"""Joints lifted from the landmarks of an instant and a memory of those before it.

Pictures show the directions of joints; their depth follows from how people move (as in Martinez et
al. 2017, for one view). The network gets no silhouettes, so its errors differ from those of the
silhouettes' proposal.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from integrator.proposal.landmark_look import Look
from integrator.proposal.network_weights import JOINTS, LiftingNetwork
from integrator.proposal.pose_network import HIPS, OTHER_SIDES, recurrent_step, sigmoid
from integrator.proposal.silhouette_window import Floats

PLACES = 3 * len(JOINTS)


class Lifted(NamedTuple):
    """The joints of an instant."""

    joints_m: NDArray[np.float64]
    """(12, 3) world."""
    confidence: Vector
    """(12,) probability that each, relative to the hips, is less than 50 mm off: the network's
    own."""


def step(
    network: LiftingNetwork, memory: Floats | None, seen: Look, stature_m: float
) -> tuple[Floats, Lifted]:
    """One more instant: the memory after it, and its joints.

    Args:
        network: The weights.
        memory: The memory after the instant before; None at the first.
        seen: The views of this instant.
        stature_m: The person's stature.
    """
    memory = np.zeros(len(network.gru_hh), np.float32) if memory is None else memory
    memory, outputs = recurrent_step(network, memory, seen.inputs)
    told = outputs.astype(np.float64)
    own = OTHER_SIDES if seen.mirrored else slice(None)
    places = told[:PLACES].reshape(-1, 3)[own] + told[PLACES : PLACES + 3]
    joints_m = seen.middle_m + stature_m * places @ seen.turn
    return memory, Lifted(joints_m, sigmoid(told[PLACES + 3 :][own]))


def aimed(joints_m: NDArray[np.float64], seen: Look, stature_m: float) -> Vector:
    """The network's target for true joints (12, 3): (39,) statures."""
    own_m = joints_m[OTHER_SIDES] if seen.mirrored else joints_m
    hips_m = own_m[HIPS].mean(axis=0)
    places, hips = (own_m - hips_m) @ seen.turn.T, seen.turn @ (hips_m - seen.middle_m)
    return np.concatenate([places.ravel(), hips]) / stature_m
