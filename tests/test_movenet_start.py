"""MoveNet's layers and weights: what photographs taught, in our own layers."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from synth.picture.picture_examples import SIDE_PX, PictureExample, picture_examples
from viewer.landmarks.keypoint_layouts import POINT

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")

pytestmark = pytest.mark.slow
SHARED = [name for name in JOINT_NAMES if name in POINT]
"""Joints of ours that are points of COCO too."""


@pytest.fixture(scope="module")
def network() -> Any:
    from lab.landmark_lessons.movenet_start import movenet

    return movenet()


def before_grey(example: PictureExample) -> Any:
    """A drawn person before a grey wall, as MoveNet takes it, (1, 3, 192, 192)."""
    body, coverage = np.split(example.body.astype(np.float32), (3,), axis=2)
    picture = torch.from_numpy(body + 120.0 * (1.0 - coverage / 255.0)).permute(2, 0, 1)[None]
    return torch.nn.functional.interpolate(picture, (192, 192), mode="bilinear").flip(1)


def test_joints_of_drawn_people_are_seen_where_they_were_drawn(network: Any) -> None:
    """It never saw a drawing; left and right are the person's own."""
    off = []
    for example in picture_examples(61_002):
        with torch.no_grad():
            heat = network(before_grey(example)).heat[0]
        best = heat.flatten(1).argmax(1).numpy()
        places = np.stack([best % 48, best // 48], 1) + 0.5
        for name in SHARED:
            true = example.joints_px[JOINT_NAMES.index(name)] * 48 / SIDE_PX
            off.append(np.linalg.norm(places[POINT[name]] - true) * SIDE_PX / 48)
        off[-len(SHARED) :] = [each / example.stature_px for each in off[-len(SHARED) :]]
    assert np.median(off) < 0.07
    assert np.mean(np.array(off) < 0.1) > 0.6


def test_any_multiple_of_32_pixels_is_a_window(network: Any) -> None:
    with torch.no_grad():
        seen = network(torch.zeros(2, 3, 160, 224))
    assert seen.heat.shape == (2, 17, 40, 56)
    assert seen.deep.shape == (2, 1280, 5, 7)


def test_an_even_side_is_padded_at_its_end_alone() -> None:
    """As TensorFlow does: of four cells the first window begins in the first cell."""
    from lab.landmark_lessons.movenet_layers import Step

    step = Step(1, 1, 3, 2)
    with torch.no_grad():
        step.convolution.weight.fill_(1.0)
        step.convolution.bias.zero_()
        found = step(torch.arange(16.0).reshape(1, 1, 4, 4))
    by_hand = [
        [0 + 1 + 2 + 4 + 5 + 6 + 8 + 9 + 10, 2 + 3 + 6 + 7 + 10 + 11],
        [8 + 9 + 10 + 12 + 13 + 14, 10 + 11 + 14 + 15],
    ]
    assert found[0, 0].tolist() == by_hand


def published(folder: Path, values: list[float], missing: int = 0) -> Path:
    """A file of TensorFlow.js with two arrays."""
    held = np.array(values, np.float16).tobytes()
    (folder / "weights.bin").write_bytes(held[: len(held) - missing])
    half = {"quantization": {"dtype": "float16"}}
    weights = [
        {"name": "a/kernel", "shape": [2, 2], "dtype": "float32", **half},
        {"name": "a/bias", "shape": [1], "dtype": "float32", **half},
    ]
    model = folder / "model.json"
    model.write_text(
        json.dumps({"weightsManifest": [{"paths": ["weights.bin"], "weights": weights}]})
    )
    return model


def test_published_arrays_lie_one_after_another(tmp_path: Path) -> None:
    from lab.landmark_lessons.movenet_start import published_weights

    found = published_weights(published(tmp_path, [1, 2, 3, 4, 5]))
    assert found["a/kernel"].tolist() == [[1, 2], [3, 4]]
    assert found["a/bias"].tolist() == [5]


def test_a_cut_file_of_weights_is_refused(tmp_path: Path) -> None:
    from lab.landmark_lessons.movenet_start import published_weights

    with pytest.raises(ValueError, match=r"model\.json: 12 bytes of weights, 10 expected"):
        published_weights(published(tmp_path, [1, 2, 3, 4, 5, 6]))
    with pytest.raises(ValueError, match="8 bytes of weights, 10 expected"):
        published_weights(published(tmp_path, [1, 2, 3, 4, 5], missing=2))
