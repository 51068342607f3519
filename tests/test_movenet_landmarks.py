"""Our heads on MoveNet's trunk: what they begin with, and that the trunk stays."""

from typing import Any

import pytest

from common.body.body import JOINT_NAMES
from viewer.landmarks.keypoint_layouts import POINT

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")


@pytest.fixture(scope="module")
def network() -> Any:
    from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks
    from lab.landmark_lessons.movenet_start import movenet

    return MovenetLandmarks(movenet())


@pytest.fixture
def planes() -> Any:
    """Two windows of noise as the network takes them."""
    return torch.rand(2, 4, 192, 192, generator=torch.Generator().manual_seed(3)) * 4 - 2


def test_maps_begin_as_those_of_the_points_of_photographs(network: Any, planes: Any) -> None:
    with torch.no_grad():
        maps, told = network(planes)
        colours = (planes[:, [2, 1, 0]] * 64 + 128).contiguous()
        heat = network.photographed(colours).heat
    assert maps.shape == (2, 15, 48, 48)
    assert told.shape == (2, 16 + 1 + 15)
    for name in ("l_wrist", "r_ankle"):
        torch.testing.assert_close(maps[:, JOINT_NAMES.index(name)], heat[:, POINT[name]])
    hips = heat[:, POINT["l_hip"]] + heat[:, POINT["r_hip"]]
    torch.testing.assert_close(maps[:, 0], 0.15 * hips / 2)


def test_the_trunk_learns_nothing(network: Any, planes: Any) -> None:
    maps, told = network.train()(planes)
    (maps.mean() + told.mean()).backward()
    assert all(each.grad is None for each in network.photographed.parameters())
    learns = {id(each) for part in network.paces() for each in part.weights}
    heads = {id(each) for each in network.parameters() if each.requires_grad}
    assert learns == heads
