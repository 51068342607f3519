"""The folder for compiled code, one per interpreter and version of the libraries."""

import hashlib
import logging
import os
import re
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Final

import numba
import numpy as np

from common.packages import ROOT
from common.source_digest import add, digest_of

KEPT: Final = 3
"""Number of version folders that are kept: this one and those used last."""
ADMINISTRATOR: Final = 0
"""User ids whose compiled code is loaded without question: root, who may have installed the
package, this user, and the owner of the sources."""
COMPILED: Final = ".nbc"
"""Suffix of files of compiled code."""
NAME: Final = re.compile(r"tritrack-[0-9a-f]{32}")

log = logging.getLogger(__name__)


def versions_word() -> str:
    """A digest of the interpreter and the compiling libraries, 32 hexadecimal digits."""
    digest = hashlib.sha256()
    for version in (sys.version, np.__version__, numba.__version__):
        add(digest, "version", version.encode())
    return digest.hexdigest()[:32]


@cache
def compiled_folder() -> Path:
    """The folder of this process's versions, created and writable; old ones beside it are
    removed."""
    folder = first_writable(parents(ROOT, os.environ), f"tritrack-{versions_word()}")
    os.utime(folder)
    prune(folder.parent)
    return folder


def mark_of_all() -> Path:
    """A marker file: it exists once all that commands run by default was compiled."""
    return compiled_folder() / f"all-{digest_of(ROOT)}"


def is_new() -> bool:
    """Whether nothing was compiled there yet, of whatever state of our sources."""
    return not any(compiled_folder().glob(f"*{COMPILED}"))


def parents(root: Path, environ: Mapping[str, str]) -> Iterator[Path]:
    """Candidate parents of the folder, best first.

    The folder in NUMBA_CACHE_DIR; the checkout; the user's cache folder, for an installed wheel or
    a checkout of another owner.
    """
    if environ.get("NUMBA_CACHE_DIR"):
        yield Path(environ["NUMBA_CACHE_DIR"])
    if (root / "pyproject.toml").is_file():
        yield root / ".cache"
    of_user = environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    if os.path.isabs(of_user):
        yield Path(of_user) / "tritrack"


def first_writable(candidates: Iterable[Path], name: str) -> Path:
    """The folder of that name in the first candidate that can be written; created where missing.

    Where no candidate can be written: a temporary folder of this user, with a warning.
    """
    tried = []
    for parent in candidates:
        with suppress(OSError):
            return _made(parent / name)
        tried.append(str(parent))
    parent = _private()
    log.warning("compiled code is kept in %s: cannot write %s", parent, ", ".join(tried))
    return _made(parent / name)


def prune(parent: Path) -> None:
    """Remove the folders of other versions, all but the KEPT that were used last.

    A process that still uses a removed one goes on: it compiles, and creates its folder again.
    """
    named = [path for path in parent.iterdir() if NAME.fullmatch(path.name)]
    for path in sorted(named, key=used_s, reverse=True)[KEPT:]:
        shutil.rmtree(path, ignore_errors=True)


def _made(folder: Path) -> Path:
    new = not folder.is_dir()
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK | os.X_OK):
        raise PermissionError(f"cannot write {folder}")
    if folder.stat().st_uid not in (own_number(), ROOT.stat().st_uid, ADMINISTRATOR):
        raise PermissionError(f"{folder} is another user's, and so is what was compiled there")
    if new:
        log.warning("compiling for the first time, about a minute; kept in %s", folder)
    return folder


def own_number() -> int:
    """This user's number; 0, as of all files, where the system numbers no users."""
    return os.getuid() if hasattr(os, "getuid") else 0


def _private() -> Path:
    """A folder for temporary files that no other user can have written to: compiled code of
    another user could be malicious. Without numbers of users the folder of temporary files is
    this user's own."""
    folder = Path(tempfile.gettempdir()) / f"tritrack-{own_number()}"
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    found = folder.lstat()
    is_closed = stat.S_IMODE(found.st_mode) == 0o700 or not hasattr(os, "getuid")
    is_own = found.st_uid == own_number() and is_closed
    return folder if stat.S_ISDIR(found.st_mode) and is_own else Path(tempfile.mkdtemp())


def used_s(path: Path) -> float:
    """Time of the last write, by the system's clock; 0 where the file is gone."""
    try:
        return path.stat().st_mtime
    except FileNotFoundError:  # another process removes folders too
        return 0.0
