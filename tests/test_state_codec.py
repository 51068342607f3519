"""States as bytes: the same to the last bit, and nothing else is taken for one."""

from typing import NamedTuple

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from runtime.unfinished.state_codec import UnreadableState, packed, unpacked


class Inner(msgspec.Struct, frozen=True):
    """A struct in a state."""

    name: str
    places: tuple[float, ...] = ()


class State(NamedTuple):
    """As the stages have them."""

    picture: NDArray[np.uint8] | None
    rows: dict[int, list[tuple[float, NDArray[np.float64]]]]
    inner: Inner | None = None
    content: bytes = b""


@given(
    picture=arrays.arrays(st.sampled_from([np.uint8, np.float32, np.bool_]), (3, 0, 2))
    | arrays.arrays(st.sampled_from([np.uint8, np.float32, np.bool_]), (3, 2)),
    row=arrays.arrays(np.float64, st.integers(0, 4)),
    numbers=st.lists(st.floats(), max_size=3),
    content=st.binary(max_size=9),
)
def test_a_state_comes_back_to_the_last_bit(
    picture: NDArray[np.uint8], row: NDArray[np.float64], numbers: list[float], content: bytes
) -> None:
    state = State(picture, {2: [(0.1, row)]}, Inner("a", tuple(numbers)), content)
    read = unpacked(packed(state), State)
    assert packed(read) == packed(state)
    assert read.picture is not None
    assert (read.picture.dtype, read.picture.shape) == (picture.dtype, picture.shape)
    assert read.picture.tobytes() == picture.tobytes()
    assert read.picture.flags.writeable
    assert read.rows[2][0][1].tobytes() == row.tobytes()
    assert np.array(read.inner.places if read.inner else 0).tobytes() == np.array(numbers).tobytes()


def test_what_would_not_come_back_is_refused_before_it_is_written() -> None:
    turned = np.arange(6.0).reshape(2, 3).T
    for odd in (turned, np.array([{}], object), np.float32(0.1), object()):
        with pytest.raises(TypeError, match="is not kept in a state"):
            packed((odd,))


@pytest.mark.parametrize("data", [b"", b"\x93", packed([1, 2]), packed({"picture": None})])
def test_bytes_of_something_else_are_no_state(data: bytes) -> None:
    with pytest.raises(UnreadableState):
        unpacked(data, State)
