"""Digests of our sources: of all of them, and of those that one module's compiled code rests on."""

import hashlib
import os
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

from common.packages import PACKAGES, ROOT

IMPORTED: Final = re.compile(
    rb"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]*(\([^)]*\)|[^\n]+)|import[ \t]+([^\n]+))", re.M
)
"""An import statement wherever it stands: module and names, or modules."""
WORD: Final = re.compile(rb"[\w.]+")


class Source(NamedTuple):
    """What is kept of a file: its digest, and which of our modules it imports."""

    digest: bytes
    imports: tuple[str, ...]


def digest_of(root: Path) -> str:
    """Digest of every source of ours, 32 hexadecimal digits; takes 10 ms.

    Args:
        root: Folder of PACKAGES.
    """
    digest = hashlib.sha256()
    above = len(os.path.join(root, ""))
    for package in PACKAGES:
        for folder, folders, files in os.walk(root / package):
            folders.sort()
            for name in sorted(files):
                if name.endswith(".py"):
                    path = os.path.join(folder, name)
                    add(digest, path[above:], _content(path))
    return digest.hexdigest()[:32]


@cache
def module_digest(module: str) -> str:
    """Digest of a module and of all of ours that it imports, directly or not, 16 digits.

    What a function compiles to depends on its own file, on the functions that it calls and the
    constants that it reads: these are imported. An edit elsewhere leaves compiled code valid.
    Taken as the module is imported, before an edit can come between what was read of it and this.

    Args:
        module: Its dotted name below ROOT, such as `common.raster.kernel`.
    """
    met, waiting = {module}, [module]
    while waiting:
        for name in source_of(waiting.pop()).imports:
            if name not in met:
                met.add(name)
                waiting.append(name)
    digest = hashlib.sha256()
    for name in sorted(met):
        add(digest, name, source_of(name).digest)
    return digest.hexdigest()[:16]


@cache
def source_of(module: str) -> Source:
    """A module's own source.

    Raises:
        OSError: When there is none.
    """
    path = _path(module)
    if path is None:
        raise FileNotFoundError(f"no source of {module} below {ROOT}")
    content = _content(path)
    return Source(hashlib.sha256(content).digest(), tuple(sorted(set(_imports(content)))))


def add(digest: "hashlib._Hash", name: str, content: bytes) -> None:
    """Add a name and a content, each with its length: two files are never taken for one."""
    for part in (name.encode(), content):
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)


def _imports(content: bytes) -> Iterator[str]:
    for module, names, modules in IMPORTED.findall(content):
        said = [module] if module else WORD.findall(modules)
        candidates = [*said, *(module + b"." + name for name in WORD.findall(names) if module)]
        for candidate in candidates:
            name = candidate.decode()
            if name.split(".")[0] in PACKAGES and _path(name) is not None:
                yield name


@cache
def _path(module: str) -> str | None:
    stem = os.path.join(ROOT, *module.split("."))
    for path in (f"{stem}.py", os.path.join(stem, "__init__.py")):
        if os.path.isfile(path):
            return path
    return None


def _content(path: str) -> bytes:
    with open(path, "rb", buffering=0) as file:
        return file.read()
