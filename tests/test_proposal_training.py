"""The teaching of proposals, held against outlines and against the mean pose."""

import sys
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from integrator.proposal import network_weights, pose_network
from integrator.proposal.silhouette_window import Look
from synth.picture.silhouette_examples import AT_LARGE, ORDINARY, silhouette_examples
from tritrack.training.proposal_examples import Example, example, example_of
from tritrack.training.proposal_training import learnt, train_proposals
from tritrack.training.torch_network import Round
from tritrack.training.training import TrainingError

QUIET = Console(quiet=True)


def said(network: network_weights.PoseNetwork, shown: Example) -> np.ndarray:
    """What a network says of a performance, (n, 36): in statures from the middle."""
    memory, told = None, []
    for cells, beside in zip(shown.cells, shown.beside, strict=True):
        seen = Look(cells.astype(np.float32) / 255, beside, np.zeros(3), np.eye(3))
        memory, found = pose_network.step(network, memory, seen, 1.0)
        told.append(found.joints_m.ravel())
    return np.array(told)


def test_a_wrong_stature_moves_what_is_due_by_as_much() -> None:
    shown = list(silhouette_examples(7))
    one, other = (example(shown, np.random.default_rng(seed)) for seed in (1, 2))
    ratio = one.stature_m / other.stature_m
    tall = np.abs(one.due).max(axis=1)
    assert np.median(other.due / one.due) == pytest.approx(ratio, rel=0.02)
    assert (tall < 1.2).all()


def test_a_seed_is_one_lesson() -> None:
    one, again = example_of((11, AT_LARGE)), example_of((11, AT_LARGE))
    assert all(np.array_equal(getattr(one, n), getattr(again, n)) for n in one._fields)


def test_learning_without_pytorch_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(TrainingError, match=r"tritrack\[train\]"):
        train_proposals(tmp_path / "n.npz", 0, QUIET)


@pytest.mark.slow
def test_what_is_learnt_beats_the_mean_pose() -> None:
    """Also: PyTorch's unit and ours agree, or the memory would say something else."""
    pytest.importorskip("torch", reason="learning needs the extra `train`")
    taught = [example_of((seed, ORDINARY)) for seed in range(64)]
    network = learnt(taught, 3, QUIET, rounds=[Round(40, 1.5e-3, 8)])
    new = [example_of((seed, ORDINARY)) for seed in range(800_000, 800_006)]

    def missed(told: list[np.ndarray]) -> float:
        off = [(a - b.due).reshape(-1, 3) for a, b in zip(told, new, strict=True)]
        return float(np.linalg.norm(np.concatenate(off), axis=1).mean())

    mean = np.concatenate([each.due for each in taught]).mean(axis=0)
    at_once = [np.broadcast_to(mean, each.due.shape) for each in new]
    assert missed([said(network, each) for each in new]) < 0.75 * missed(at_once)
