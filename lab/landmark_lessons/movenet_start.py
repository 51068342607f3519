"""MoveNet's weights: out of the published files, and into our layers.

`movenet_lightning.npz` holds those of Lightning (Copyright Google LLC, Apache License 2.0, see
NOTICE), in the order of our layers, as the numbers of half the length that were published.
`docs/models.md` says where they were taken from. To take them out again:

    python -m lab.landmark_lessons.movenet_start movenet-lightning.json movenet_lightning.npz
"""

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from numpy.typing import NDArray

from lab.landmark_lessons.movenet_layers import MoveNet

LIGHTNING: Final = Path(__file__).with_name("movenet_lightning.npz")
Arrays = dict[str, NDArray[np.generic]]
"""By name."""


def movenet(start: Path = LIGHTNING, width: float = 1.0) -> MoveNet:
    """The network as photographs taught it, ready to be asked.

    Args:
        start: What `take_out` wrote.
        width: Of its trunk.
    """
    network = MoveNet(width)
    with np.load(start) as held:
        weights = {name: torch.from_numpy(held[name].astype(np.float32)) for name in held.files}
    network.load_state_dict(weights)
    return network.eval()


def take_out(model: Path, out: Path) -> None:
    """Write the weights of a published network.

    Args:
        model: Its graph, JSON of TensorFlow.js, beside its files of weights.
        out: The file to write, npz.
    """
    published = published_weights(model)
    taken: Arrays = {}
    for layer, weight, offset in _names():
        kernel = _only(published, weight)
        is_apart = "epthwise" in weight or weight.endswith("separable_conv2d/ReadVariableOp")
        order = (2, 3, 0, 1) if is_apart else (3, 2, 0, 1)
        taken[f"{layer}.convolution.weight"] = kernel.transpose(order)
        zeros = np.zeros(len(taken[f"{layer}.convolution.weight"]), kernel.dtype)
        taken[f"{layer}.convolution.bias"] = _only(published, offset) if offset else zeros
    np.savez_compressed(out, **taken)  # type: ignore[arg-type]


def published_weights(model: Path) -> Arrays:
    """All arrays of a network of TensorFlow.js.

    Raises:
        ValueError: When a file of weights is longer or shorter than the graph says.
    """
    manifest = json.loads(model.read_text())["weightsManifest"]
    found: Arrays = {}
    for group in manifest:
        held, at = b"".join((model.parent / path).read_bytes() for path in group["paths"]), 0
        kinds = [np.dtype(each.get("quantization", each)["dtype"]) for each in group["weights"]]
        counts = [math.prod(each["shape"]) for each in group["weights"]]
        due = sum(n * kind.itemsize for n, kind in zip(counts, kinds, strict=True))
        if due != len(held):
            raise ValueError(f"{model}: {len(held)} bytes of weights, {due} expected")
        for each, kind, count in zip(group["weights"], kinds, counts, strict=True):
            found[each["name"]] = np.frombuffer(held, kind, count, at).reshape(each["shape"])
            at += count * kind.itemsize
    return found


def _names() -> Iterator[tuple[str, str, str]]:
    """Of each of our layers: its name, and how the published names of its weights and of its
    offsets end; of no offsets, nothing."""
    for ours, theirs in _trunk():
        yield ours, f"{theirs}_weights", f"{theirs}_bn_offset"
    for at, name in enumerate(("conv2d", "conv2d_1", "conv2d_2", "conv2d_3")):
        layer = f"model_1/{name}"
        yield f"asides.{at}", f"{layer}/Conv2D/ReadVariableOp", f"{layer}/BiasAdd/ReadVariableOp"
    for at, name in enumerate(("separable_conv2d", "separable_conv2d_1", "separable_conv2d_2")):
        layer = f"model_1/{name}/separable_conv2d"
        yield f"up.{at}.0", f"{layer}/ReadVariableOp", ""
        yield f"up.{at}.1", f"{layer}_weights", f"{layer}_bn_offset"
    head = "kpt_heatmap_0/separable_conv2d_4"
    yield "heat.0", f"{head}/separable_conv2d/ReadVariableOp", ""
    yield "heat.1", f"{head}/separable_conv2d/ReadVariableOp_1", f"{head}/BiasAdd/ReadVariableOp"
    last = "kpt_heatmap_0/conv2d_5"
    yield "heat.2", f"{last}/Conv2D/ReadVariableOp", f"{last}/BiasAdd/ReadVariableOp"


def _trunk() -> Iterator[tuple[str, str]]:
    """Of each layer of the trunk: its name, and how the published one goes on."""
    yield "stem", "model/Conv1/Conv2D"
    for at in range(17):
        block = f"model/block_{at}" if at else "model/expanded_conv"
        if at:
            yield f"blocks.{at}.expand", f"{block}_expand/Conv2D"
        yield f"blocks.{at}.depthwise", f"{block}_depthwise/depthwise"
        yield f"blocks.{at}.project", f"{block}_project/Conv2D"
    yield "last", "model/Conv_1/Conv2D"


def _only(arrays: Arrays, end: str) -> Any:
    """The one array whose name ends so."""
    (found,) = (values for name, values in arrays.items() if name.endswith(f"/{end}"))
    return found


if __name__ == "__main__":
    take_out(Path(sys.argv[1]), Path(sys.argv[2]))
