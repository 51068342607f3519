"""The house rules that a reader relies on: arrows between packages, names, and the list of ids."""

import ast
import importlib
import re
import subprocess
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BELOW = {
    "common": set[str](),
    **{name: {"common"} for name in ("viewer", "integrator", "recognizer", "animator", "synth")},
    "tritrack": {"viewer", "integrator", "recognizer", "animator", "synth", "common"},
}
"""Which of our packages each may import."""
IDS = [
    *(f"C{n}" for n in range(1, 9)),
    *(f"M{n}" for n in range(1, 26)),
    *(f"P{n}" for n in range(1, 61)),
    *(f"T{n}" for n in range(1, 29)),
]
ROW = re.compile(r"^\| ([CMPT]\d+) \| (.+?) \| (.+?) \| (.+?) \|$", re.MULTILINE)
PLACE = re.compile(r"`([\w/]+\.\w+)(?: \((\w+)\))?`")
TEST = re.compile(r"`(test_\w+\.py)::(test_\w+)`")


def tracked() -> list[Path]:
    """Files under version control; in an unpacked copy, every file that is no by-product."""
    try:
        listed = subprocess.run(
            ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True, text=True
        ).stdout.split("\0")
        return [ROOT / name for name in listed if name and (ROOT / name).is_file()]
    except (OSError, subprocess.CalledProcessError):
        made = {".git", ".venv", ".cache", "runs", "dist", "__pycache__", ".hypothesis"}
        return [p for p in ROOT.rglob("*") if p.is_file() and not made & set(p.parts)]


def imported(path: Path) -> set[str]:
    """Our packages that a file imports, anywhere in it."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            names.add(node.module or "")
    return {name.split(".")[0] for name in names} & set(BELOW)


@pytest.mark.parametrize("package", BELOW)
def test_imports_go_downwards_only(package: str) -> None:
    """tritrack -> viewer, integrator, recognizer, animator, synth -> common; no arrow across."""
    files = sorted((ROOT / package).rglob("*.py"))
    assert files
    for path in files:
        assert imported(path) - {package} <= BELOW[package], path


def test_no_file_name_occurs_twice() -> None:
    names = Counter(path.name for path in tracked() if path.suffix == ".py")
    twice = {name for name, times in names.items() if times > 1}
    assert twice <= {"__init__.py", "__main__.py"}


def test_every_file_says_what_it_is_in_its_first_line() -> None:
    for path in tracked():
        if path.suffix == ".py":
            first = path.read_text().split("\n", 1)[0]
            assert re.match(r'r?"""\S', first), path


@pytest.mark.parametrize("name", [*BELOW, "tests", "configs", "docs"])
def test_the_folders_are_at_the_top(name: str) -> None:
    assert (ROOT / name).is_dir()


@pytest.mark.parametrize("package", BELOW)
def test_a_package_is_typed_and_comes_from_here_alone(package: str) -> None:
    """Published packages of the same name are not merged with ours."""
    module = importlib.import_module(package)
    assert (ROOT / package / "py.typed").is_file()
    assert [Path(place).resolve() for place in module.__path__] == [ROOT / package]
    assert module.__file__ is not None
    assert Path(module.__file__).resolve() == ROOT / package / "__init__.py"


def test_nothing_names_one_machine() -> None:
    """No folder of a host, no registry: what is needed comes from settings and from pip."""
    folders = "|".join(("work", "root", "home", "Users", "mnt"))
    machine = re.compile(rf"(?<![\w.$}}])/(?:{folders})/\w")
    registry = re.compile("index" + "-url|find" + "-links|https?://[^ ]*/simp" + "le\\b")
    for path in tracked():
        try:
            text = path.read_text()
        except UnicodeDecodeError:
            continue
        assert not machine.search(text), path
        assert not registry.search(text), path


def rows() -> list[tuple[str, str, str, str]]:
    found: list[tuple[str, str, str, str]] = ROW.findall(
        (ROOT / "docs/requirements.md").read_text()
    )
    return found


def test_every_id_is_listed_once_in_order() -> None:
    assert [row[0] for row in rows()] == IDS


@pytest.mark.parametrize("row", rows(), ids=[row[0] for row in rows()])
def test_what_is_listed_of_an_id_is_there(row: tuple[str, str, str, str]) -> None:
    """Every file, function or name in it, and test that docs/requirements.md names exists."""
    name, what, where, proof = row
    assert len(what) > 5
    places, tests = PLACE.findall(where), TEST.findall(proof)
    assert places or where in {"later", "-"}, f"{name} says neither where nor later"
    assert tests or proof in {"later", "-"}, f"{name} has neither a test nor later"
    for path, inside in places:
        text = (ROOT / path).read_text()
        assert not inside or re.search(rf"(def|class) {inside}\b|^{inside}\b", text, re.MULTILINE)
    for path, test in tests:
        assert f"def {test}(" in (ROOT / "tests" / path).read_text(), f"{path}::{test}"
