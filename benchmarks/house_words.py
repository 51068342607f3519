"""What our modules name and reach: pairs of views, calls that only some systems have."""

import re
from collections.abc import Sequence
from pathlib import Path

from source_map import Source, pointing, reached

PAIR = re.compile(r"\b(Pair|camera_[12]|(viewer|number) - 1)\b|tuple \[ ([A-Z]\w*) , \3 \]")
"""Words of a module that knows two views, and no third; a tuple of two of one of our types."""
ORDINALS = frozenset({"first", "second"})
"""Of two things that have no names of their own."""
SYSTEM_CALLS = "fcntl"
"""Whoever reaches it starts processes, or holds files against them, and runs on some systems."""


def names_a_pair(source: Source) -> bool:
    """Whether a module's code, its strings and comments apart, is written for two."""
    return {*source.words} >= ORDINALS or PAIR.search(" ".join(source.words)) is not None


def reaching(found: Sequence[Source], module: str = SYSTEM_CALLS) -> list[Path]:
    """Files that cannot be imported without a module, since they or what they import need it."""
    graph = pointing((name_of(each.path), name) for each in found for name in needed(each))
    return [each.path for each in found if module in reached(graph, name_of(each.path))]


def needed(source: Source) -> set[str]:
    """What is imported with a file: the modules, and the packages that they and it lie in."""
    names = {*source.at_once, name_of(source.path)}
    inside = {name.rsplit(".", n)[0] for name in names for n in range(1, name.count(".") + 1)}
    return (source.at_once | inside) - {name_of(source.path)}


def name_of(path: Path) -> str:
    """The module of a file."""
    return ".".join(path.with_suffix("").parts).removesuffix(".__init__")
