"""The network that detects people: MoveNet MultiPose's published graph, cut and in bytes.

`viewer/people/people.onnx` holds it (Copyright Google LLC, Apache License 2.0, see NOTICE);
`docs/models.md` says where it was taken from. To write it again:

    python -m lab.landmark_lessons.multipose_file movenet-multipose.json people.onnx
"""

import base64
import json
import sys
import tempfile
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any, Final

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import NodeProto, TensorProto, helper, numpy_helper

from lab.landmark_lessons.landmark_bytes import as_bytes
from lab.landmark_lessons.movenet_start import Arrays, published_weights
from synth.picture.backdrops import backdrop
from synth.picture.composites import composite
from synth.picture.picture_examples import picture_examples

HEADS: Final = {
    "centre": "center_0/conv2d_4/BiasAdd",
    "size": "box_scale_0/conv2d_5/BiasAdd",
    "offset": "box_offset_0/conv2d_6/BiasAdd",
    "joints": "kpt_regress_0/conv2d_8/BiasAdd",
}
"""Our names of the outputs, and how the published ones end. What refines joints is left out."""
STEM: Final = "Conv1_relu/Relu6"
OPSET: Final = 18
SHOWN: Final = 60
"""Number of pictures that give the ranges of activations."""
FIRST: Final = 7_100_000
"""Seed of the first of them; no test and no figure uses its people."""
HIGH, WIDE = 192, 256


class _Graph:
    """A graph of ONNX, channels first, that grows from the heads backwards."""

    def __init__(self, model: Path) -> None:
        topology = json.loads(model.read_text())["modelTopology"]
        self.published = {node["name"]: node for node in topology["node"]}
        self.weights = published_weights(model)
        self.nodes: list[NodeProto] = []
        self.held: Arrays = {"zero": _float(0.0), "six": _float(6.0), "twice": _float(1, 1, 2, 2)}
        self.done: dict[str, str] = {}

    def output_of(self, name: str) -> str:
        """Our name of what a published node gives."""
        if name in self.done:
            return self.done[name]
        ours, kind = f"n{len(self.done)}", self.published[name]["op"]
        self.done[name] = ours
        taken = [each.split(":")[0] for each in self.published[name]["input"]]
        if "Conv2D" in kind or "epthwise" in kind:
            self._convolution(name, ours, taken)
        elif kind == "AddV2":
            self._add("Add", [self.output_of(each) for each in taken], ours)
        elif kind == "ResizeBilinear":
            given = [self.output_of(taken[0]), "", "twice"]
            self._add("Resize", given, ours, mode="linear")
        else:
            raise ValueError(f"{name} is a {kind}, which is not known here")
        return ours

    def _convolution(self, name: str, ours: str, taken: list[str]) -> None:
        is_apart = "epthwise" in self.published[name]["op"]
        kernel = self.weights[taken[1]].transpose((2, 3, 0, 1) if is_apart else (3, 2, 0, 1))
        shown = "scaled" if name.endswith(STEM) else self.output_of(taken[0])
        if name.endswith(STEM):
            kernel = kernel[:, ::-1]  # our pictures have blue first
        self.held[f"{ours}.weight"] = np.ascontiguousarray(kernel, np.float32)
        given, fused = [shown, f"{ours}.weight"], self._fused(name)
        if "BiasAdd" in fused:
            self.held[f"{ours}.bias"] = self.weights[taken[2]].astype(np.float32).ravel()
            given.append(f"{ours}.bias")
        last = ours if set(fused) <= {"BiasAdd"} else f"{ours}.sum"
        down = int(self.published[name]["attr"]["strides"]["list"]["i"][1])
        group = len(kernel) if is_apart else 1
        self._add(
            "Conv", given, last, auto_pad="SAME_UPPER", strides=[down, down], group=group, name=ours
        )
        if "Relu6" in fused:
            self._add("Clip", [last, "zero", "six"], ours)
        elif "Relu" in fused:
            self._add("Relu", [last], ours)

    def _fused(self, name: str) -> list[str]:
        """What a published convolution does with its sums."""
        named = self.published[name]["attr"].get("fused_ops", {}).get("list", {}).get("s", [])
        return [base64.b64decode(each).decode() for each in named]

    def _add(self, kind: str, taken: list[str], given: str, **attributes: Any) -> None:
        self.nodes.append(helper.make_node(kind, taken, [given], **attributes))


def write_whole(model: Path, out: Path) -> None:
    """Write the published network from a picture to its heads.

    Args:
        model: Its graph, JSON of TensorFlow.js, beside its file of weights.
        out: The file to write, ONNX. It takes a picture (1, H, W, 3), blue, green, red, sides
            multiples of 32, and gives HEADS, (1, n, H / 4, W / 4).

    Raises:
        ValueError: For a graph with other layers.
    """
    graph = _Graph(model)
    graph.held |= {"half": _float(127.5)}
    graph.nodes += [
        helper.make_node("Cast", ["picture"], ["values"], to=TensorProto.FLOAT),
        helper.make_node("Transpose", ["values"], ["planes"], perm=[0, 3, 1, 2]),
        helper.make_node("Sub", ["planes", "half"], ["centred"]),
        helper.make_node("Div", ["centred", "half"], ["scaled"]),
    ]
    for ours, end in HEADS.items():
        (name,) = (each for each in graph.published if each.endswith(end))
        graph.nodes.append(helper.make_node("Identity", [graph.output_of(name)], [ours]))
    taken = helper.make_tensor_value_info("picture", TensorProto.UINT8, [1, "high", "wide", 3])
    outputs = [helper.make_tensor_value_info(each, TensorProto.FLOAT, None) for each in HEADS]
    held = [numpy_helper.from_array(np.asarray(each), name) for name, each in graph.held.items()]
    made = helper.make_graph(graph.nodes, "people", [taken], outputs, held)
    network = helper.make_model(made, opset_imports=[helper.make_opsetid("", OPSET)])
    network.ir_version = 9
    onnx.save(network, out)


def write_people_network(model: Path, out: Path) -> None:
    """Write the published network in bytes.

    Args:
        model: As in `write_whole`.
        out: The file to write.
    """
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "whole.onnx"
        write_whole(model, whole)
        as_bytes(whole, ({"picture": each} for each in _shown()), out, ())


def _shown() -> Iterator[NDArray[np.uint8]]:
    """Pictures (1, HIGH, WIDE, 3) of two synthetic people beside each other, black below."""
    for seed in range(FIRST, FIRST + SHOWN):
        held = np.hstack([_composite(seed, place) for place in range(2)])
        picture = np.zeros((1, HIGH, WIDE, 3), np.uint8)
        picture[0, : held.shape[0], : held.shape[1]] = held
        yield picture


def _composite(seed: int, place: int) -> NDArray[np.uint8]:
    """(h, w, 3) a person before a backdrop, perhaps with another."""
    examples = list(islice(picture_examples(seed), place, place + 2))
    rng = np.random.default_rng([seed, place])
    return composite(examples[0], lambda: examples[-1], lambda: backdrop(seed), rng).picture


def _float(*values: float) -> NDArray[np.float32]:
    """One number, or several in a row."""
    return np.array(values if len(values) > 1 else values[0], np.float32)


if __name__ == "__main__":
    write_people_network(Path(sys.argv[1]), Path(sys.argv[2]))
