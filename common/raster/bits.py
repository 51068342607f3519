"""Packed masks: rows of 64-pixel words, in which union is OR and counting is popcount."""

from typing import Any, Final

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from common.compiled import compiled
from common.raster.similarity import Mask

Bits = NDArray[np.uint64]
"""(H, ceil(W / 64)): the first pixel of a row is the lowest bit of its first word."""
ONES: Final = np.uint64(0xFFFFFFFFFFFFFFFF)


@intrinsic
def popcount(_context: Any, _word: Any) -> Any:
    """Number of ones in a word."""

    def generate(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        counter = builder.module.declare_intrinsic("llvm.ctpop", [ir.IntType(64)])
        return builder.call(counter, arguments)

    return types.int64(types.uint64), generate


@compiled
def count(bits: Bits) -> int:
    """Number of pixels in packed rows."""
    total = 0
    for row in range(bits.shape[0]):
        for word in range(bits.shape[1]):
            total += popcount(bits[row, word])
    return total


@compiled
def count_both(one: Bits, other: Bits) -> int:
    """Number of pixels that two packed masks share."""
    total = 0
    for row in range(one.shape[0]):
        for word in range(one.shape[1]):
            total += popcount(one[row, word] & other[row, word])
    return total


def blank(size: tuple[int, int]) -> Bits:
    """Packed rows of an empty picture of (width, height) pixels."""
    return np.zeros((size[1], (size[0] + 63) // 64), np.uint64)


def pack_words(mask: Mask) -> Bits:
    """A mask (H, W) as rows of 64-pixel words, (H, ceil(W / 64))."""
    packed = np.packbits(mask, axis=1, bitorder="little")
    return words_of_rows(packed.tobytes(), mask.shape[1], mask.shape[0])


def words_of_rows(packed: bytes, width: int, height: int) -> Bits:
    """Rows of whole bytes, the first pixel lowest (`Observation.silhouette`), as rows of words."""
    rows = np.zeros((height, 8 * ((width + 63) // 64)), np.uint8)
    rows[:, : (width + 7) // 8] = np.frombuffer(packed, np.uint8).reshape(height, -1)
    return rows.view("<u8").astype(np.uint64, copy=False)


def unpack_words(bits: Bits, width: int) -> Mask:
    """The mask (H, width) of packed rows."""
    rows = np.ascontiguousarray(bits).view(np.uint8)
    return np.unpackbits(rows, axis=1, count=width, bitorder="little").astype(np.bool_)
