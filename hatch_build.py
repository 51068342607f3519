"""The wheel's one namespace: what is `common` in a checkout is installed as `tritrack.common`.

hatchling puts the folders where `sources` in pyproject.toml says; here their files learn each
other's new names. An editable installation is the checkout itself, as it stands.
"""

import ast
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

FROM: Final = re.compile(rb"from(\s|\\\r?\n)+")
"""What stands before the module's name."""
DOTTED: Final = re.compile(r"\w+(\.\w+)+")


class Immovable(ValueError):
    """Source that would mean something else in the wheel; the text says where, and the cure."""


class Namespace(BuildHookInterface[Any]):
    """Gives hatchling the files whose imports have to change, for a wheel that is no editable."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Called by hatchling before it builds; see there for both arguments.

        Raises:
            Immovable: When a file cannot be moved.
        """
        if version == "editable":
            return
        sources = self.build_config.sources
        names = {old.rstrip("/"): new.rstrip("/").replace("/", ".") for old, new in sources.items()}
        self._folder = TemporaryDirectory(prefix="tritrack-wheel-")
        for file in self.build_config.builder.recurse_selected_project_files():
            path = Path(file.relative_path)
            if path.suffix == ".py":
                new = Path(self._folder.name) / path
                new.parent.mkdir(parents=True, exist_ok=True)
                new.write_bytes(moved(Path(self.root), path, names))
                build_data["force_include"][str(new)] = str(path)

    def finalize(self, version: str, *_: object) -> None:
        """Called by hatchling when the wheel is written."""
        if version != "editable":
            self._folder.cleanup()


def moved(root: Path, path: Path, names: Mapping[str, str]) -> bytes:
    """A file's source for the wheel.

    Args:
        root: The checkout.
        path: The file, from there.
        names: Of the packages that move, and what each is called afterwards.

    Raises:
        Immovable: When it imports in a way, or names modules in strings, that cannot be moved.
    """
    source = (root / path).read_bytes()
    try:
        refuse_strings(source, root, names)
        return renamed(source, names)
    except Immovable as error:
        raise Immovable(f"{path}:{error}") from error


def renamed(source: bytes, names: Mapping[str, str]) -> bytes:
    """Source in UTF-8 whose imports name packages anew; every line keeps its number.

    Raises:
        Immovable: At `import a.b` without `as`: all that follows says `a`.
    """
    for place, old in sorted(_imported(source, names), reverse=True):
        source = source[:place] + names[old].encode() + source[place + len(old) :]
    return source


def refuse_strings(source: bytes, root: Path, names: Mapping[str, str]) -> None:
    """See that no string is the name of a module that moves: it would be another's.

    Args:
        source: In UTF-8.
        root: Folder of the packages.
        names: As for `moved`.

    Raises:
        Immovable: At the first that is.
    """
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Constant) or not isinstance(node.value, str):
            continue
        text = node.value
        if not DOTTED.fullmatch(text) or _top(text) not in names:
            continue
        place = root / text.replace(".", "/")
        if place.is_dir() or place.with_suffix(".py").is_file():
            raise Immovable(
                f"{node.lineno}: {text!r} is a module's name, which the wheel changes: "
                "say it by __package__ or __name__"
            )


def _imported(source: bytes, names: Mapping[str, str]) -> Iterator[tuple[int, str]]:
    """Where source names a package that moves in an import, in bytes, and which."""
    starts = [0, *(match.end() for match in re.finditer(rb"\n", source))]
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom):
            old = _top(node.module or "")
            word = FROM.match(source, starts[node.lineno - 1] + node.col_offset)
            if node.level == 0 and old in names and word:
                yield word.end(), old
        elif isinstance(node, ast.Import):
            for alias in node.names:
                old = _top(alias.name)
                if old in names and alias.asname is None:
                    raise Immovable(
                        f"{alias.lineno}: import {alias.name} as something, or from it: the wheel "
                        f"has no {old}"
                    )
                if old in names:
                    yield starts[alias.lineno - 1] + alias.col_offset, old


def _top(name: str) -> str:
    return name.partition(".")[0]
