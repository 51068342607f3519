"""The file of the network of landmarks says what the network says, and gives its weights back."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from synth.picture.picture_examples import picture_examples
from viewer.landmarks.landmark_looks import SHIPPED, opened, seen
from viewer.landmarks.landmark_window import GREY, PLANES, SIDE, Planes, planes_of, whole

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")
pytest.importorskip("onnx", reason="the extra `train` is not installed")


@pytest.fixture(scope="module")
def shown() -> Planes:
    """A person before plain grey, with outlines."""
    people = [*picture_examples(61_000)][:4]
    before_grey = [
        one.body[..., :3] + ((1 - one.body[..., 3:] / 255) * GREY).astype(np.uint8)
        for one in people
    ]
    return np.concatenate(
        [
            planes_of(picture, one.outline > 0, whole(picture.shape))
            for picture, one in zip(before_grey, people, strict=True)
        ]
    )


@pytest.fixture(scope="module")
def shipped() -> Any:
    from lab.landmark_lessons.landmark_file import fill, weights_of
    from lab.landmark_lessons.landmark_layers import LandmarkNetwork

    network = LandmarkNetwork()
    fill(network, weights_of(SHIPPED))
    return network.eval()


def test_the_weights_of_the_shipped_file_say_what_the_file_says(
    shown: Planes, shipped: Any
) -> None:
    from lab.landmark_lessons.landmark_planes import STEP

    for planes in shown:
        with torch.no_grad():
            due = shipped((torch.from_numpy(planes[None]).float() - GREY) / STEP)
        for own, other in zip(due, seen(planes[None], SHIPPED), strict=True):
            assert np.allclose(own[0].numpy(), other, rtol=1e-3, atol=1e-2)


def test_a_file_takes_bytes_and_says_what_its_network_says(
    shown: Planes, shipped: Any, tmp_path: Path
) -> None:
    from lab.landmark_lessons.landmark_file import write_network

    write_network(shipped, tmp_path / "again.onnx")
    (taken,) = opened(tmp_path / "again.onnx").get_inputs()
    assert (taken.type, taken.shape) == ("tensor(uint8)", [1, PLANES, SIDE, SIDE])
    for own, other in zip(
        seen(shown[:1], tmp_path / "again.onnx"), seen(shown[:1], SHIPPED), strict=True
    ):
        assert np.allclose(own, other, rtol=1e-3, atol=1e-2)
