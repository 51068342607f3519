"""Our heads on MoveNet's trunk: what they begin with, what learns, and trunks between two."""

from typing import Any

import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from viewer.landmarks.keypoint_layouts import POINT

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def network() -> Any:
    from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks
    from lab.landmark_lessons.movenet_start import movenet

    return MovenetLandmarks(movenet())


@pytest.fixture
def planes() -> Any:
    """Two windows of noise as the network takes them; the silhouette of the second is not known."""
    noise = torch.rand(2, 4, 192, 192, generator=torch.Generator().manual_seed(3)) * 255
    noise[1, 3] = 128
    return noise


def test_maps_begin_as_those_of_the_points_of_photographs(network: Any, planes: Any) -> None:
    with torch.no_grad():
        maps, told, mask = network(planes)
        heat = network.photographed(planes[:, [2, 1, 0]].contiguous()).heat
    assert maps.shape == (2, 15, 48, 48)
    assert told.shape == (2, 16 + 1 + 15)
    assert mask.shape == (2, 48, 48)
    for name in ("l_wrist", "r_ankle"):
        torch.testing.assert_close(maps[:, JOINT_NAMES.index(name)], heat[:, POINT[name]])
    hips = heat[:, POINT["l_hip"]] + heat[:, POINT["r_hip"]]
    torch.testing.assert_close(maps[:, 0], 0.15 * hips / 2)


def names(network: Any, paced: Any) -> set[str]:
    learns = {id(weights) for weights in paced.weights}
    return {name for name, weights in network.named_parameters() if id(weights) in learns}


def test_the_trunk_learns_slowly_is_pulled_back_and_what_is_finest_stays(network: Any) -> None:
    """At a twentieth of the heads' rate; its stem and first three blocks not at all."""
    heads, trunk = names(network, network.heads()), names(network, network.trunk())
    assert not heads & trunk
    stay = {name for name, _ in network.named_parameters()} - heads - trunk
    parts = {name.removeprefix("photographed.").rpartition(".convolution")[0] for name in stay}
    assert {part.split(".")[0] for part in parts} == {"stem", "blocks"}
    assert {part.split(".")[1] for part in parts if part != "stem"} == {"0", "1", "2"}
    assert all(name.startswith("photographed.") for name in trunk)
    assert (network.heads().pace, network.heads().pull) == (1.0, 0.0)
    assert (network.trunk().pace, network.trunk().pull) == (0.05, 0.002)


def test_a_mask_teaches_the_trunk_but_not_the_maps(network: Any, planes: Any) -> None:
    network.requires_grad_(True).zero_grad()
    network(planes)[2].mean().backward()
    assert all(weights.grad is None for weights in network.correction.parameters())
    assert network.photographed.up[2][1].convolution.weight.grad.abs().sum() > 0


def test_only_a_known_silhouette_changes_the_maps(network: Any, planes: Any) -> None:
    """A map is corrected by it once the correction is learnt."""
    other = planes.clone()
    other[0, 3] = 255 - other[0, 3]
    last = network.correction[-1].weight
    with torch.no_grad():
        last.normal_(generator=torch.Generator().manual_seed(1))
        maps, moved = network(planes)[0], network(other)[0]
        last.zero_()
    assert (maps[0] - moved[0]).abs().max() > 1e-3
    torch.testing.assert_close(maps[1], moved[1])


@pytest.mark.parametrize(("share", "due"), [(0.0, 1.0), (0.25, 1.5), (1.0, 3.0)])
def test_a_trunk_between_two_has_weights_between_theirs_and_the_heads_of_one(
    network: Any, share: float, due: float
) -> None:
    from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks, between
    from lab.landmark_lessons.movenet_layers import MoveNet

    learnt, published = MovenetLandmarks(MoveNet()), MoveNet()
    for part, value in ((learnt, 3.0), (published, 1.0)):
        for weights in part.parameters():
            torch.nn.init.constant_(weights, value)
    found = between(learnt, published, share)
    assert all((weights == due).all() for weights in found.photographed.parameters())
    assert all((weights == 3.0).all() for weights in found.heads().weights)
    assert np.all([(weights == 3.0).all() for weights in learnt.parameters()])
