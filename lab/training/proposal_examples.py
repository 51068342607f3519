"""Training examples for the proposal network: synthetic silhouettes, and joints."""

from collections.abc import Iterable
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from integrator.proposal.network_weights import JOINTS
from integrator.proposal.pose_network import aimed
from integrator.proposal.silhouette_window import Floats, look
from synth.person.skeleton import JOINTS as ALL_JOINTS
from synth.picture.silhouette_examples import Manner, SilhouetteExample, silhouette_examples

BELIEVED: Final = (1.008, 0.02, 0.05)
"""A measured stature over the true one: mean and standard deviation for a measured body, and the
deviation for an unmeasured one."""
UNMEASURED_SHARE: Final = 0.15
ASTRAY_M: Final = 1.5
"""Distance of a silhouette from the person, metres, beyond which an example is dropped."""
PICK: Final = [ALL_JOINTS.index(name) for name in JOINTS]


class Example(NamedTuple):
    """An example from a performance."""

    cells: NDArray[np.uint8]
    """(n, 2, CELLS) covered part of each cell, of 255."""
    beside: Floats
    """(n, BESIDE) further inputs."""
    due: Floats
    """(n, 36) target output."""
    stature_m: float
    """Assumed stature."""


def example_of(performance: tuple[int, Manner]) -> Example:
    """The example of a performance, given its seed and its manner."""
    seed, manner = performance
    return example(silhouette_examples(seed, manner), np.random.default_rng([seed, 78]))


def example(shown: Iterable[SilhouetteExample], rng: np.random.Generator) -> Example:
    """The network's inputs from a performance, and its target."""
    cells, beside, due, believed_m = [], [], [], 0.0
    mean, measured, unmeasured = BELIEVED
    wrong = mean + rng.normal() * (unmeasured if rng.random() < UNMEASURED_SHARE else measured)
    for masks, joints_m, rig, stature_m, since_s in shown:
        first, second = (mask if mask is not None and mask.any() else None for mask in masks)
        if first is None and second is None:
            continue
        believed_m = wrong * stature_m
        window = look((first, second), rig, believed_m, since_s)
        if window is None or np.linalg.norm(window.middle_m - joints_m[0]) > ASTRAY_M:
            continue
        cells.append(np.rint(255 * window.windows).astype(np.uint8))
        beside.append(window.beside)
        due.append(aimed(joints_m[PICK], window, believed_m).ravel())
    return Example(
        np.array(cells, np.uint8),
        np.array(beside, np.float32),
        np.array(due, np.float32),
        believed_m,
    )
