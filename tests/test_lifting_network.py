"""Lifted joints, held against made-up people whom the network was never taught on."""

import numpy as np
import pytest
from numpy.typing import NDArray
from small_network import lifting_network as small

from integrator.proposal import lifting_network
from integrator.proposal.landmark_look import INPUTS, Look
from integrator.proposal.network_weights import shipped_lifting
from integrator.proposal.pose_network import HIPS, OTHER_SIDES
from lab.training.lifting_examples import LiftingExample, lifting_examples

UNTAUGHT = range(900_000, 900_030)
"""Seeds beyond all that are taught."""
SEEN = Look(np.zeros(INPUTS, np.float32), np.array([1.0, 2.0, 3.0]), np.eye(3), False)


def missed_mm(example: LiftingExample) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How far joints are off from the hips' middle, (n, 12), and how surely they are not."""
    memory, off, sure = None, [], []
    for inputs, due in zip(example.inputs, example.due.astype(np.float64), strict=True):
        seen = Look(inputs, np.zeros(3), np.eye(3), False)
        memory, found = lifting_network.step(shipped_lifting(), memory, seen, 1.0)
        joints = found.joints_m - found.joints_m[HIPS].mean(axis=0)
        off.append(np.linalg.norm(joints - due[:36].reshape(-1, 3), axis=1))
        sure.append(found.confidence)
    return 1e3 * example.stature_m * np.array(off), np.array(sure)


@pytest.fixture(scope="module")
def untaught() -> list[LiftingExample]:
    return [one for seed in UNTAUGHT for one in lifting_examples(seed)]


@pytest.mark.parametrize(("views", "median_mm"), [(1, 70.0), (2, 50.0)])
def test_untaught_people_are_lifted(
    untaught: list[LiftingExample], views: int, median_mm: float
) -> None:
    """Who walks, stands, moves as they like and falls, by landmarks as wrong as real ones are; the
    mean pose of all is 250 mm off."""
    shown = [one for one in untaught if (one.inputs[:, -1] > 0).any() == (views == 2)]
    off_mm = [np.median(missed_mm(one)[0]) for one in shown]
    assert len(shown) > 10
    assert np.median(off_mm) < median_mm


def test_surer_joints_are_nearer(untaught: list[LiftingExample]) -> None:
    """What it says of itself: of joints it gives 8 in 10 or more, as many are nearer than 50 mm."""
    pairs = [missed_mm(one) for one in untaught]
    off_mm = np.concatenate([off.ravel() for off, _ in pairs])
    sure = np.concatenate([sure.ravel() for _, sure in pairs])
    near = off_mm < 50.0
    assert near[sure > 0.8].mean() > 0.75
    assert near[sure < 0.2].mean() < 0.3


def test_what_is_said_is_statures_in_the_frame_of_the_look() -> None:
    """What `aimed` asks for, said by the last bias, is placed where the joints were."""
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    seen = SEEN._replace(turn=turn)
    joints_m = np.random.default_rng(1).normal(size=(12, 3))
    told = small()
    told.out_bias[:39] = lifting_network.aimed(joints_m, seen, 1.6)
    _, found = lifting_network.step(told, None, seen, 1.6)
    assert found.joints_m == pytest.approx(joints_m, abs=1e-6)
    assert found.confidence == pytest.approx(np.full(12, 0.5))


def test_in_a_mirror_left_is_right() -> None:
    seen = SEEN._replace(mirrored=True, turn=np.diag([-1.0, 1.0, 1.0]))
    joints_m = np.random.default_rng(2).normal(size=(12, 3))
    told = small()
    told.out_bias[:39] = lifting_network.aimed(joints_m, seen, 1.75)
    told.out_bias[39] = 3.0
    _, found = lifting_network.step(told, None, seen, 1.75)
    assert found.joints_m == pytest.approx(joints_m, abs=1e-6)
    assert found.confidence.argmax() == np.arange(12)[OTHER_SIDES][0]
