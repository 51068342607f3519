"""The network in bytes tells what it told in numbers of any size."""

from pathlib import Path

import numpy as np
import pytest

from synth.picture.picture_examples import picture_examples
from viewer.landmarks.landmark_looks import SHIPPED, opened
from viewer.landmarks.landmark_network import find
from viewer.landmarks.landmark_window import GREY, PLANES, SIDE, Planes

pytest.importorskip("torch", reason="the extra `train` is not installed")
onnx = pytest.importorskip("onnx", reason="the extra `train` is not installed")


@pytest.fixture(scope="module")
def shown() -> Planes:
    """People before plain grey, with their outlines."""
    seen = [
        np.dstack(
            [
                one.body[..., :3] + ((1 - one.body[..., 3:] / 255) * GREY).astype(np.uint8),
                one.outline * np.uint8(255),
            ]
        ).transpose(2, 0, 1)
        for seed in (61_000, 61_001)
        for one in picture_examples(seed)
    ]
    return np.ascontiguousarray(seen)


@pytest.fixture(scope="module")
def again(shown: Planes, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped network's weights, read back, written and rounded anew."""
    from tritrack.training import landmark_rounding, torch_landmarks

    folder = tmp_path_factory.mktemp("rounded")
    network = torch_landmarks.LandmarkNetwork()
    torch_landmarks.fill(network, landmark_rounding.weights_of(SHIPPED))
    torch_landmarks.export(network, folder / "whole.onnx")
    landmark_rounding.write_rounded(folder / "whole.onnx", shown, folder / "rounded.onnx")
    return folder / "rounded.onnx"


def test_it_takes_bytes_of_which_grey_is_exactly_nought(again: Path) -> None:
    from tritrack.training.torch_landmarks import STEP

    (taken,) = opened(again).get_inputs()
    assert (taken.type, taken.shape) == ("tensor(uint8)", [1, PLANES, SIDE, SIDE])
    graph = onnx.load(again).graph
    held = {each.name: each for each in graph.initializer}
    first = next(node for node in graph.node if "planes" in node.input)
    scale, zero = (onnx.numpy_helper.to_array(held[name]) for name in first.input[1:3])
    assert (float(scale), int(zero)) == (1 / STEP, GREY)


def test_weights_have_seven_bits(again: Path) -> None:
    held = [onnx.numpy_helper.to_array(each) for each in onnx.load(again).graph.initializer]
    weights = [values for values in held if values.dtype == np.int8 and values.ndim > 1]
    assert len(weights) >= 19
    assert max(int(np.abs(values.astype(int)).max()) for values in weights) <= 64


def test_joints_stay_where_they_were(shown: Planes, again: Path) -> None:
    off = [
        np.linalg.norm(find(planes[None]).joints - find(planes[None], again).joints, axis=1)
        for planes in shown
    ]
    assert np.median(off) < 0.3
    assert (np.array(off) < 2.0).mean() > 0.97
