"""The house as levels: which folders and files of a package stand above which, by their imports."""

import ast
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from source_map import Graph, Source, arrows, pointing, reached, room_of


class Box(NamedTuple):
    """A folder, or files of one level at a package's top."""

    names: tuple[str, ...]
    says: str
    """What a folder is, by its first docstring; "" for files."""


class Package(NamedTuple):
    """What is drawn of a package."""

    name: str
    says: str
    levels: list[list[Box]]
    """From the top."""
    points: list[tuple[str, str]]
    """Arrows between rooms, without those that follow from others."""


def heights(graph: Graph, nodes: Iterable[str]) -> dict[str, int]:
    """Level of every node, 0 at the top: one below the lowest that points to it.

    Args:
        graph: Without circles.
        nodes: All of them, also those that no arrow touches.
    """
    found = dict.fromkeys(nodes, 0)
    for node in sorted(found, key=lambda each: -len(reached(graph, each))):
        for below in graph.get(node, ()):
            found[below] = max(found[below], found[node] + 1)
    return found


def needed(graph: Graph) -> list[tuple[str, str]]:
    """The arrows without those that follow from others, in order."""
    return [
        (node, below)
        for node in sorted(graph)
        for below in sorted(graph[node])
        if not any(below in reached(graph, other) for other in graph[node])
    ]


def package(root: Path, name: str, found: Sequence[Source]) -> Package:
    """A package as it is drawn."""
    own = [each for each in found if each.package == name]
    inside = [(a, b) for a, b in arrows(root, own) if a.parts[0] == b.parts[0]]
    pairs = ((room_of(a), room_of(b)) for a, b in inside)
    door = room_of(Path(name, "__init__.py"))  # what programs import: it is not drawn
    graph = pointing((a, b) for a, b in pairs if a != b and door not in (a, b))
    rooms = {room_of(each.path) for each in own} - {door}
    level_of = heights(graph, sorted(rooms))
    levels: list[list[Box]] = []
    for level in range(max(level_of.values()) + 1):
        here = [room for room in sorted(rooms) if level_of[room] == level]
        top = tuple(room for room in here if room.endswith(".py"))
        folders = [room for room in here if room not in top]
        boxes = [Box((room,), first_line(root, room).split(":")[0]) for room in folders]
        levels.append([*([Box(top, "")] if top else []), *boxes])
    return Package(name, first_line(root, name), levels, needed(graph))


def first_line(root: Path, folder: str) -> str:
    """What a folder is, as it says itself."""
    text = ast.get_docstring(ast.parse((root / folder / "__init__.py").read_text())) or ""
    return text.split("\n", 1)[0].rstrip(".")


def ordered(drawn: Package) -> list[list[Box]]:
    """The levels, each box as nearly below what points to it as its row allows."""
    place: dict[str, float] = {}
    levels = []
    for level in drawn.levels:

        def middle(box: Box) -> float:
            above = [place[a] for a, b in drawn.points if b in box.names and a in place]
            return sum(above) / len(above) if above else 0.5

        row = sorted(level, key=middle)
        for n, box in enumerate(row):
            place.update(dict.fromkeys(box.names, (n + 0.5) / len(row)))
        levels.append(row)
    return levels
