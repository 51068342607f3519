"""As how many moments a video counts, by how far its landmarks err alike from first to last."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from calibration.person.rig_residuals import Explained

FITTED: Final = 20.0
"""How many numbers are fitted: two cameras, a person's lengths and a clock. A video that seems to
have as many moments counts half of them: the fit has taken up what landmarks err by."""
FARTHEST: Final = 3.0
"""Sigmas beyond which a miss counts as so many."""
LEAST: Final = 2.0


def measured_worth(seen: Sequence[Explained]) -> float:
    """As how many moments whose landmarks err by themselves all clips count.

    The sight lines of one joint miss each other now on this side, now on that, where errors come
    and go; over n independent moments they do by 1 / sqrt(n) sigmas on average. What is left of
    them on average is therefore what the video errs by: errors that last some frames and habits
    of a network alike.

    Args:
        seen: What a rig makes of each clip that was fitted as if landmarks had no habits. What is
            believed of any rig would else keep it from the video, and that would look like one.
    """
    gaps = np.concatenate([np.clip(one.met.gap, -FARTHEST, FARTHEST) for one in seen])
    used = np.concatenate([one.used & one.met.before for one in seen])
    counts = used.sum(axis=0)
    means = np.where(used, gaps, 0.0).sum(axis=0) / np.maximum(counts, 1)
    lasting = float((counts * means**2).sum() / max(float(counts.sum()), 1.0))
    return max(LEAST, 1.0 / max(lasting * (1.0 + FITTED * lasting), 1.0 / max(len(used), 1)))
