"""A network for tests, small enough to work out by hand."""

from typing import Any

import numpy as np

from integrator.proposal.network_weights import Network, halves
from integrator.proposal.silhouette_window import BESIDE, CELLS


def network(fill: float = 0.0) -> Network:
    """Three components, four units of each layer, all weights alike."""
    sizes = {
        "see": (CELLS, 3),
        "think": (6 + BESIDE, 4),
        "deepen": (4, 4),
        "take": (4, 12),
        "keep": (4, 12),
        "join": (8, 4),
        "say": (4, 48),
    }
    parts: dict[str, Any] = {}
    for name, size in sizes.items():
        parts[name] = halves(np.full(size, fill, np.float32))
        parts[f"{name}_bias"] = np.zeros(size[1], np.float32)
    return Network(**parts)
