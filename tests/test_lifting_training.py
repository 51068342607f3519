"""The teaching of the lifting network, held against the mean pose."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn_pool import pool_here
from numpy_torch import numpy_torch
from rich.console import Console

from integrator.proposal import lifting_network
from integrator.proposal.landmark_look import INPUTS, Look
from integrator.proposal.network_weights import (
    LiftingNetwork,
    from_bfloat16,
    load,
    shipped_lifting,
)
from integrator.proposal.pose_network import recurrent_step
from lab.training import lifting_training, network_training, torch_network
from lab.training.lifting_examples import LiftingExample, lifting_examples
from lab.training.lifting_training import learnt, train_lifting
from lab.training.torch_network import Round
from lab.training.training import TrainingError

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
def test_pytorchs_recurrent_unit_and_ours_have_the_same_memory() -> None:
    torch = pytest.importorskip("torch", reason="learning needs the extra `train`")
    n, random = shipped_lifting(), np.random.default_rng(5)
    inputs = random.normal(0, 1, (9, INPUTS)).astype(np.float32)
    unit = torch.nn.GRU(len(n.gru_ih), len(n.gru_hh), batch_first=True)
    unit.load_state_dict(
        {
            "weight_ih_l0": torch.tensor(from_bfloat16(n.gru_ih).T),
            "weight_hh_l0": torch.tensor(from_bfloat16(n.gru_hh).T),
            "bias_ih_l0": torch.tensor(n.gru_ih_bias),
            "bias_hh_l0": torch.tensor(n.gru_hh_bias),
        }
    )
    hidden = np.maximum(inputs @ from_bfloat16(n.fc1) + n.fc1_bias, 0.0)
    hidden = np.maximum(hidden @ from_bfloat16(n.fc2) + n.fc2_bias + hidden, 0.0)
    theirs = unit(torch.tensor(hidden)[None])[0][0].detach().numpy()
    memory, ours = np.zeros(len(n.gru_hh), np.float32), []
    for one in inputs:
        memory, _ = recurrent_step(n, memory, one)
        ours.append(memory)
    assert np.abs(theirs).max() > 0.1
    assert np.array(ours) == pytest.approx(theirs, abs=1e-4)


@pytest.mark.slow
def test_what_is_learnt_beats_the_mean_pose() -> None:
    pytest.importorskip("torch", reason="learning needs the extra `train`")
    taught = [one for seed in range(30) for one in lifting_examples(seed)]
    network = learnt(taught, 3, QUIET, rounds=[Round(10, 3e-3, 8)])
    new = [one for seed in range(800_000, 800_006) for one in lifting_examples(seed)]

    def missed(told: list[np.ndarray]) -> float:
        off = [(a - placed(b.due)).reshape(-1, 3) for a, b in zip(told, new, strict=True)]
        return float(np.linalg.norm(np.concatenate(off), axis=1).mean())

    mean = np.concatenate([placed(each.due) for each in taught]).mean(axis=0)
    at_once = [np.broadcast_to(mean, (len(each.due), 36)) for each in new]
    assert missed([said(network, each) for each in new]) < 0.75 * missed(at_once)


def shown_by(instants: int, stature_m: float = 1.6) -> LiftingExample:
    rng = np.random.default_rng(instants)
    inputs = rng.normal(0, 1, (instants, INPUTS)).astype(np.float32)
    return LiftingExample(inputs, rng.normal(0, 1, (instants, 39)).astype(np.float32), stature_m)


def drawing(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Performances of 7 and 8 instants, and of 9, instead of drawn ones; notes what is taught."""
    taught: list[Any] = []
    asked = pool_here(monkeypatch)
    made = {20: [shown_by(7), shown_by(8)], 21: [], 22: [shown_by(9)]}
    monkeypatch.setattr(network_training, "torch_or_refuse", lambda: None)
    monkeypatch.setattr(lifting_training, "PERFORMANCES", 3)
    monkeypatch.setattr(lifting_training, "lifting_examples", made.__getitem__)

    def learning(shown: list[LiftingExample], seed: int, console: Console) -> Any:
        taught.append((asked, [len(each.due) for each in shown], seed, console))
        return shipped_lifting()

    monkeypatch.setattr(lifting_training, "learnt", learning)
    return taught


def test_each_performance_has_a_seed_of_its_own_and_too_short_ones_teach_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    taught, out = drawing(monkeypatch), tmp_path / "lifting.npz"
    assert train_lifting(out, 20, QUIET) == {"model": str(out), "instants": 17}
    assert taught == [([20, 21, 22], [8, 9], 20, QUIET)]
    assert (load(out, LiftingNetwork).fc3 == shipped_lifting().fc3).all()


def test_a_file_that_cannot_be_written_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    taught = drawing(monkeypatch)
    with pytest.raises(TrainingError, match=f"^cannot write {tmp_path}: Is a directory"):
        train_lifting(tmp_path, 20, QUIET)
    out = tmp_path / "no" / "file.npz"
    with pytest.raises(
        TrainingError, match=f"^cannot write {out}: there is no folder {out.parent}"
    ):
        train_lifting(out, 20, QUIET)
    assert len(taught) == 1


def test_what_is_learnt_starts_with_what_is_usually_due(monkeypatch: pytest.MonkeyPatch) -> None:
    seeds: list[int] = []
    torch, noted = numpy_torch(manual_seed=seeds.append), list[Any]()
    monkeypatch.setattr(lifting_training, "torch_or_refuse", lambda: torch)
    monkeypatch.setattr(lifting_training, "UNITS", (5, 4, 3))
    monkeypatch.setattr(torch_network, "learn", lambda *given: noted.append(given))
    shown, rounds = [shown_by(2, 1.7), shown_by(3)], [Round(1, 0.1, 2)]
    network = learnt(shown, 8, QUIET, rounds)
    assert network.fc1.shape == (INPUTS, 5)
    assert network.fc3.shape == (5 + 4, 3)
    usual = np.concatenate([shown[0].due, shown[1].due]).mean(axis=0)
    assert network.out_bias[:39] == pytest.approx(usual)
    ((given_torch, _, examples, given_rounds, seed, console),) = noted
    assert (given_torch, given_rounds, seed, console, seeds) == (torch, rounds, 8, QUIET, [8])
    inputs, due, real, stature_m = examples[0]
    assert inputs == pytest.approx(shown[0].inputs)
    assert due == pytest.approx(shown[0].due)
    assert real.tolist() == [1.0, 1.0]
    assert stature_m == pytest.approx([1.7, 1.7])
