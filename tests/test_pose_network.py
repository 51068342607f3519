"""Proposed joints, held against made-up people whom the network was never taught on."""

from itertools import islice, pairwise
from typing import Any

import numpy as np
import pytest
from glass import MIRROR, in_mirror
from small_network import network

from integrator.proposal import network_weights, pose_network
from integrator.proposal.network_weights import JOINTS, PoseNetwork
from integrator.proposal.pose_network import OTHER_SIDES
from integrator.proposal.silhouette_window import BESIDE, CELLS, Look, look
from synth.person.skeleton import JOINTS as ALL_JOINTS
from synth.picture.silhouette_examples import silhouette_examples

PICK = [ALL_JOINTS.index(name) for name in JOINTS]
UNTAUGHT = range(900_000, 900_012)
"""Seeds beyond all that are taught."""


SEEN = Look(
    np.zeros((2, CELLS), np.float32),
    np.zeros(BESIDE, np.float32),
    np.array([1.0, 2.0, 3.0]),
    np.eye(3),
)


@pytest.mark.slow
def test_untaught_people_are_found_to_a_few_centimetres() -> None:
    """Twelve performances, half of them joined late, turned, or seen by one camera for a while."""
    missed = []
    for seed in UNTAUGHT:
        memory = None
        for shown in silhouette_examples(seed):
            masks = tuple(m if m is not None and m.any() else None for m in shown.masks)
            if masks[0] is None or masks[1] is None:
                continue
            seen = look((masks[0], masks[1]), shown.rig, shown.stature_m, shown.since_s)
            assert seen is not None
            memory, found = pose_network.step(
                network_weights.shipped(), memory, seen, shown.stature_m
            )
            missed.append(np.linalg.norm(found.joints_m - shown.joints_m[PICK], axis=1))
    assert np.median(missed) < 0.05
    assert np.mean(missed) < 0.08


def test_somebody_in_a_mirror_is_found_there() -> None:
    """Where the cameras stand the other way round too: left for right, and nothing else."""
    memories: list[np.ndarray | None] = [None, None]
    seen_m = []
    for shown in islice(silhouette_examples(UNTAUGHT[0]), 20):
        first, second = shown.masks
        assert first is not None
        assert second is not None
        flipped = (np.ascontiguousarray(first[:, ::-1]), np.ascontiguousarray(second[:, ::-1]))
        found = []
        for n, (masks, rig) in enumerate(
            (((first, second), shown.rig), (flipped, in_mirror(shown.rig)))
        ):
            seen = look(masks, rig, shown.stature_m, shown.since_s)
            assert seen is not None
            memories[n], each = pose_network.step(
                network_weights.shipped(), memories[n], seen, shown.stature_m
            )
            found.append(each)
        seen_m.append(np.abs(found[1].joints_m[OTHER_SIDES] * MIRROR - found[0].joints_m))
        assert found[1].confidence[OTHER_SIDES] == pytest.approx(found[0].confidence, abs=0.05)
    assert np.mean(seen_m) < 0.003  # a window's edge is not where the other's is


def test_a_memory_without_weights_fades_by_half() -> None:
    """Update gate 1/2, new memory tanh(0): h becomes h / 2 (Cho et al. 2014, eq. 7)."""
    memory, _ = pose_network.step(network(), np.full(4, 0.8, np.float32), SEEN, 1.75)
    assert memory == pytest.approx(np.full(4, 0.4))


def test_a_shut_gate_keeps_the_memory() -> None:
    shut = network()
    shut.gru_ih_bias[4:8] = 60.0
    memory, _ = pose_network.step(shut, np.arange(4, dtype=np.float32), SEEN, 1.75)
    assert memory == pytest.approx(np.arange(4))


def test_the_second_layer_adds_to_the_first() -> None:
    """Thought 3, deepened by half of it, 4.5; a sum of four says 18."""
    told = network()
    told.fc1_bias[:] = 3.0
    told.fc2[:] = network_weights.to_bfloat16(0.5 * np.eye(4, dtype=np.float32))
    told.fc3[:4] = network_weights.to_bfloat16(np.eye(4, dtype=np.float32))
    told.out[:, 0] = network_weights.to_bfloat16(np.ones(4, np.float32))
    _, found = pose_network.step(told, None, SEEN._replace(middle_m=np.zeros(3)), 1.0)
    assert found.joints_m[0] == pytest.approx([18.0, 0.0, 0.0])


def test_a_silent_network_says_the_middle_and_is_undecided() -> None:
    _, found = pose_network.step(network(), None, SEEN, 1.75)
    assert found.joints_m == pytest.approx(np.tile([1.0, 2.0, 3.0], (12, 1)))
    assert found.confidence == pytest.approx(np.full(12, 0.5))


def test_what_is_said_is_statures_in_the_frame_of_the_proposal() -> None:
    """What `aimed` asks for, said by the last bias, is placed where the joints were."""
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    seen = SEEN._replace(turn=turn)
    joints_m = np.random.default_rng(1).normal(size=(12, 3))
    told = network()
    told.out_bias[:36] = pose_network.aimed(joints_m, seen, 1.6).ravel()
    _, found = pose_network.step(told, None, seen, 1.6)
    assert found.joints_m == pytest.approx(joints_m, abs=1e-6)


