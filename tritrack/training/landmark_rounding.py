"""The network of landmarks in whole numbers of one byte: what is shipped, a third of the time."""

import contextlib
import io
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper
from onnxruntime.quantization import (
    CalibrationDataReader,
    CalibrationMethod,
    QuantFormat,
    QuantType,
    quantize_static,
)
from onnxruntime.quantization.shape_inference import quant_pre_process

from tritrack.training.torch_landmarks import STEP
from viewer.landmarks.landmark_window import GREY, PLANES, SIDE, Planes

KINDS: Final = ("Conv", "Gemm")
"""What has weights."""
WITHIN: Final = 99.999
"""Per cent of what a layer puts out that its range holds."""


class _Shown(CalibrationDataReader):
    """Pictures by which the ranges of all layers are found."""

    def __init__(self, shown: Planes) -> None:
        """Pictures (n, PLANES, SIDE, SIDE)."""
        self._left: Iterator[NDArray[np.uint8]] = iter(shown)

    def get_next(self) -> Any:
        """The next as the network before rounding takes it; None at the end."""
        planes = next(self._left, None)
        if planes is None:
            return None
        return {"planes": ((planes[None] - np.float32(GREY)) / np.float32(STEP)).astype(np.float32)}


def write_rounded(whole: Path, shown: Planes, out: Path) -> None:
    """Write a network that takes bytes, and reckons in them up to what it puts out.

    Weights have seven bits, each unit's their own range: two products of eight would not fit where
    processors without instructions for sums of four add them in sixteen. The layers that put
    out maps and what is told stay whole: they take no time, and facings would suffer.

    Args:
        whole: The network as it was trained (`torch_landmarks.export`).
        shown: (n, PLANES, SIDE, SIDE) pictures of made-up people, by which ranges are found.
        out: The file to write, ONNX.
    """
    with tempfile.TemporaryDirectory(prefix="tritrack-rounding-") as folder:
        plain, rounded = Path(folder) / "plain.onnx", Path(folder) / "rounded.onnx"
        quant_pre_process(whole, plain, skip_symbolic_shape=True)
        graph = onnx.load(plain).graph
        last = {each.name for each in graph.output}
        _rounded(
            plain,
            rounded,
            _Shown(shown),
            quant_format=QuantFormat.QDQ,
            per_channel=True,
            reduce_range=True,
            activation_type=QuantType.QUInt8,
            weight_type=QuantType.QInt8,
            calibrate_method=CalibrationMethod.Percentile,
            extra_options={"CalibPercentile": WITHIN},
            nodes_to_exclude=[node.name for node in graph.node if last & {*node.output}],
        )
        onnx.save(_of_bytes(onnx.load(rounded)), out)


def _rounded(*given: Any, **how: Any) -> None:
    """onnxruntime's own, which prints what it does where a command's answer belongs."""
    with contextlib.redirect_stdout(io.StringIO()):
        quantize_static(*given, **how)


def _of_bytes(model: Any) -> Any:
    """The same network, which is given bytes instead of rounding what it is given to them."""
    graph = model.graph
    asks = next(node for node in graph.node if "planes" in node.input)
    takes = next(node for node in graph.node if asks.output[0] in node.input)
    known = {each.name: each for each in graph.initializer}
    for name, value in ((takes.input[1], np.float32(1 / STEP)), (takes.input[2], np.uint8(GREY))):
        known[name].CopyFrom(numpy_helper.from_array(np.array(value), name))
    takes.input[0] = "planes"
    graph.node.remove(asks)
    shape = (1, PLANES, SIDE, SIDE)
    graph.input[0].CopyFrom(helper.make_tensor_value_info("planes", TensorProto.UINT8, shape))
    return model


def weights_of(rounded: Path) -> list[tuple[NDArray[np.float32], NDArray[np.float32]]]:
    """Weights and offsets of all layers that have some, in their order, of a file of ours."""
    graph = onnx.load(rounded).graph
    held = {each.name: numpy_helper.to_array(each) for each in graph.initializer}
    for node in graph.node:
        if node.op_type == "DequantizeLinear" and node.input[0] in held:
            values, scale, zero = (held[name].astype(np.float32) for name in node.input)
            sides = (-1, *[1] * (values.ndim - 1)) if scale.ndim else ()
            held[node.output[0]] = (values - zero.reshape(sides)) * scale.reshape(sides)
    layers = [node for node in graph.node if node.op_type in KINDS]
    return [(held[node.input[1]], held[node.input[2]]) for node in layers]
