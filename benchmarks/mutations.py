"""Messages and files as nobody says them: bytes that were damaged, values that cannot be."""

import copy
import math
from typing import Any, Final

import numpy as np

ODD: Final[tuple[Any, ...]] = (
    *(0, 1, -1, 2, 255, 2**31, 2**53 + 1, 2**63 - 1, -(2**63), 2**64 - 1),
    *(0.0, -0.0, 1e-300, -1e-9, 0.5, 1e9, 1e150, -1e300, math.inf, -math.inf, math.nan),
    *("", "x", "\0", "é" * 99, b"", b"\xff" * 9, True, False, None, [], {}),
)
"""Values that stand anywhere in place of another."""


def damaged(random: np.random.Generator, whole: bytes) -> bytes:
    """Bytes with a few of them flipped, lost, doubled or put elsewhere."""
    found = bytearray(whole)
    for _ in range(int(random.integers(1, 4))):
        if not found:
            break
        at = int(random.integers(len(found)))
        long = int(min(random.geometric(0.1), len(found) - at))
        match int(random.integers(6)):
            case 0:
                found[at] ^= 1 << int(random.integers(8))
            case 1:
                found[at : at + long] = random.bytes(long)
            case 2:
                del found[at : at + long]
            case 3:
                found[at:at] = found[at : at + long]
            case 4:
                del found[at:]
            case _:
                to = int(random.integers(len(found)))
                found[to:to] = found[at : at + long]
    return bytes(found)


def strange(random: np.random.Generator, tree: Any) -> Any:
    """A tree of dicts, lists and values, one of which is another, gone, or there twice."""
    places = list(_places(tree))
    if not places:
        return ODD[random.integers(len(ODD))]
    holder, key = places[random.integers(len(places))]
    match int(random.integers(8)):
        case 0:
            del holder[key]
        case 1 if isinstance(holder, list):
            holder.insert(key, holder[key])
        case 2:
            other, there = places[random.integers(len(places))]
            holder[key] = copy.deepcopy(other[there])
        case 3 if isinstance(holder[key], int | float) and math.isfinite(holder[key]):
            holder[key] = _near(random, holder[key])
        case 4 if isinstance(holder[key], list):
            holder[key] = holder[key] * int(random.integers(2, 5))
        case 5 if isinstance(holder[key], bytes):
            holder[key] = damaged(random, holder[key])
        case _:
            holder[key] = ODD[random.integers(len(ODD))]
    return tree


def _near(random: np.random.Generator, value: float) -> float:
    """A number of the same kind, more or less."""
    changed = value * float(random.normal(1.0, 2.0)) + float(random.normal(0.0, 20.0))
    return int(min(max(changed, -(2.0**62)), 2.0**62)) if isinstance(value, int) else changed


def _places(tree: Any) -> Any:
    """Each holder and key of a tree, from the top."""
    keys = (
        list(tree) if isinstance(tree, dict) else range(len(tree)) if isinstance(tree, list) else ()
    )
    for key in keys:
        yield tree, key
        yield from _places(tree[key])
