"""The house in figures: lines, folders, arrows, functions, and the files that one frame passes.

Run from the checkout that is to be measured, in Markdown:

    .venv/bin/python benchmarks/house.py [--no-way]

Lines are lines of code: no docstrings, comments or empty lines; a function's are those of its
body. A folder's files are its Python files, those of folders in it not counted. Arrows are imports
of a file by a file, wherever in it they stand; for circles of folders, a file that lies at a
package's top stands for itself. Tests and benchmarks are not counted.
"""

import argparse
import os
from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import chain
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import numpy as np
from house_words import names_a_pair, reaching
from source_map import Function, Source, arrows, circles, pointing, room_of, sources

FLOORS = {"tritrack": 5, "lab": 4, "runtime": 3, "calibration": 1, "common": 0}
"""Who may import whom: a package those of lower floors; all others stand on floor 2."""
PARAMETERS = 6
SMALL = 20
WORST = 10

Row = tuple[str, object]


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines) + "\n"


def spread(values: Sequence[int]) -> str:
    """Median, p90 and most."""
    return " / ".join(f"{value:.0f}" for value in np.percentile(values, [50, 90, 100]))


def sizes(found: Sequence[Source]) -> list[tuple[str, int, int, str, str]]:
    """Files, lines, their share and the largest folder of every package, and of all."""
    names = sorted({each.package for each in found})
    groups = [*([e for e in found if e.package == name] for name in names), found]
    lines = [sum(each.code_lines for each in group) for group in groups]
    return [
        (name, len(group), count, f"{count / lines[-1]:.1%}", largest(group))
        for name, group, count in zip([*names, "all"], groups, lines, strict=True)
    ]


def largest(found: Iterable[Source]) -> str:
    """The folder of most files."""
    folder, files = Counter(each.folder for each in found).most_common(1)[0]
    return f"{files} in {folder}/"


def functions_rows(functions: Sequence[Function]) -> list[Row]:
    """How long, deep and wide functions are."""
    wide = [each for each in functions if each.parameters > PARAMETERS]
    kinds = Counter(each.kind for each in wide)
    return [
        ("functions", len(functions)),
        (
            "lines of code a function: median / p90 / most",
            spread([each.code_lines for each in functions]),
        ),
        ("nesting: median / p90 / most", spread([each.nesting for each in functions])),
        ("functions that nest deeper than 3", sum(each.nesting > 3 for each in functions)),
        (f"functions of more than {PARAMETERS} parameters, compiled", kinds["compiled"]),
        (f"functions of more than {PARAMETERS} parameters, commands", kinds["command"]),
        (f"functions of more than {PARAMETERS} parameters, others", kinds["plain"]),
    ]


def arrow_rows(between: Sequence[tuple[Path, Path]]) -> list[Row]:
    """Imports that cross a border, those that go up, and what turns in circles."""
    across = [pair for pair in between if pair[0].parts[0] != pair[1].parts[0]]
    up = [f"{a} -> {b}" for a, b in across if floor(b) >= floor(a)]
    within = [pair for pair in between if pair not in across and pair[0].parent != pair[1].parent]
    return [
        ("arrows between packages", len(across)),
        ("of them upwards or across", said(up)),
        ("arrows between folders of a package", len(within)),
        ("circles of packages", said(turning((a.parts[0], b.parts[0]) for a, b in across))),
        ("circles of folders", said(turning((room_of(a), room_of(b)) for a, b in within))),
        ("circles of files", said(turning((str(a), str(b)) for a, b in between))),
    ]


def module_rows(found: Sequence[Source]) -> list[Row]:
    """What modules name and reach, and how small they are; a folder's own file is none."""
    modules = [each for each in found if each.path.name != "__init__.py"]
    pairs = [each.path for each in modules if names_a_pair(each)]
    bound = {*reaching(found)} & {each.path for each in modules}
    steps = [path for path in bound if floor(path) < FLOORS["runtime"]]
    small = [each.path for each in modules if each.code_lines < SMALL]
    return [
        ("modules", len(modules)),
        ("modules that name a pair of views", by_package(pairs)),
        ("modules that cannot be imported without fcntl", by_package(bound)),
        ("of them below runtime", len(steps)),
        ("annotations that are Any", sum(each.open_types for each in found)),
        (f"modules of fewer than {SMALL} lines", by_package(small)),
    ]


def floor(path: Path) -> int:
    """The floor of a file's package."""
    return FLOORS.get(path.parts[0], 2)


def turning(pairs: Iterable[tuple[str, str]]) -> list[str]:
    """The circles that pairs of names make, each in a line."""
    return [" - ".join(sorted(circle)) for circle in circles(pointing(pairs))]


def said(found: Sequence[str]) -> str:
    """How many, and which."""
    return f"{len(found)}: {'; '.join(found)}" if found else "none"


def way_rows(root: Path) -> list[Row]:
    """Files that a frame passes, in default mode with two views."""
    from frame_way import way

    found = way(root)
    counts = [len(files) for files in found.each]
    moving = found.each[len(found.each) // 2]
    return [
        ("files that a frame passes, in the middle of the clip", by_package(moving)),
        ("files that a frame passes: median, most", f"{np.median(counts):.0f}, {max(counts)}"),
        ("files that the frames of a clip pass", by_package(found.all)),
    ]


def by_package(files: Iterable[Path]) -> str:
    """How many files, and of which packages."""
    counts = Counter(path.parts[0] for path in files)
    return f"{counts.total()} ({', '.join(f'{name} {n}' for name, n in sorted(counts.items()))})"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--no-way", action="store_true", help="leave out what a frame passes")
    given = parser.parse_args()
    root = Path.cwd()
    found = sources(root)
    functions = [*chain.from_iterable(each.functions for each in found)]
    print(table(("package", "files", "lines", "share", "most files a folder"), sizes(found)))
    rows = [*arrow_rows(arrows(root, found)), *module_rows(found), *functions_rows(functions)]
    print(table(("", ""), [*rows, *([] if given.no_way else way_rows(root))]))
    longest = sorted(functions, key=lambda each: -each.code_lines)[:WORST]
    print(table(("longest functions", "lines"), [(e.place, e.code_lines) for e in longest]))
    wide = [e for e in functions if e.parameters > PARAMETERS and e.kind != "compiled"]
    print(table(("of many parameters", "", ""), [(e.place, e.parameters, e.kind) for e in wide]))


if __name__ == "__main__":
    main()
