"""The teaching of proposals, held against outlines and against the mean pose."""

import numpy as np
import pytest
from rich.console import Console

from common.camera import project
from integrator import propose
from synth.outlines import outlines
from tritrack.proposals import examples, learnt

QUIET = Console(quiet=True)


def test_outlines_hold_the_joints_and_repeat() -> None:
    """Hips and knees lie within their silhouette in both views; a seed is one performance."""
    first, again = list(outlines(5)), list(outlines(5))
    assert len(first) > 10
    assert all(np.array_equal(a.masks[1], b.masks[1]) for a, b in zip(first, again, strict=True))
    inside = [
        mask[tuple(np.floor(project(camera, shown.joints_m[:1])[0]).astype(int)[::-1])]
        for shown in first
        for mask, camera in zip(shown.masks, shown.rig.cameras, strict=True)
    ]
    assert np.mean(inside) == 1.0


@pytest.mark.slow
def test_what_is_learnt_beats_the_mean_pose() -> None:
    rng = np.random.default_rng(3)
    taught = [examples(outlines(seed), rng) for seed in range(40)]
    inputs, targets = (np.concatenate(parts) for parts in zip(*taught, strict=True))
    network = learnt(inputs, targets, 3, QUIET, epochs=120)
    new = [examples(outlines(seed), rng) for seed in range(800_000, 800_005)]
    cells, due = (np.concatenate(parts) for parts in zip(*new, strict=True))

    def missed(said: np.ndarray) -> float:
        return float(np.linalg.norm((said - due).reshape(len(due), -1, 3), axis=-1).mean())

    mean = missed(np.broadcast_to(targets.mean(axis=0), due.shape))
    assert missed(propose.run(network, cells.astype(np.float32))) < 0.85 * mean


def test_examples_keep_what_a_wrong_stature_changes_small() -> None:
    """A stature a per cent wrong moves the targets by a per cent, not more."""
    shown = list(outlines(7))
    one = examples(shown, np.random.default_rng(1))[1]
    other = examples(shown, np.random.default_rng(2))[1]
    assert np.abs(one - other).max() == pytest.approx(0.0, abs=0.05)
