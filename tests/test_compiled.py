"""What is compiled is kept for other processes: none gets another's code, or an older one."""

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from common.cache_folder import compiled_folder
from common.compiled import KEPT
from common.packages import ROOT
from common.raster.kernel import warm

CALLEE = """
from common.compiled import compiled

@compiled
def step(x):
    return x + 1
"""
CALLER = """
from common.compiled import compiled
from viewer.callee import step

@compiled
def twice(x):
    return step(step(x))

if __name__ == "__main__":
    print(twice(1))
"""
MAIN = """
import multiprocessing
from viewer.caller import twice

def child():
    print(twice(1), flush=True)

if __name__ == "__main__":
    process = multiprocessing.get_context("spawn").Process(target=child)
    process.start()
    process.join()
    print(twice(1))
"""
ASK = "from viewer.caller import twice; print(twice(1))"
KINDS = ("bool", "int8", "int16", "uint32", "float32", "float64", "complex64", "complex128")
ALL_KINDS = """
import sys
import numpy as np
from viewer.caller import twice
print(*(twice(np.ones(1, kind)).astype(complex)[0].real for kind in sys.argv[1:]))
"""


FEW = 2
"""Of older sources so many are kept here, which takes fewer processes than KEPT."""


@pytest.fixture
def house(tmp_path: Path) -> Path:
    """A checkout that holds two compiled functions, one of which calls the other."""
    root = tmp_path / "house"
    for package in ("common", "viewer", "tritrack"):
        (root / package).mkdir(parents=True)
        (root / package / "__init__.py").touch()
    for name in ("atomic_file", "cache_folder", "compiled", "packages", "source_digest"):
        shutil.copy(ROOT / "common" / f"{name}.py", root / "common")
    compiler = root / "common" / "compiled.py"
    compiler.write_text(compiler.read_text().replace(f"KEPT: Final = {KEPT}\n", f"KEPT = {FEW}\n"))
    (root / "pyproject.toml").touch()
    (root / "viewer" / "callee.py").write_text(CALLEE)
    (root / "viewer" / "caller.py").write_text(CALLER)
    (root / "tritrack" / "__main__.py").write_text(MAIN)
    return root


