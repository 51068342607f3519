"""The file of the network of landmarks: weights into one, and out of one."""

from pathlib import Path
from typing import Final

import numpy as np
import onnx
import torch
from numpy.typing import NDArray
from onnx import numpy_helper
from torch import nn

from lab.landmark_lessons.landmark_layers import LandmarkNetwork
from lab.landmark_lessons.landmark_planes import STEP
from viewer.landmarks.landmark_window import GREY, PLANES, SIDE

WEIGHT: Final = ".weight"
"""How a file ends the name of a layer's weights."""


class _OfBytes(nn.Module):
    """The network as the viewer asks it: by bytes."""

    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network = network

    def forward(self, planes: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        found: tuple[torch.Tensor, torch.Tensor] = self.network((planes.float() - GREY) / STEP)
        return found


def write_network(network: nn.Module, out: Path) -> None:
    """Write a trained network as the viewer runs it, ONNX, normalisations folded into layers."""
    torch.onnx.export(
        _OfBytes(network).eval(),
        (torch.zeros(1, PLANES, SIDE, SIDE, dtype=torch.uint8),),
        str(out),
        input_names=["planes"],
        output_names=["maps", "told"],
        external_data=False,
        verbose=False,
    )


Weights = dict[str, tuple[NDArray[np.float32], NDArray[np.float32]]]
"""Weights and offsets of layers, by their names in the network."""


def weights_of(file: Path) -> Weights:
    """What a file of ours holds."""
    graph = onnx.load(file).graph
    held = {each.name: numpy_helper.to_array(each) for each in graph.initializer}
    layers = [node.input for node in graph.node if node.op_type in {"Conv", "Gemm"}]
    return {
        weight.removeprefix("network.").removesuffix(WEIGHT): (held[weight], held[offset])
        for _, weight, offset in layers
    }


def fill(network: LandmarkNetwork, weights: Weights) -> None:
    """Give a network the weights of a file, whose normalisations are folded into them: its own
    then change nothing, as long as it is not told to learn them (`eval`).

    Args:
        network: Is changed.
        weights: Of all its layers.
    """
    offset = None
    with torch.no_grad():
        for name, part in network.named_modules():
            if isinstance(part, nn.Conv2d | nn.Linear):
                weight, offset = (torch.from_numpy(np.array(values)) for values in weights[name])
                part.weight.copy_(weight)
                if part.bias is not None:
                    part.bias.copy_(offset)
            elif isinstance(part, nn.BatchNorm2d):
                part.weight.fill_(1.0)
                part.bias.copy_(offset)
                part.running_mean.zero_()
                part.running_var.fill_(1.0 - part.eps)
