"""As much of PyTorch on NumPy arrays as the tests of training need where PyTorch is not installed:
forward passes, and optimisers that only write down what they are asked for."""

from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import numpy as np


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

    def unbind(self, axis: int) -> list[Any]:
        return [self.take(at, axis) for at in range(self.shape[axis])]

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


def binary_cross_entropy(logits: Any, due: Any, reduction: str) -> Any:
    """As PyTorch's of logits, not summed."""
    assert reduction == "none"
    share = 1.0 / (1.0 + np.exp(-logits.astype(float)))
    return -(due * np.log(share) + (1 - due) * np.log(1 - share))


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
        autocast=lambda kind, dtype: nullcontext(),
        bfloat16=None,
        from_numpy=tensor,
        relu=lambda x: np.maximum(x, 0),
        sigmoid=lambda x: 1 / (1 + np.exp(-x)),
        tanh=np.tanh,
        zeros_like=np.zeros_like,
        cat=lambda parts, axis: np.concatenate(parts, axis),
        stack=lambda parts, axis=0: np.stack(parts, axis).view(Tensor),
        **parts,
    )
