"""What our files are made of, read from their text: lines, functions, imports and their circles."""

import ast
import io
import re
import subprocess
import tokenize
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import NamedTuple

NO_CODE = frozenset(
    {
        tokenize.COMMENT,
        tokenize.NL,
        tokenize.NEWLINE,
        tokenize.INDENT,
        tokenize.DEDENT,
        tokenize.ENDMARKER,
    }
)
COMPILING = re.compile(r"(compiled|compiling|KERNEL|INLINE)\b|(numba\.)?njit\b")
"""Decorators of compiled functions: those of `common/compiled.py`, and numba's own."""
BRANCHES = (ast.If, ast.For, ast.While, ast.With, ast.Try, ast.Match)
Definition = ast.FunctionDef | ast.AsyncFunctionDef
Graph = Mapping[str, set[str]]
"""What each node points to."""


class Function(NamedTuple):
    """What can be counted of a function."""

    place: str
    """File and name, as `viewer/track.py (step)`."""
    code_lines: int
    """Of its body, without docstrings, comments and empty lines."""
    nesting: int
    parameters: int
    """Without self and cls."""
    kind: str
    """`compiled` by numba, `command` of the command line, or `plain`."""


class Source(NamedTuple):
    """What can be counted of a file."""

    path: Path
    """From the checkout's top."""
    code_lines: int
    functions: list[Function]
    imports: set[str]
    """Names of modules, wherever in the file they are imported."""
    at_once: set[str]
    """Those of them that are imported as the file is."""
    words: list[str]
    """What its code consists of, in order, without strings and comments."""
    open_types: int
    """Annotations that are `Any`."""

    @property
    def package(self) -> str:
        """The folder at the top that it is in."""
        return self.path.parts[0]

    @property
    def folder(self) -> str:
        """The folder that it is in."""
        return self.path.parent.as_posix()


