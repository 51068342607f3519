"""Networks for tests, small enough to work out by hand."""

from typing import Any

import numpy as np

from integrator.proposal.landmark_look import INPUTS
from integrator.proposal.network_weights import (
    LIFTED_OUTPUTS,
    OUTPUTS,
    LiftingNetwork,
    PoseNetwork,
    to_bfloat16,
)
from integrator.proposal.silhouette_window import BESIDE, CELLS


def network(fill: float = 0.0) -> PoseNetwork:
    """Three components, four units of each layer, all weights alike."""
    return PoseNetwork(**_parts({"pca": (CELLS, 3)} | _layers(6 + BESIDE, OUTPUTS), fill))


def lifting_network() -> LiftingNetwork:
    """Four units of each layer, all weights nothing."""
    return LiftingNetwork(**_parts(_layers(INPUTS, LIFTED_OUTPUTS), 0.0))


def _layers(told: int, says: int) -> dict[str, tuple[int, int]]:
    return {
        "fc1": (told, 4),
        "fc2": (4, 4),
        "gru_ih": (4, 12),
        "gru_hh": (4, 12),
        "fc3": (8, 4),
        "out": (4, says),
    }


def _parts(sizes: dict[str, tuple[int, int]], fill: float) -> dict[str, Any]:
    parts: dict[str, Any] = {}
    for name, size in sizes.items():
        parts[name] = to_bfloat16(np.full(size, fill, np.float32))
        parts[f"{name}_bias"] = np.zeros(size[1], np.float32)
    return parts
