"""The scale of the network's confidences: Platt scaling by people from whom it did not learn."""

from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray

from lab.landmark_lessons.landmark_loss import answers, near_enough, peaks, shares_about
from lab.landmark_lessons.movenet_landmarks import JOINTS, MovenetLandmarks
from synth.picture.composites import Composite
from viewer.landmarks.landmark_network import PLATT

LEAST: Final = 1e-4
"""Of a share of a map about its peak, as the viewer reads it."""
ROUNDS: Final = 30
STEADY: Final = 1e-3
"""Added to the diagonal of what each round divides by: the fit is defined where all are right."""


def set_confidence(network: MovenetLandmarks, shown: list[Composite]) -> None:
    """Scale a network's logits of how sure it is of each joint, so that the viewer's confidences,
    with its PLATT, are how often joints are less than NEAR off.

    Args:
        network: Is changed.
        shown: Of people from whom it did not learn; those of nobody tell nothing.

    Source: Platt 1999, "Probabilistic outputs for support vector machines".
    """
    somebody = [one for one in shown if not one.nobody]
    maps, told, _ = answers(network, somebody)
    flat = maps.flatten(2)
    joints = torch.from_numpy(np.stack([one.joints_px for one in somebody]))
    near = near_enough((peaks(flat) - joints).norm(dim=-1), somebody)
    about = shares_about(flat)[1].sum((-2, -1)).clamp(LEAST, 1.0 - LEAST).logit()
    slope, share, offset = PLATT
    logits, given, right = (
        values.numpy().ravel().astype(float) for values in (told[:, -JOINTS:], share * about, near)
    )
    own, added = fitted(logits, given, right)
    with torch.no_grad():
        last, times = network.told[-1], own / slope
        last.weight[-JOINTS:] *= times
        last.bias[-JOINTS:] = last.bias[-JOINTS:] * times + (added - offset) / slope


def fitted(
    logits: NDArray[np.float64], given: NDArray[np.float64], right: NDArray[np.float64]
) -> tuple[float, float]:
    """The slope and offset of logits with which, added to what is given, they are most likely.

    Args:
        logits: (n,)
        given: (n,) logits that are added as they are.
        right: (n,) 1 or 0.
    """
    terms, best = np.stack([logits, np.ones_like(logits)], 1), np.zeros(2)
    for _ in range(ROUNDS):
        probable = 1.0 / (1.0 + np.exp(-(terms @ best + given)))
        bent = (terms * (probable * (1.0 - probable))[:, None]).T @ terms
        best = best + np.linalg.solve(bent + STEADY * np.eye(2), terms.T @ (right - probable))
    return float(best[0]), float(best[1])