def packages(root: Path) -> list[str]:
    """The packages that the wheel holds, as pyproject.toml names them."""
    told = tomllib.loads((root / "pyproject.toml").read_text())
    names: list[str] = told["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]
    return names


def tracked(root: Path) -> list[Path]:
    """Files under version control; in an unpacked copy, every file that is no by-product."""
    try:
        listed = subprocess.run(
            ["git", "ls-files", "-z"], cwd=root, capture_output=True, check=True, text=True
        ).stdout.split("\0")
        return [root / name for name in listed if name and (root / name).is_file()]
    except (OSError, subprocess.CalledProcessError):
        made = {".git", ".venv", ".cache", "runs", "dist", "__pycache__", ".hypothesis"}
        return [p for p in root.rglob("*") if p.is_file() and not made & set(p.parts)]


def sources(root: Path) -> list[Source]:
    """The Python files of the packages."""
    names = packages(root)
    paths = (path.relative_to(root) for path in tracked(root) if path.suffix == ".py")
    return [_source(root, path) for path in paths if path.parts[0] in names]


def _source(root: Path, path: Path) -> Source:
    text = (root / path).read_text()
    tree = ast.parse(text)
    nodes, tokens = list(ast.walk(tree)), _tokens(text)
    lines = _code_lines(nodes, tokens)
    functions = [
        Function(
            place=f"{path.as_posix()} ({node.name})",
            code_lines=len(lines & set(range(node.body[0].lineno, (node.end_lineno or 0) + 1))),
            nesting=_nesting(node),
            parameters=_parameters(node),
            kind=_kind(node),
        )
        for node in nodes
        if isinstance(node, Definition)
    ]
    return Source(
        path,
        len(lines),
        functions,
        set(_imports(root, nodes)),
        set(_imports(root, _run_at_once(tree))),
        [t.string for t in tokens if t.type not in NO_CODE and t.type != tokenize.STRING],
        sum(isinstance(each, ast.Name) and each.id == "Any" for each in _annotations(nodes)),
    )


def _tokens(text: str) -> list[tokenize.TokenInfo]:
    return list(tokenize.generate_tokens(io.StringIO(text).readline))


def _run_at_once(node: ast.AST) -> Iterator[ast.AST]:
    """Statements that run as a file is imported: none in functions, none for checkers alone."""
    for child in ast.iter_child_nodes(node):
        checked = isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING"
        if not (checked or isinstance(child, Definition | ast.expr)):
            yield child
            yield from _run_at_once(child)


def _annotations(nodes: Iterable[ast.AST]) -> Iterator[ast.expr | None]:
    for node in nodes:
        if isinstance(node, ast.arg | ast.AnnAssign):
            yield node.annotation
        elif isinstance(node, Definition):
            yield node.returns


def _code_lines(nodes: Iterable[ast.AST], tokens: Iterable[tokenize.TokenInfo]) -> set[int]:
    """Numbers of the lines that hold code."""
    lines: set[int] = set()
    for token in tokens:
        if token.type not in NO_CODE:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in nodes:
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            lines -= set(range(node.lineno, (node.end_lineno or 0) + 1))
    return lines


def _nesting(node: ast.AST, inside_elif: bool = False) -> int:
    """How many branches and loops lie within each other; what an `elif` holds is no deeper."""
    deepest = 0
    for child in ast.iter_child_nodes(node):
        if isinstance(child, Definition | ast.expr):  # no expression has a branch or a loop in it
            continue
        chained = isinstance(node, ast.If) and node.orelse == [child] and isinstance(child, ast.If)
        deepest = max(deepest, _nesting(child, chained))
    return deepest + (isinstance(node, BRANCHES) and not inside_elif)


def _parameters(node: Definition) -> int:
    given = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
    return sum(each.arg not in {"self", "cls"} for each in given)


def _kind(node: Definition) -> str:
    if any(COMPILING.match(ast.unparse(mark)) for mark in node.decorator_list):
        return "compiled"
    typed = "typer." in ast.unparse(node.args) or "Example: tritrack" in (
        ast.get_docstring(node) or ""
    )
    return "command" if typed else "plain"


def _imports(root: Path, nodes: Iterable[ast.AST]) -> Iterator[str]:
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                yield whole if file_of(root, whole) else str(node.module)


@cache
def file_of(root: Path, module: str) -> Path | None:
    """The file of one of our modules, from the checkout's top; None where it is not ours."""
    stem = Path(*module.split("."))
    for path in (stem.with_suffix(".py"), stem / "__init__.py"):
        if (root / path).is_file():
            return path
    return None


def arrows(root: Path, found: list[Source]) -> list[tuple[Path, Path]]:
    """Which file imports which, among ours."""
    files = [(each.path, file_of(root, name)) for each in found for name in sorted(each.imports)]
    ours = {each.path for each in found}
    return [(importer, file) for importer, file in files if file in ours and file is not None]


def room_of(path: Path) -> str:
    """The folder within a package that a file lies in; at the package's top, the file itself."""
    return path.as_posix() if len(path.parts) == 2 else path.parent.as_posix()


def pointing(pairs: Iterable[tuple[str, str]]) -> Graph:
    """What each first of the pairs points to."""
    graph: dict[str, set[str]] = {}
    for one, other in pairs:
        graph.setdefault(one, set()).add(other)
    return graph


def circles(graph: Graph) -> list[set[str]]:
    """Sets of nodes that can all be reached from each other."""
    ahead = {node: reached(graph, node) for node in graph}
    found: list[set[str]] = []
    for node in graph:
        circle = {other for other in ahead[node] if node in ahead.get(other, set())}
        if circle and circle not in found:
            found.append(circle)
    return found


def reached(graph: Graph, start: str) -> set[str]:
    """Every node that can be reached from one."""
    found: set[str] = set()
    ahead = [start]
    while ahead:
        new = graph.get(ahead.pop(), set()) - found
        found |= new
        ahead += new
    return found
