"""A state as bytes, and back to the last bit: named tuples, structs, arrays and plain values.

What is read is checked against the annotations of its type; nothing in it is ever run.
"""

from typing import Any, TypeVar

import msgspec
import numpy as np

Value = TypeVar("Value")


class UnreadableState(ValueError):
    """Bytes that are no such state."""


def packed(value: object) -> bytes:
    """A state as bytes.

    Raises:
        TypeError: When something in it could not be read back as it is.
    """
    return msgspec.msgpack.encode(value, enc_hook=_plain)


def unpacked(data: bytes, kind: type[Value]) -> Value:
    """The state that `packed` was given.

    Raises:
        UnreadableState: When it is of another kind.
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
    """An array from what `_plain` made of it, in memory of its own."""
    dtype, shape, content = told
    return np.frombuffer(content, np.dtype(dtype)).reshape(shape).copy()
