"""A state as bytes, restored bit for bit: named tuples, structs, arrays and plain values.

What is read is checked against the annotations of its type and never executed.
"""

from typing import Any, TypeVar

import msgspec
import numpy as np

Value = TypeVar("Value")


class UnreadableState(ValueError):
    """Bytes that are no valid state."""


def packed(value: object) -> bytes:
    """A state as bytes.

    Raises:
        TypeError: When something in it could not be restored exactly.
    """
    return msgspec.msgpack.encode(value, enc_hook=_plain)


def unpacked(data: bytes, kind: type[Value]) -> Value:
    """The state given to `packed`.

    Raises:
        UnreadableState: When it is of another type.
    """
    try:
        return msgspec.msgpack.Decoder(kind, dec_hook=_array).decode(data)
    except (msgspec.DecodeError, ValueError, TypeError) as error:
        raise UnreadableState(str(error)) from error


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray) and value.flags.c_contiguous and not value.dtype.hasobject:
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, np.bool_ | np.float64 | np.int64):
        return value.item()
    raise TypeError(f"{type(value).__name__} is not kept in a state")


def _array(_kind: type, told: Any) -> Any:
    """An array from the result of `_plain`, with its own memory."""
    dtype, shape, content = told
    return np.frombuffer(content, np.dtype(dtype)).reshape(shape).copy()
