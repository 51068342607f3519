"""The published detector of people, cut out of its graph: a small graph of the same kinds."""

import base64
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

onnx = pytest.importorskip("onnx", reason="the extra `train` is not installed")
pytest.importorskip("torch", reason="the extra `train` is not installed")

pytestmark = pytest.mark.slow

STEM = "a/Conv1_relu/Relu6"
RNG = np.random.default_rng(8)
ENDS = (
    "center_0/conv2d_4",
    "box_scale_0/conv2d_5",
    "box_offset_0/conv2d_6",
    "kpt_regress_0/conv2d_8",
)


def text(value: str) -> dict[str, str]:
    return {"s": base64.b64encode(value.encode()).decode()}


def layer(
    name: str, kind: str, taken: list[str], fused: tuple[str, ...] = (), down: int = 1
) -> dict[str, Any]:
    names = {"list": {"s": [text(each)["s"] for each in fused]}}
    strides = {"list": {"i": ["1", str(down), str(down), "1"]}}
    attributes = {"strides": strides, "padding": text("SAME"), "fused_ops": names}
    return {"name": name, "op": kind, "input": taken, "attr": attributes}


@pytest.fixture
def published(tmp_path: Path) -> tuple[Path, dict[str, np.ndarray]]:
    """A stem that halves, a layer apart for each channel, a sum, an enlargement, four heads."""
    weights = {
        "stem/w": RNG.normal(0, 0.3, (3, 3, 3, 4)),
        "stem/b": RNG.normal(0, 0.3, 4),
        "apart/w": RNG.normal(0, 0.3, (3, 3, 4, 1)),
        **{f"{end}/w": RNG.normal(0, 0.3, (1, 1, 4, 2)) for end in ENDS},
    }
    weights = {name: each.astype(np.float32) for name, each in weights.items()}
    nodes = [
        layer(
            "a/Conv1_relu/Relu6",
            "_FusedConv2D",
            ["in", "stem/w", "stem/b"],
            ("BiasAdd", "Relu6"),
            2,
        ),
        layer("apart", "DepthwiseConv2dNative", [STEM, "apart/w"]),
        {"name": "sum", "op": "AddV2", "input": ["apart", f"{STEM}:0"], "attr": {}},
        {"name": "large", "op": "ResizeBilinear", "input": ["sum", "size"], "attr": {}},
        *(layer(f"{end}/BiasAdd", "_FusedConv2D", ["large", f"{end}/w"]) for end in ENDS),
    ]
    listed = [
        {"name": name, "shape": list(each.shape), "dtype": "float32"}
        for name, each in weights.items()
    ]
    graph = {
        "modelTopology": {"node": nodes},
        "weightsManifest": [{"paths": ["small.bin"], "weights": listed}],
    }
    (tmp_path / "small.json").write_text(json.dumps(graph))
    (tmp_path / "small.bin").write_bytes(b"".join(each.tobytes() for each in weights.values()))
    return tmp_path / "small.json", weights


def filtered(planes: np.ndarray, kernel: np.ndarray) -> np.ndarray:
    """(H, W) of planes (H, W, n) by a kernel (3, 3, n), nothing beyond the border."""
    parts = [
        cv2.filter2D(planes[..., n], -1, kernel[..., n], borderType=cv2.BORDER_CONSTANT)
        for n in range(planes.shape[-1])
    ]
    return np.asarray(np.sum(parts, axis=0))


def test_the_cut_network_gives_what_its_layers_make_of_a_picture(
    published: tuple[Path, dict[str, np.ndarray]], tmp_path: Path
) -> None:
    """By OpenCV's filters; the published one takes red first, ours takes blue first."""
    import onnxruntime

    from lab.landmark_lessons.multipose_file import HEADS, write_whole

    model, weights = published
    write_whole(model, tmp_path / "cut.onnx")
    session = onnxruntime.InferenceSession(tmp_path / "cut.onnx")
    picture = RNG.integers(0, 256, (1, 64, 32, 3), np.uint8)
    found = dict(zip(HEADS, session.run(list(HEADS), {"picture": picture}), strict=True))
    shown = (picture[0, ..., ::-1].astype(np.float32) - 127.5) / 127.5
    stem = np.stack([filtered(shown, weights["stem/w"][..., n]) for n in range(4)], axis=-1)
    stem = (stem[1::2, 1::2] + weights["stem/b"]).clip(0.0, 6.0)
    apart = [filtered(stem[..., n : n + 1], weights["apart/w"][..., n, :]) for n in range(4)]
    large = cv2.resize(np.stack(apart, axis=-1) + stem, (32, 64))
    for name, end in zip(HEADS, ENDS, strict=True):
        expected = np.einsum("hwc,cn->nhw", large, weights[f"{end}/w"][0, 0])
        assert found[name][0] == pytest.approx(expected, abs=1e-4)


def test_a_graph_with_another_layer_is_refused(
    published: tuple[Path, dict[str, np.ndarray]], tmp_path: Path
) -> None:
    from lab.landmark_lessons.multipose_file import write_whole

    model, _ = published
    model.write_text(model.read_text().replace("ResizeBilinear", "SpaceToDepth"))
    with pytest.raises(ValueError, match="large is a SpaceToDepth, which is not known here"):
        write_whole(model, tmp_path / "cut.onnx")
