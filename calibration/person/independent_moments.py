"""The number of independent moments of a clip, from how its landmarks' errors last."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from calibration.person.rig_residuals import Explained

FITTED: Final = 20.0
"""Number of fitted values: two cameras, a person's lengths and a clock. Where the estimate comes
near this number, half of it is used: the fit has absorbed the landmarks' errors."""
FARTHEST: Final = 3.0
"""Residual, sigmas, at which misses are capped."""
LEAST: Final = 2.0


def measured_worth(seen: Sequence[Explained]) -> float:
    """Number of moments with independent landmark errors that all clips together count for.

    The signed gaps between the sight lines of one joint average out where errors are independent:
    over n independent moments their mean is 1 / sqrt(n) sigmas. The mean that is left is therefore
    the clip's error: errors that last some frames and systematic errors of a network alike.

    Args:
        seen: Each clip under a rig that was fitted as if landmarks had no systematic errors.
            Otherwise the priors would keep the rig from the clip, and that would look like such an
            error.
    """
    gaps = np.concatenate([np.clip(one.met.gap, -FARTHEST, FARTHEST) for one in seen])
    used = np.concatenate([one.used & one.met.before for one in seen])
    counts = used.sum(axis=0)
    means = np.where(used, gaps, 0.0).sum(axis=0) / np.maximum(counts, 1)
    lasting = float((counts * means**2).sum() / max(float(counts.sum()), 1.0))
    return max(LEAST, 1.0 / max(lasting * (1.0 + FITTED * lasting), 1.0 / max(len(used), 1)))
