"""The file of the network of landmarks: weights into one, and out of one."""

from pathlib import Path
from typing import Final

import numpy as np
import onnx
import torch
from numpy.typing import NDArray
from onnx import GraphProto, numpy_helper
from torch import nn

from viewer.landmarks.landmark_window import PLANES, SIDE

WEIGHT: Final = ".weight"
"""How a file ends the name of a layer's weights."""
OUTPUTS: Final = ("maps", "told", "mask")


class _OfBytes(nn.Module):
    """The network as the viewer asks it: by bytes."""

    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network = network

    def forward(self, planes: torch.Tensor) -> tuple[torch.Tensor, ...]:
        found: tuple[torch.Tensor, ...] = self.network(planes.float())
        return found


def write_network(network: nn.Module, out: Path) -> None:
    """Write a trained network as the viewer runs it, ONNX."""
    torch.onnx.export(
        _OfBytes(network).eval(),
        (torch.zeros(1, PLANES, SIDE, SIDE, dtype=torch.uint8),),
        str(out),
        input_names=["planes"],
        output_names=list(OUTPUTS),
        external_data=False,
        verbose=False,
    )


Weights = dict[str, tuple[NDArray[np.float32], NDArray[np.float32]]]
"""Weights and offsets of layers, by their names in the network."""


def weights_of(file: Path) -> Weights:
    """What a file of ours holds, which leaves out offsets that are 0; of one in bytes, what its
    bytes stand for."""
    graph = onnx.load(file).graph
    held = {each.name: numpy_helper.to_array(each) for each in graph.initializer}
    held |= _unpacked(graph, held)
    found = {}
    for node in graph.node:
        if node.op_type in {"Conv", "Gemm"}:
            weight, *offset = (held[name] for name in node.input[1:])
            zeros = np.zeros(len(weight), np.float32)
            found[_layer(node.input[1])] = weight, offset[0] if offset else zeros
    return found


def _layer(weight: str) -> str:
    """A layer by the name of its weights."""
    return weight.removeprefix("network.").partition(WEIGHT)[0]


def _unpacked(
    graph: GraphProto, held: dict[str, NDArray[np.generic]]
) -> dict[str, NDArray[np.float32]]:
    """Weights and offsets in bytes as numbers, each output channel by its own scale."""
    found = {}
    for node in graph.node:
        if node.op_type == "DequantizeLinear" and node.input[0] in held:
            packed, scale, zero = (held[name].astype(np.float32) for name in node.input)
            aside = [-1] + [1] * (packed.ndim - 1)
            found[node.output[0]] = (packed - zero.reshape(aside)) * scale.reshape(aside)
    return found


def fill(network: nn.Module, weights: Weights) -> None:
    """Give a network the weights of a file.

    Args:
        network: Is changed.
        weights: Of all its layers.
    """
    with torch.no_grad():
        for name, part in network.named_modules():
            if isinstance(part, nn.Conv2d | nn.Linear):
                weight, offset = (torch.from_numpy(np.array(values)) for values in weights[name])
                part.weight.copy_(weight)
                part.bias.copy_(offset)
