"""Joints proposed from the silhouettes of an instant and a memory of those before it."""

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.compiled import compiled, compiling
from integrator.proposal.network_weights import JOINTS, LiftingNetwork, PoseNetwork
from integrator.proposal.silhouette_window import Floats, Look

SHOULDERS, ELBOWS, HIPS = slice(0, 2), slice(2, 4), slice(6, 8)
OTHER_SIDES: Final = [i ^ 1 for i in range(len(JOINTS))]
"""Index of the same joint on the other side."""

SEES: Final = (0, 5)
"""Index in the further inputs of whether each view sees the person."""


class Proposal(NamedTuple):
    """The joints of an instant."""

    joints_m: NDArray[np.float64]
    """(12, 3) world."""
    confidence: Vector
    """(12,) probability that each is less than 50 mm off."""


def step(
    network: PoseNetwork, memory: Floats | None, seen: Look, stature_m: float
) -> tuple[Floats, Proposal]:
    """One more instant: the memory after it, and its joints.

    Args:
        network: The weights.
        memory: The memory after the instant before; None at the first.
        seen: The views of this instant.
        stature_m: The person's stature.
    """
    memory = np.zeros(len(network.gru_hh), np.float32) if memory is None else memory
    inputs = _inputs(network, seen.windows, seen.beside)
    memory, outputs = recurrent_step(network, memory, inputs)
    outputs = outputs.astype(np.float64)
    places = outputs[: 3 * len(JOINTS)].reshape(-1, 3)
    own = OTHER_SIDES if seen.mirrored else slice(None)
    joints_m = seen.middle_m + stature_m * places[own] @ seen.turn
    return memory, Proposal(joints_m, sigmoid(outputs[3 * len(JOINTS) :][own]))


@compiled
def recurrent_step(
    network: LiftingNetwork | PoseNetwork, memory: Floats, inputs: Floats
) -> tuple[Floats, Floats]:
    """The memory after this instant, and the outputs, of either network."""
    n, own, one = network, len(memory), np.float32(1.0)
    hidden = _relu(_product(inputs, n.fc1, n.fc1_bias))
    hidden = _relu(_product(hidden, n.fc2, n.fc2_bias) + hidden)
    input_gates = _product(hidden, n.gru_ih, n.gru_ih_bias)
    hidden_gates = _product(memory, n.gru_hh, n.gru_hh_bias)
    gates = one / (one + np.exp(-(input_gates[: 2 * own] + hidden_gates[: 2 * own])))
    new = np.tanh(input_gates[2 * own :] + gates[:own] * hidden_gates[2 * own :])
    memory = (one - gates[own:]) * new + gates[own:] * memory
    joined = _relu(_product(np.concatenate((hidden, memory)), n.fc3, n.fc3_bias))
    return memory, _product(joined, n.out, n.out_bias)


@compiled
def _inputs(network: PoseNetwork, windows: Floats, beside: Floats) -> Floats:
    """Components of both windows, 0 for a view without the person, and the further inputs."""
    size = len(network.pca_bias)
    shown = np.zeros(2 * size + len(beside), np.float32)
    for view in range(2):
        if beside[SEES[view]] > 0.0:
            components = _product(windows[view], network.pca, network.pca_bias)
            shown[view * size : (view + 1) * size] = components
    shown[2 * size :] = beside
    return shown


@compiled
def _product(values: Floats, weights: NDArray[np.uint16], bias: Floats) -> Floats:
    """values (n,) @ weights (n, m) + bias (m,).

    Weights that are multiplied by zero, as for half of the hidden units and most of a window, are
    not read. Four rows at a time halve the remaining time.
    """
    total = bias.copy()
    rows = np.flatnonzero(values)
    fours = len(rows) - len(rows) % 4
    for k in range(0, fours, 4):
        a, b, c, d = rows[k], rows[k + 1], rows[k + 2], rows[k + 3]
        at_a, at_b, at_c, at_d = weights[a], weights[b], weights[c], weights[d]
        for j in range(len(total)):
            total[j] += (
                values[a] * _from_bfloat16(at_a[j])
                + values[b] * _from_bfloat16(at_b[j])
                + values[c] * _from_bfloat16(at_c[j])
                + values[d] * _from_bfloat16(at_d[j])
            )
    for row in rows[fours:]:
        for j in range(len(total)):
            total[j] += values[row] * _from_bfloat16(weights[row, j])
    return total


@compiling(inline="always")
def _from_bfloat16(bits: np.uint16) -> np.float32:
    """The float32 number of bfloat16 bits."""
    return np.uint32(np.uint32(bits) << np.uint32(16)).view(np.float32)


@compiled
def _relu(values: Floats) -> Floats:
    return np.maximum(values, np.float32(0.0))


def sigmoid(values: Floats | Vector) -> NDArray[Any]:
    """Probabilities of logits."""
    return 1.0 / (1.0 + np.exp(-values.clip(-60.0, 60.0)))


def aimed(joints_m: NDArray[np.float64], seen: Look, stature_m: float) -> NDArray[np.float64]:
    """The network's target output, (n, 3) statures from the middle."""
    own = OTHER_SIDES if seen.mirrored else slice(None)
    found: NDArray[np.float64] = (joints_m[own] - seen.middle_m) @ seen.turn.T / stature_m
    return found
