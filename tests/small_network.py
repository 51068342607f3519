"""A network for tests, small enough to work out by hand."""

from typing import Any

import numpy as np

from integrator.proposal.network_weights import PoseNetwork, to_bfloat16
from integrator.proposal.silhouette_window import BESIDE, CELLS


def network(fill: float = 0.0) -> PoseNetwork:
    """Three components, four units of each layer, all weights alike."""
    sizes = {
        "pca": (CELLS, 3),
        "fc1": (6 + BESIDE, 4),
        "fc2": (4, 4),
        "gru_ih": (4, 12),
        "gru_hh": (4, 12),
        "fc3": (8, 4),
        "out": (4, 48),
    }
    parts: dict[str, Any] = {}
    for name, size in sizes.items():
        parts[name] = to_bfloat16(np.full(size, fill, np.float32))
        parts[f"{name}_bias"] = np.zeros(size[1], np.float32)
    return PoseNetwork(**parts)
