"""The teaching of proposals, held against outlines and against the mean pose."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from drawn_pool import Draws, pool_here
from numpy_torch import numpy_torch
from rich.console import Console

from integrator.proposal import network_weights, pose_network
from integrator.proposal.network_weights import to_bfloat16
from integrator.proposal.silhouette_window import BESIDE, Look
from lab.training import (
    network_training,
    proposal_examples,
    proposal_training,
    torch_network,
)
from lab.training.proposal_examples import Example, example, example_of
from lab.training.proposal_training import learnt, train_proposals
from lab.training.torch_network import Round
from lab.training.training import TrainingError
from synth.picture.silhouette_examples import AT_LARGE, ORDINARY, silhouette_examples

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
    pytest.importorskip("torch", reason="learning needs the extra `train`")
    taught = [example_of((seed, ORDINARY)) for seed in range(48)]
    network = learnt(taught, 3, QUIET, rounds=[Round(20, 2e-3, 8)])
    new = [example_of((seed, ORDINARY)) for seed in range(800_000, 800_006)]

    def missed(told: list[np.ndarray]) -> float:
        off = [(a - b.due).reshape(-1, 3) for a, b in zip(told, new, strict=True)]
        return float(np.linalg.norm(np.concatenate(off), axis=1).mean())

    mean = np.concatenate([each.due for each in taught]).mean(axis=0)
    at_once = [np.broadcast_to(mean, each.due.shape) for each in new]
    assert missed([said(network, each) for each in new]) < 0.75 * missed(at_once)


def shown_by(seed: int, instants: int, stature_m: float = 1.6) -> Example:
    """Windows of six cells; the first view sees the instants of even number, the second the first
    two."""
    rng = np.random.default_rng(seed)
    beside = rng.uniform(0.2, 0.4, (instants, BESIDE)).astype(np.float32)
    beside[:, pose_network.SEES] = 0.0
    beside[::2, pose_network.SEES[0]] = beside[:2, pose_network.SEES[1]] = 1.0
    cells = rng.integers(0, 256, (instants, 2, 6)).astype(np.uint8)
    return Example(cells, beside, rng.normal(0, 1, (instants, 36)).astype(np.float32), stature_m)


def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proposal_training, "CELLS", 6)
    monkeypatch.setattr(proposal_training, "COMPONENTS", 2)


def test_components_are_the_two_widest_of_the_windows_that_views_see(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Held against a singular value decomposition. Of 26 instants every third is taken, of 11
    every one."""
    small(monkeypatch)
    shown = [shown_by(1, 26), shown_by(2, 11)]
    windows = []
    for one, step in zip(shown, (3, 1), strict=True):
        for at in range(0, len(one.cells), step):
            for view, sees in enumerate(pose_network.SEES):
                if one.beside[at, sees]:
                    windows.append(one.cells[at, view] / 255)
    mean, components = proposal_training._components(shown)
    assert mean == pytest.approx(np.mean(windows, axis=0), abs=1e-6)
    _, sizes, ways = np.linalg.svd(np.array(windows) - np.mean(windows, axis=0))
    spreads = (sizes / np.sqrt(len(windows)))[1::-1]
    due = ways[1::-1].T / (spreads + 0.02 * spreads[-1])
    assert components.shape == (6, 2)
    assert np.abs(components) == pytest.approx(np.abs(due), rel=1e-3)


def test_tensors_hold_components_of_what_each_view_sees_and_what_goes_beside_them() -> None:
    one = shown_by(3, 3, 1.7)
    mean = np.linspace(0.1, 0.6, 6).astype(np.float32)
    components = np.random.default_rng(5).normal(0, 1, (6, 2)).astype(np.float32)
    seen, due, real, stature_m = proposal_training._tensors(numpy_torch(), mean, components, one)
    assert seen.shape == (3, 4 + BESIDE)
    for at in range(3):
        for view, sees in enumerate(pose_network.SEES):
            own = (one.cells[at, view] / 255 - mean) @ components * one.beside[at, sees]
            assert seen[at, 2 * view : 2 * view + 2] == pytest.approx(own, abs=1e-5)
    assert seen[:, 4:] == pytest.approx(one.beside)
    assert due == pytest.approx(one.due)
    assert real.tolist() == [1.0] * 3
    assert stature_m == pytest.approx([1.7] * 3)


