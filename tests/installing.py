"""Installing as a user does, with the package index of this machine where it has one."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement


def pip(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pip", *words], capture_output=True, text=True, check=False
    )


def refuse_without_network(folder: Path) -> None:
    tried = pip("download", "--quiet", "--no-deps", "--dest", str(folder / "tried"), "iniconfig")
    if tried.returncode:
        pytest.skip(f"no package can be installed here: {tried.stderr.strip()[-200:]}")


def needed(requires: Iterable[str], extras: Iterable[str] = ()) -> dict[str, Distribution]:
    """What is needed by requirements, directly or not, and is installed here; by name."""
    found: dict[str, Distribution] = {}
    ahead, seen = [*_that_hold(requires, extras)], set[str]()
    while ahead:
        one = ahead.pop()
        if str(one) in seen:
            continue
        seen.add(str(one))
        try:
            found[one.name] = distribution(one.name)
        except PackageNotFoundError:
            continue
        ahead += _that_hold(found[one.name].requires or (), one.extras)
    return found


def _that_hold(requires: Iterable[str], extras: Iterable[str]) -> Iterator[Requirement]:
    for one in map(Requirement, requires):
        if one.marker is None or any(one.marker.evaluate({"extra": e}) for e in ("", *extras)):
            yield one


def put_into(site: Path, distributions: Iterable[Distribution]) -> None:
    """Libraries as they are here, as if they had been installed into another environment.

    Hard links where there can be some: what is removed there stays here.
    """
    for one in distributions:
        tops = {file.parts[0] for file in one.files or ()} - {"..", "__pycache__"}
        for top in sorted(tops):
            here, there = Path(str(one.locate_file(top))), site / top
            if here.is_dir():
                shutil.copytree(here, there, copy_function=_linked, dirs_exist_ok=True)
            elif here.exists():
                _linked(here, there)


def _linked(here: str | Path, there: str | Path) -> None:
    if os.path.exists(there):
        return
    try:
        os.link(here, there)
    except OSError:
        shutil.copy2(here, there)