def test_a_view_that_does_not_see_adds_nothing() -> None:
    """Its window is no silhouette of somebody who is not there."""
    told, rng = network(0.01), np.random.default_rng(2)
    windows, beside = rng.random((2, CELLS)).astype(np.float32), np.zeros(BESIDE, np.float32)
    beside[pose_network.SEES[0]] = 1.0
    _, one = pose_network.step(told, None, SEEN._replace(windows=windows, beside=beside), 1.75)
    windows[1] = 0.0
    _, alone = pose_network.step(told, None, SEEN._replace(windows=windows, beside=beside), 1.75)
    windows[0] = 0.0
    _, none = pose_network.step(told, None, SEEN._replace(windows=windows, beside=beside), 1.75)
    assert np.array_equal(one.joints_m, alone.joints_m)
    assert not np.allclose(alone.joints_m, none.joints_m)


def test_halves_multiply_as_numbers_do() -> None:
    """A layer by hand: what is said is the sum of what is seen times the weights."""
    rng = np.random.default_rng(3)
    told, beside = network(), rng.normal(size=BESIDE).astype(np.float32)
    beside[list(pose_network.SEES)] = 0.0
    thinks = rng.normal(size=(BESIDE, 4)).astype(np.float32)
    told.fc1[6:] = network_weights.to_bfloat16(thinks)
    told.fc3[:4] = network_weights.to_bfloat16(np.eye(4, dtype=np.float32))
    told.out[:, :4] = network_weights.to_bfloat16(np.eye(4, dtype=np.float32))
    seen = SEEN._replace(beside=beside, middle_m=np.zeros(3))
    _, found = pose_network.step(told, None, seen, 1.0)
    due = np.maximum(
        beside @ network_weights.from_bfloat16(network_weights.to_bfloat16(thinks)), 0.0
    )
    assert found.joints_m.ravel()[:4] == pytest.approx(due, rel=1e-5)


def test_parts_are_told_apart_by_pairs() -> None:
    """Left before right, joint by joint: what limbs.py and the outlines rely on."""
    assert all(a[2:] == b[2:] for a, b in list(pairwise(JOINTS))[::2])
    assert [name[0] for name in JOINTS] == ["l", "r"] * 6


def drawn_network(seed: int) -> PoseNetwork:
    """Weights and biases at random."""
    rng, made = np.random.default_rng(seed), network()
    parts: dict[str, Any] = {
        name: network_weights.to_bfloat16(rng.normal(0.0, 0.5, part.shape).astype(np.float32))
        if part.dtype == np.uint16
        else rng.normal(0.0, 0.5, part.shape).astype(np.float32)
        for name, part in made._asdict().items()
    }
    return made._replace(**parts)


def plain(values: np.ndarray, weights: np.ndarray, bias: np.ndarray) -> np.ndarray:
    return np.asarray(values @ network_weights.from_bfloat16(weights) + bias)


@pytest.mark.parametrize("count", [0, 1, 3, 4, 5, 8, 11])
def test_a_product_leaves_out_what_is_nought_and_nothing_else(count: int) -> None:
    rng = np.random.default_rng(count)
    values = np.zeros(20, np.float32)
    values[rng.permutation(20)[:count]] = rng.normal(size=count)
    weights = network_weights.to_bfloat16(rng.normal(size=(20, 6)).astype(np.float32))
    bias = rng.normal(size=6).astype(np.float32)
    before = bias.copy()
    found = pose_network._product(values, weights, bias)
    assert found == pytest.approx(plain(values, weights, bias), abs=1e-5)
    assert np.array_equal(bias, before)


@pytest.mark.parametrize("seed", range(3))
def test_a_step_is_two_layers_a_gated_memory_and_two_layers(seed: int) -> None:
    """Cho et al. 2014, with the reset gate behind the product, in plain numpy."""
    rng, n = np.random.default_rng(seed), drawn_network(seed)
    memory, told = (rng.normal(size=k).astype(np.float32) for k in (4, len(n.fc1)))
    hidden = np.maximum(plain(told, n.fc1, n.fc1_bias), 0.0)
    hidden = hidden + plain(hidden, n.fc2, n.fc2_bias)
    hidden = np.maximum(hidden, 0.0)
    own = np.split(plain(hidden, n.gru_ih, n.gru_ih_bias), 3)
    kept = np.split(plain(memory, n.gru_hh, n.gru_hh_bias), 3)
    reset, update = (1.0 / (1.0 + np.exp(-(own[i] + kept[i]))) for i in (0, 1))
    new = np.tanh(own[2] + reset * kept[2])
    later = (1.0 - update) * new + update * memory
    joined = np.maximum(plain(np.concatenate([hidden, later]), n.fc3, n.fc3_bias), 0.0)
    found, said = pose_network.recurrent_step(n, memory, told)
    assert found == pytest.approx(later, abs=1e-5)
    assert said == pytest.approx(plain(joined, n.out, n.out_bias), abs=1e-4)


def test_each_view_is_told_by_its_components_beside_what_is_said_of_both() -> None:
    rng, n = np.random.default_rng(6), drawn_network(6)
    windows = rng.random((2, CELLS)).astype(np.float32)
    beside = rng.normal(size=BESIDE).astype(np.float32)
    for sees in ((1.0, 1.0), (1.0, 0.0), (0.0, 1.0)):
        beside[list(pose_network.SEES)] = sees
        found = pose_network._inputs(n, windows, beside)
        for view in range(2):
            due = plain(windows[view], n.pca, n.pca_bias) if sees[view] else np.zeros(3)
            assert found[3 * view : 3 * view + 3] == pytest.approx(due, abs=1e-3)
        assert found[6:] == pytest.approx(beside)


def test_probabilities_of_logits_stay_finite() -> None:
    found = pose_network.sigmoid(np.array([-1e6, -1.0, 0.0, 1.0, 1e6]))
    assert found == pytest.approx([0.0, 1 / (1 + np.e), 0.5, np.e / (1 + np.e), 1.0])