def test_what_is_learnt_is_of_the_size_asked_for_and_knows_the_mean_window(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    small(monkeypatch)
    seeds: list[int] = []
    torch = numpy_torch(manual_seed=seeds.append)
    noted: list[Any] = []
    monkeypatch.setattr(proposal_training, "torch_or_refuse", lambda: torch)
    monkeypatch.setattr(proposal_training, "UNITS", (5, 4, 3))
    monkeypatch.setattr(torch_network, "learn", lambda *given: noted.append(given))
    shown, rounds = [shown_by(1, 9), shown_by(2, 12)], [Round(1, 0.1, 2)]
    network = learnt(shown, 8, QUIET, rounds)
    mean, components = proposal_training._components(shown)
    assert (network.pca == to_bfloat16(components)).all()
    assert network.pca_bias == pytest.approx(-mean @ components)
    assert network.fc1.shape == (2 * 2 + BESIDE, 5)
    usual = np.concatenate([shown[0].due, shown[1].due]).mean(axis=0)
    assert network.out_bias[:36] == pytest.approx(usual)
    ((given_torch, parts, examples, given_rounds, seed, console),) = noted
    assert (given_torch, given_rounds, seed, console, seeds) == (torch, rounds, 8, QUIET, [8])
    assert [len(each[0]) for each in examples] == [9, 12]
    assert len(parts) == 5


def drawing(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Performances of 7, 8 and 9 instants instead of drawn ones; notes what was taught."""
    taught: list[Any] = []
    asked = pool_here(monkeypatch)
    monkeypatch.setattr(network_training, "torch_or_refuse", lambda: None)
    monkeypatch.setattr(proposal_training, "PERFORMANCES", {ORDINARY: 2, AT_LARGE: 1})
    monkeypatch.setattr(proposal_training, "example_of", lambda given: shown_by(0, given[0] - 13))

    def learning(shown: list[Example], seed: int, console: Console) -> Any:
        taught.append((asked, [len(each.due) for each in shown], seed, console))
        return network_weights.shipped()

    monkeypatch.setattr(proposal_training, "learnt", learning)
    return taught


def test_each_performance_has_a_seed_of_its_own_and_too_short_ones_teach_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    taught, out = drawing(monkeypatch), tmp_path / "proposals.npz"
    assert train_proposals(out, 20, QUIET) == {"model": str(out), "instants": 17}
    assert taught == [([(20, ORDINARY), (21, ORDINARY), (22, AT_LARGE)], [8, 9], 20, QUIET)]
    written = network_weights.load(out, network_weights.PoseNetwork)
    assert (written.fc3 == network_weights.shipped().fc3).all()


def test_a_file_that_cannot_be_written_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    taught = drawing(monkeypatch)
    with pytest.raises(TrainingError, match=f"^cannot write {tmp_path}: Is a directory"):
        train_proposals(tmp_path, 20, QUIET)
    assert len(taught) == 1
    out = tmp_path / "no" / "file.npz"
    with pytest.raises(
        TrainingError, match=f"^cannot write {out}: there is no folder {out.parent}"
    ):
        train_proposals(out, 20, QUIET)
    assert len(taught) == 1


def looking(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The middle is where the test's rig says; notes what is looked at."""
    noted: list[Any] = []

    def look(masks: Any, rig: Any, stature_m: float, since_s: float) -> Any:
        noted.append((masks, stature_m, since_s))
        if rig is None:
            return None
        windows = np.full((2, 3), 0.501, np.float32)
        return SimpleNamespace(windows=windows, beside=np.arange(4.0), middle_m=np.array(rig))

    def aimed(joints_m: Any, window: Any, stature_m: float) -> Any:
        return joints_m / stature_m

    monkeypatch.setattr(proposal_examples, "look", look)
    monkeypatch.setattr(proposal_examples, "aimed", aimed)
    return noted


JOINTS_M: Any = np.arange(60.0).reshape(20, 3) / 10


def instant(masks: Any, off_m: float | None) -> Any:
    """The middle is off the hips by so much; None where no view finds the person."""
    rig = None if off_m is None else JOINTS_M[0] + (0.0, 0.6 * off_m, -0.8 * off_m)
    return masks, JOINTS_M, rig, 1.5, 0.07


def test_instants_teach_that_a_view_sees_and_that_lie_near_the_person(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    noted = looking(monkeypatch)
    full, empty = np.ones((2, 2), np.bool_), np.zeros((2, 2), np.bool_)
    shown = [
        instant((None, None), 0.0),
        instant((empty, None), 0.0),
        instant((full, empty), 1.49),
        instant((None, full), 1.51),
        instant((full, full), None),
    ]
    found = example(shown, Draws(random=[0.15], normal=[2.0]))  # type: ignore[arg-type]
    assert found.stature_m == pytest.approx(1.5 * (1.008 + 2 * 0.02))
    assert [(a is not None, b is not None) for (a, b), *_ in noted] == [
        (True, False),
        (False, True),
        (True, True),
    ]
    assert noted[0][1:] == (found.stature_m, 0.07)
    assert found.cells.tolist() == [[[128] * 3] * 2]
    assert found.beside.tolist() == [[0, 1, 2, 3]]
    assert found.due[0, :3] == pytest.approx(
        JOINTS_M[proposal_examples.PICK[0]] / found.stature_m, rel=1e-5
    )


def test_a_body_that_was_not_measured_is_believed_to_be_more_wrongly_tall(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looking(monkeypatch)
    shown = [instant((np.ones((2, 2), np.bool_), None), 0.0)]
    found = example(shown, Draws(random=[0.149], normal=[2.0]))  # type: ignore[arg-type]
    assert found.stature_m == pytest.approx(1.5 * (1.008 + 2 * 0.05))
