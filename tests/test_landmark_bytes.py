"""A network in bytes sees nearly what the whole one sees, and its weights can be learnt on from."""

from pathlib import Path

import numpy as np
import pytest

from viewer.landmarks.landmark_looks import opened

torch = pytest.importorskip("torch", reason="the extra `train` is not installed")
pytest.importorskip("onnx", reason="the extra `train` is not installed")

pytestmark = pytest.mark.slow


def test_a_network_in_bytes_sees_nearly_the_same_in_half_the_space(tmp_path: Path) -> None:
    from lab.landmark_lessons.landmark_bytes import write_in_bytes
    from lab.landmark_lessons.landmark_file import weights_of, write_network
    from lab.landmark_lessons.movenet_landmarks import MovenetLandmarks
    from lab.landmark_lessons.movenet_start import movenet

    whole, small = tmp_path / "whole.onnx", tmp_path / "small.onnx"
    write_network(MovenetLandmarks(movenet()), whole)
    rng = np.random.default_rng(5)
    coarse = rng.integers(0, 256, (6, 1, 4, 24, 24)).astype(np.uint8)
    windows = list(coarse.repeat(8, axis=3).repeat(8, axis=4))
    write_in_bytes(whole, windows[:4], small)
    assert small.stat().st_size < 0.4 * whole.stat().st_size
    for planes in windows[4:]:
        maps = [opened(each).run(["maps"], {"planes": planes})[0] for each in (whole, small)]
        assert np.corrcoef(maps[0].ravel(), maps[1].ravel())[0, 1] > 0.98
        assert len(np.unique(maps[1])) > 256, "what no layer in bytes reads is not rounded"
    exact, rounded = weights_of(whole), weights_of(small)
    assert exact.keys() == rounded.keys()
    for name, (weight, _) in exact.items():
        most = np.abs(weight.reshape(len(weight), -1)).max(axis=1)
        off = np.abs(weight - rounded[name][0]).reshape(len(weight), -1).max(axis=1)
        assert (off <= 0.51 * most / 127).all(), "half of a byte's step, of each channel"
