"""A network of landmarks in bytes: weights by channel, activations by their range on pictures.

Layers that see colours at their finest, the end of the way up and the heads stay whole: in bytes
they cost MoveNet Lightning 1.5 points of 70 on photographs, and bought no time (`docs/models.md`).
What lies between no two layers in bytes stays whole too: rounding there costs time and accuracy.
"""

import tempfile
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Final

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import GraphProto, NodeProto
from torch import nn

from lab.landmark_lessons.landmark_file import WEIGHT, write_network
from lab.landmark_lessons.landmark_planes import windows_of
from synth.picture.composites import Composite
from viewer.landmarks.landmark_window import Planes

FINEST: Final = ("stem.", "blocks.0.", "up.2.")
HEADS: Final = ("heat.", "correction.", "nearest.", "summed.", "told.", "mask.")
WHOLE: Final = FINEST + HEADS
"""Parts of `MovenetLandmarks` whose layers stay whole."""
LAYERS: Final = frozenset({"Conv", "Gemm"})

Inputs = Mapping[str, NDArray[np.generic]]
"""What a network takes at once, by name."""


class _Inputs:
    """Inputs of a network, one after another: a CalibrationDataReader."""

    def __init__(self, inputs: Iterable[Inputs]) -> None:
        self.rest = iter(inputs)

    def get_next(self) -> Inputs | None:
        """The next, or None after the last."""
        return next(self.rest, None)


def write_both(network: nn.Module, shown: list[Composite], folder: Path, out: Path) -> None:
    """Write a trained network whole, and in bytes.

    Args:
        network: Is written as it is.
        shown: Any people; the ranges of activations are theirs.
        folder: Keeps the whole network, `whole.onnx`.
        out: The file to write, in bytes.
    """
    whole = folder / "whole.onnx"
    write_network(network, whole)
    write_in_bytes(whole, windows_of(shown), out)


def write_in_bytes(
    source: Path, windows: Iterable[Planes], out: Path, whole: Collection[str] = WHOLE
) -> None:
    """Write a network of landmarks in bytes.

    Args:
        source: What `write_network` wrote.
        windows: (1, PLANES, SIDE, SIDE) each, of any people; the ranges of activations are theirs,
            turned by each quarter: the viewer looks at people upside down too.
        out: The file to write.
        whole: Names of parts that stay as they are.
    """
    as_bytes(source, ({"planes": each} for each in _all_ways_up(windows)), out, whole)


def as_bytes(source: Path, inputs: Iterable[Inputs], out: Path, whole: Collection[str]) -> None:
    """Write a network in bytes.

    Args:
        source: A file of ONNX.
        inputs: Any that are like those to come; the ranges of activations are theirs.
        out: The file to write.
        whole: Names of parts that stay as they are.
    """
    from onnxruntime.quantization import QuantFormat, QuantType, quantize_static
    from onnxruntime.quantization.shape_inference import quant_pre_process

    with tempfile.TemporaryDirectory() as folder:
        prepared = Path(folder) / "prepared.onnx"
        quant_pre_process(source, prepared, skip_symbolic_shape=True)
        left = _kept_whole(onnx.load(prepared).graph, tuple(whole))
        quantize_static(
            prepared,
            out,
            _Inputs(inputs),
            quant_format=QuantFormat.QDQ,
            per_channel=True,
            activation_type=QuantType.QUInt8,
            weight_type=QuantType.QInt8,
            nodes_to_exclude=left,
        )


def _all_ways_up(windows: Iterable[Planes]) -> Iterator[Planes]:
    for planes in windows:
        for quarters in range(4):
            yield np.ascontiguousarray(np.rot90(planes, quarters, axes=(2, 3)))


def _kept_whole(graph: GraphProto, whole: tuple[str, ...]) -> list[str]:
    """The names of nodes that stay whole: layers of such parts, and what lies between no two
    others."""
    in_bytes = {
        node.name for node in graph.node if node.op_type in LAYERS and not _is_layer_of(node, whole)
    }
    behind: set[str] = set()
    ahead: set[str] = set()
    for node in graph.node:
        if node.name in in_bytes or behind.intersection(node.input):
            behind.update(node.output)
    for node in reversed(graph.node):
        if node.name in in_bytes or ahead.intersection(node.output):
            ahead.update(node.input)
    return [
        node.name
        for node in graph.node
        if node.name not in in_bytes
        and (
            node.op_type in LAYERS or behind.isdisjoint(node.input) or ahead.isdisjoint(node.output)
        )
    ]


def _is_layer_of(node: NodeProto, parts: tuple[str, ...]) -> bool:
    weights = [name for name in node.input if name.endswith(WEIGHT)]
    own = [name.removeprefix("network.").removeprefix("photographed.") for name in weights]
    return any(name.startswith(parts) for name in own)
