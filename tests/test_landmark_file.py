"""The file of the network of landmarks says what the network says, and gives its weights back."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from viewer.landmarks.landmark_looks import opened
from viewer.landmarks.landmark_window import PLANES, SIDE

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")
pytest.importorskip("onnx", reason="the extra `train` is not installed")
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def network() -> Any:
    """Heads that say something on the published trunk."""
    from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks
    from lab.landmark_lessons.movenet_start import movenet

    torch.manual_seed(5)
    found = MovenetLandmarks(movenet())
    torch.nn.init.normal_(found.correction[-1].weight, 0.0, 0.1)
    return found.eval()


@pytest.fixture(scope="module")
def file(network: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    from lab.landmark_lessons.landmark_file import write_network

    out = tmp_path_factory.mktemp("file") / "network.onnx"
    write_network(network, out)
    return out


def window() -> np.ndarray:
    """Coarse noise in bytes."""
    coarse = np.random.default_rng(5).integers(0, 256, (1, PLANES, 24, 24)).astype(np.uint8)
    return coarse.repeat(8, axis=2).repeat(8, axis=3)


def test_a_file_takes_bytes_and_says_what_its_network_says(network: Any, file: Path) -> None:
    session = opened(file)
    (taken,) = session.get_inputs()
    assert (taken.type, taken.shape) == ("tensor(uint8)", [1, PLANES, SIDE, SIDE])
    assert [each.name for each in session.get_outputs()] == ["maps", "told", "mask"]
    with torch.no_grad():
        due = network(torch.from_numpy(window()).float())
    for own, other in zip(due, session.run(None, {"planes": window()}), strict=True):
        assert np.allclose(own.numpy(), other, rtol=1e-3, atol=1e-3)


def test_a_file_gives_all_weights_back(network: Any, file: Path) -> None:
    from lab.landmark_lessons.landmark_file import fill, weights_of
    from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks
    from lab.landmark_lessons.movenet_layers import MoveNet

    again = MovenetLandmarks(MoveNet())
    fill(again, weights_of(file))
    for own, other in zip(network.parameters(), again.parameters(), strict=True):
        torch.testing.assert_close(own, other)
