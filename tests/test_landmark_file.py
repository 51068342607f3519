"""The file of the network of landmarks says what the network says, and gives its weights back."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from synth.picture.picture_examples import picture_examples
from viewer.landmarks.landmark_looks import SHIPPED, opened
from viewer.landmarks.landmark_window import PLANES, SIDE, planes_of, whole

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


def test_the_weights_of_the_shipped_file_say_nearly_what_the_file_says_in_bytes() -> None:
    """Of drawn people on black: a network is learnt on from these."""
    from lab.landmark_lessons.landmark_file import fill, weights_of
    from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks
    from lab.landmark_lessons.movenet_layers import MoveNet

    shipped = MovenetLandmarks(MoveNet())
    fill(shipped, weights_of(SHIPPED))
    for one in [*picture_examples(61_000)][:4]:
        picture = np.ascontiguousarray(one.body[..., :3])
        planes = planes_of(picture, one.outline > 0, whole(picture.shape))
        with torch.no_grad():
            due = shipped(torch.from_numpy(planes).float())
        for own, other in zip(due, opened(SHIPPED).run(None, {"planes": planes}), strict=True):
            assert np.corrcoef(own.numpy().ravel(), other.ravel())[0, 1] > 0.95
