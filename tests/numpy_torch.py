"""As much of PyTorch on NumPy arrays as the tests of training need where PyTorch is not installed:
forward passes, and optimisers that only write down what they are asked for."""

import importlib.util
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest


class Tensor(np.ndarray):
    """An array with the methods of a tensor that the losses call."""

    def float(self) -> Any:
        return self.astype(np.float32)

    def detach(self) -> Any:
        return self

    def numpy(self) -> Any:
        return np.asarray(self)

    def clone(self) -> Any:
        return self.copy()

    def copy_(self, other: Any) -> Any:
        self[...] = other
        return self

    def square(self) -> Any:
        return self * self

    def sqrt(self) -> Any:
        return np.sqrt(self)

    def add(self, other: Any) -> Any:
        return self + other

    def unflatten(self, axis: int, sizes: tuple[int, ...]) -> Any:
        assert axis == -1
        return self.reshape(*self.shape[:-1], *sizes)

    def flatten(self, start: int) -> Any:  # type: ignore[override]
        return self.reshape(*self.shape[:start], -1)

    def norm(self, dim: int) -> Any:
        return np.linalg.norm(self, axis=dim).view(Tensor)

    def clamp(self, min: Any = None, max: Any = None) -> Any:
        return np.clip(self, min, max)

    def log(self) -> Any:
        return np.log(self)

    def unbind(self, axis: int) -> list[Any]:
        return [part.view(Tensor) for part in np.moveaxis(self, axis, 0)]

    def split(self, size: int, axis: int) -> list[Any]:
        return np.split(self, range(size, self.shape[axis], size), axis)


def tensor(values: Any) -> Any:
    """A tensor of float32."""
    return np.array(values, np.float32).view(Tensor)


class Linear:
    """A layer with weights drawn once: (outputs, inputs)."""

    def __init__(self, inputs: int, outputs: int) -> None:
        rng = np.random.default_rng([inputs, outputs])
        self.weight = tensor(rng.normal(0.0, 0.4, (outputs, inputs)))
        self.bias = tensor(rng.normal(0.0, 0.4, outputs))

    def parameters(self) -> list[Any]:
        return [self.weight, self.bias]

    def __call__(self, x: Any) -> Any:
        return linear(x, self.weight, self.bias)


class GRU:
    """The weights of a gated recurrent unit, without its loop."""

    def __init__(self, inputs: int, memory: int, batch_first: bool) -> None:
        assert batch_first
        self.hidden_size = memory
        taken, kept = Linear(inputs, 3 * memory), Linear(memory, 3 * memory)
        self.weight_ih_l0, self.bias_ih_l0 = taken.parameters()
        self.weight_hh_l0, self.bias_hh_l0 = kept.parameters()

    def parameters(self) -> list[Any]:
        return [self.weight_ih_l0, self.weight_hh_l0, self.bias_ih_l0, self.bias_hh_l0]


def linear(x: Any, weight: Any, bias: Any) -> Any:
    """As `torch.nn.functional.linear`."""
    return x @ weight.T + bias


def padded(parts: Any, batch_first: bool) -> Any:
    """As `torch.nn.utils.rnn.pad_sequence`: zeros behind what is shorter."""
    assert batch_first
    longest = max(len(part) for part in parts)
    return tensor(
        [np.pad(part, [(0, longest - len(part))] + [(0, 0)] * (part.ndim - 1)) for part in parts]
    )


def binary_cross_entropy(logits: Any, due: Any, reduction: str = "mean") -> Any:
    """As PyTorch's of logits."""
    share = 1.0 / (1.0 + np.exp(-logits.astype(float)))
    each = -(due * np.log(share) + (1 - due) * np.log(1 - share))
    return each if reduction == "none" else each.mean()


def softmax(values: Any, axis: int) -> Any:
    """As `torch.softmax`."""
    share = np.exp(values - values.max(axis, keepdims=True))
    return share / share.sum(axis, keepdims=True)


def numpy_torch(**parts: Any) -> Any:
    """The library.

    Args:
        parts: Of it that a test gives itself: `optim`, say.
    """
    functional = SimpleNamespace(
        linear=linear, binary_cross_entropy_with_logits=binary_cross_entropy
    )
    utils = SimpleNamespace(rnn=SimpleNamespace(pad_sequence=padded))
    return SimpleNamespace(
        nn=SimpleNamespace(Linear=Linear, GRU=GRU, functional=functional, utils=utils),
        no_grad=nullcontext,
        autocast=lambda kind, dtype, enabled: nullcontext(),
        cpu=SimpleNamespace(_is_avx512_bf16_supported=lambda: False),
        bfloat16=None,
        from_numpy=lambda values: np.asarray(values).view(Tensor),
        relu=lambda x: np.maximum(x, 0),
        sigmoid=lambda x: 1 / (1 + np.exp(-x)),
        tanh=np.tanh,
        cos=np.cos,
        atan2=np.arctan2,
        arange=np.arange,
        tensor=tensor,
        softmax=softmax,
        log_softmax=lambda values, axis: np.log(softmax(values, axis)),
        zeros_like=np.zeros_like,
        cat=lambda parts, axis=0: np.concatenate(parts, axis).view(Tensor),
        stack=lambda parts, axis=0: np.stack(parts, axis).view(Tensor),
        **parts,
    )


class _Anything(ModuleType):
    """A module in which any name is a class of its own."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.__path__ = []

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        found = type(name, (), {})
        setattr(self, name, found)
        return found


@contextmanager
def importable(*extra: str) -> Iterator[None]:
    """Modules of the extra `train` can be imported, so that what they do without it can be tested;
    where it is not installed, only whoever imported them here has them afterwards.

    Args:
        extra: Beside PyTorch: `onnx`.
    """
    names = ("torch", "torch.nn", "torch.nn.functional", *extra)
    missing = [name for name in names if importlib.util.find_spec(name.split(".")[0]) is None]
    before = set(sys.modules)
    with pytest.MonkeyPatch.context() as patch:
        for name in missing:
            patch.setitem(sys.modules, name, _Anything(name))
            parent, _, own = name.rpartition(".")
            if parent:
                setattr(sys.modules[parent], own, sys.modules[name])
        yield
        for name in set(sys.modules) - before if missing else ():
            if name.startswith("tritrack."):
                parent, _, own = name.rpartition(".")
                vars(sys.modules.get(parent, ModuleType("gone"))).pop(own, None)
                del sys.modules[name]
