"""Digests of our sources: of all together, and of those that one module's compiled code depends
on."""

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
"""A regular expression for import statements anywhere: module and names, or modules."""
WORD: Final = re.compile(rb"[\w.]+")


class Source(NamedTuple):
    """Cached facts of a file: its digest, and which of our modules it imports."""

    digest: bytes
    imports: tuple[str, ...]


def digest_of(root: Path) -> str:
    """Digest of all our sources, 32 hexadecimal digits; takes 10 ms.

    Args:
        root: The folder that holds PACKAGES.
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

    Compiled code depends on a function's file, on the functions that it calls and the constants
    that it reads: these are imported. An edit elsewhere leaves compiled code valid. The digest is
    taken when the module is imported, so that no edit comes between the import and the digest.

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
    """The source of a module.

    Raises:
        OSError: When it does not exist.
    """
    path = _path(module)
    if path is None:
        raise FileNotFoundError(f"no source of {module} below {ROOT}")
    content = _content(path)
    return Source(hashlib.sha256(content).digest(), tuple(sorted(set(_imports(content)))))


def add(digest: "hashlib._Hash", name: str, content: bytes) -> None:
    """Add a name and a content to a digest, each with its length, so that no two files collide."""
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