def started(house: Path, words: Sequence[str]) -> subprocess.Popen[str]:
    own = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    return subprocess.Popen(
        [sys.executable, *words],
        cwd=house,
        env={**own, "XDG_CACHE_HOME": str(house.parent / "user")},
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


def said(process: subprocess.Popen[str]) -> str:
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    return out.strip()


def answer(house: Path, *words: str) -> str:
    return said(started(house, words))


def kept(place: Path) -> dict[Path, int]:
    """Files with compiled code, and when each was written."""
    return {path: path.stat().st_mtime_ns for path in place.rglob("*.nbc")}


def names_the_program(path: Path) -> bool:
    content = path.name.encode() + path.read_bytes()
    return b"__main__" in content or b"__mp_main__" in content


@pytest.mark.slow
def test_a_callee_that_changed_in_another_file_is_noticed(house: Path) -> None:
    assert answer(house, "-c", ASK) == "3"
    callee = house / "viewer" / "callee.py"
    callee.write_text(CALLEE.replace("x + 1", "x + 2"))
    assert answer(house, "-c", ASK) == "5"
    callee.write_text(CALLEE)
    assert answer(house, "-c", ASK) == "3"
    assert len(kept(house)) == 4


@pytest.mark.slow
def test_a_constant_that_changed_in_another_file_is_noticed(house: Path) -> None:
    (house / "viewer" / "constants.py").write_text("STEP = 1\n")
    callee = CALLEE.replace("x + 1", "x + STEP").replace(
        "import compiled", "import compiled\nfrom viewer import constants\nSTEP = constants.STEP"
    )
    (house / "viewer" / "callee.py").write_text(callee)
    assert answer(house, "-c", ASK) == "3"
    (house / "viewer" / "constants.py").write_text("STEP = 2\n")
    assert answer(house, "-c", ASK) == "5"


@pytest.mark.slow
def test_of_older_sources_the_newest_stay(house: Path) -> None:
    assert FEW != KEPT
    for step in range(FEW + 2):
        before = kept(house)
        (house / "viewer" / "callee.py").write_text(CALLEE.replace("+ 1", f"+ {step}"))
        assert answer(house, "-c", ASK) == str(1 + 2 * step)
    assert len(kept(house)) == 2 * FEW
    assert len(kept(house).keys() - before.keys()) == 2, "the newest among them"
    before = kept(house)
    assert answer(house, "-c", ASK) == str(1 + 2 * (FEW + 1))
    assert kept(house) == before


@pytest.mark.slow
def test_a_second_process_compiles_nothing_whatever_changed_that_is_not_imported(
    house: Path,
) -> None:
    answer(house, "-c", ASK)
    before = kept(house)
    assert {path.name.split("-")[0] for path in before} == {
        "viewer.callee.step",
        "viewer.caller.twice",
    }
    assert answer(house, "-c", ASK) == "3"
    assert kept(house) == before
    (house / "viewer" / "elsewhere.py").write_text("STEP = 2\n")
    (house / "tritrack" / "__main__.py").write_text("")
    assert answer(house, "-c", ASK) == "3"
    assert kept(house) == before


@pytest.mark.slow
def test_no_order_of_programs_keeps_a_function_of_the_program(house: Path) -> None:
    """A module that runs by itself, children of the front door, and plain imports after them."""
    for words in (("-m", "viewer.caller"), ("-m", "tritrack"), ("-c", ASK), ("-m", "tritrack")):
        assert set(answer(house, *words).split()) == {"3"}
    assert kept(house)
    assert not [path for path in kept(house) if names_the_program(path)]


def test_no_function_of_ours_that_is_kept_names_the_program() -> None:
    warm()
    assert kept(compiled_folder())
    assert not [path for path in kept(compiled_folder()) if names_the_program(path)]


@pytest.mark.slow
def test_processes_that_compile_at_once_do_no_harm(house: Path) -> None:
    """The same signatures in two orders, so that they meet; each answer is its own kind's."""
    orders = [KINDS, KINDS[::-1], KINDS]
    at_once = [started(house, ("-c", ALL_KINDS, *kinds)) for kinds in orders]
    assert {said(process) for process in at_once} == {" ".join(["3.0"] * len(KINDS))}
    before = kept(house)
    assert len(before) >= 2 * len(KINDS) - 2
    assert answer(house, "-c", ALL_KINDS, *KINDS) == " ".join(["3.0"] * len(KINDS))
    assert kept(house) == before


def test_a_checkout_that_cannot_be_written_uses_the_users_folder(house: Path) -> None:
    (house / ".cache").write_text("no folder")
    assert answer(house, "-c", ASK) == "3"
    assert not kept(house)
    assert kept(house.parent / "user" / "tritrack")


@pytest.mark.slow
def test_half_a_file_is_compiled_anew(house: Path) -> None:
    answer(house, "-c", ASK)
    for left in (0, 100):
        for path in kept(house):
            path.write_bytes(path.read_bytes()[:left])
        assert answer(house, "-c", ASK) == "3"
        assert all(path.stat().st_size > left for path in kept(house))


@pytest.mark.parametrize("instead", ["", "; folder.write_text('no folder')"])
def test_a_folder_that_is_taken_away_meanwhile_does_no_harm(house: Path, instead: str) -> None:
    taken = (
        "import shutil; from common.cache_folder import compiled_folder; "
        f"folder = compiled_folder(); shutil.rmtree(folder){instead}; "
    )
    assert answer(house, "-c", taken + ASK) == "3"
    assert bool(kept(house)) != bool(instead)
