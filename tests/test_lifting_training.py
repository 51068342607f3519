"""The teaching of the lifting network, held against the mean pose."""

import sys
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from integrator.proposal import lifting_network
from integrator.proposal.landmark_look import INPUTS, Look
from integrator.proposal.network_weights import LiftingNetwork
from tritrack.training.lifting_examples import LiftingExample, lifting_examples
from tritrack.training.lifting_training import learnt, train_lifting
from tritrack.training.torch_network import Round
from tritrack.training.training import TrainingError

QUIET = Console(quiet=True)


def said(network: LiftingNetwork, shown: LiftingExample) -> np.ndarray:
    """What a network says of a performance, (n, 36): in statures from the middle."""
    memory, told = None, []
    for inputs in shown.inputs:
        memory, found = lifting_network.step(
            network, memory, Look(inputs, np.zeros(3), np.eye(3), False), 1.0
        )
        told.append(found.joints_m.ravel())
    return np.array(told)


def placed(due: np.ndarray) -> np.ndarray:
    """(n, 36) from the middle, of what is due: joints from the hips, and where these are."""
    places = due[:, :36].reshape(len(due), -1, 3) + due[:, None, 36:]
    return np.asarray(places.reshape(len(due), -1))


def test_a_seed_is_one_lesson() -> None:
    one, again = lifting_examples(11), lifting_examples(11)
    assert len(one) == len(again)
    for a, b in zip(one, again, strict=True):
        assert all(np.array_equal(getattr(a, n), getattr(b, n)) for n in a._fields)


def test_each_performance_is_shown_by_one_camera_and_by_two() -> None:
    """What is due is somebody's joints: within a stature of the hips, these near the middle."""
    for seed in range(20):
        for example in lifting_examples(seed):
            assert example.inputs.shape == (len(example.due), INPUTS)
            joints = np.linalg.norm(example.due[:, :36].reshape(-1, 12, 3), axis=2)
            assert joints.max() < 1.1
            assert np.abs(example.inputs).max() < 6.0


def test_learning_without_pytorch_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(TrainingError, match=r"tritrack\[train\]"):
        train_lifting(tmp_path / "n.npz", 0, QUIET)


@pytest.mark.slow
def test_what_is_learnt_beats_the_mean_pose() -> None:
    """Also: PyTorch's unit and ours agree, or the memory would say something else."""
    pytest.importorskip("torch", reason="learning needs the extra `train`")
    taught = [one for seed in range(60) for one in lifting_examples(seed)]
    network = learnt(taught, 3, QUIET, rounds=[Round(40, 1.5e-3, 8)])
    new = [one for seed in range(800_000, 800_006) for one in lifting_examples(seed)]

    def missed(told: list[np.ndarray]) -> float:
        off = [(a - placed(b.due)).reshape(-1, 3) for a, b in zip(told, new, strict=True)]
        return float(np.linalg.norm(np.concatenate(off), axis=1).mean())

    mean = np.concatenate([placed(each.due) for each in taught]).mean(axis=0)
    at_once = [np.broadcast_to(mean, (len(each.due), 36)) for each in new]
    assert missed([said(network, each) for each in new]) < 0.75 * missed(at_once)
