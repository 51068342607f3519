"""The house rules that a reader relies on: arrows between packages, names, and the list of ids."""

import importlib
import os
import re
import runpy
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path

import pytest
from source_map import Source, arrows, circles, pointing, room_of, sources, tracked

ROOT = Path(__file__).parents[1]
STEPS = ("viewer", "recognizer", "animator", "synth")
BELOW = {
    "common": set[str](),
    "calibration": {"common"},
    **{name: {"common"} for name in STEPS},
    "integrator": {"calibration", "common"},
    "runtime": {*STEPS, "integrator", "calibration", "common"},
    "lab": {*STEPS, "integrator", "calibration", "common", "runtime"},
    "tritrack": {*STEPS, "integrator", "calibration", "common", "runtime", "lab"},
}
"""Which of our packages each may import."""
HEAVY = (
    *("matplotlib", "sklearn", "hmmlearn", "joblib", "distributed", "dask", "torch"),
    *("zenoh", "viser", "skimage", "tomlkit", "prometheus_client"),
)
"""What only some commands need."""
IDS = [
    *(f"C{n}" for n in range(1, 9)),
    *(f"M{n}" for n in range(1, 26)),
    *(f"P{n}" for n in range(1, 61)),
    *(f"T{n}" for n in range(1, 29)),
]
LINUX = "common/platform/linux"
"""The platform that uses what only Linux has."""
OF_LINUX = re.compile(
    r"\bfcntl\b|\bos\.fork\b|\bprctl\b|/proc\b|memfd|pthread_sigmask|forkserver|waitpid"
)
OF_LINUX_ELSEWHERE = {"lab/bench/bench.py": "/proc", "tritrack/commands/options.py": "/proc"}
"""Names of that which other files may have: the bench says which processor it ran on, the options
speak of a folder that is none."""
HIDING = """
import importlib, importlib.abc, os, signal, sys

class Hidden(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] in {"fcntl", "runtime", "lab", "tritrack"}:
            raise ModuleNotFoundError(f"{name} is hidden", name=name)

import cv2, msgspec, multiprocessing, numba, scipy, subprocess  # they may know of fcntl
sys.modules.pop("fcntl", None)
sys.meta_path.insert(0, Hidden())
del os.fork, signal.pthread_sigmask
for name in sys.argv[1:]:
    try:
        importlib.import_module(name)
    except (ImportError, AttributeError) as error:
        print(f"{name}: {error}")
"""
"""Imports what it is given where a system has no such calls, and prints what that cannot be done
with."""
ROW = re.compile(r"^\| ([CMPT]\d+) \| (.+?) \| (.+?) \| (.+?) \|$", re.MULTILINE)
PLACE = re.compile(r"`([\w/]+\.\w+)(?: \((\w+)\))?`")
TEST = re.compile(r"`(test_\w+\.py)::(test_\w+)`")
NAMED = re.compile(r"`((?:[\w.-]+/)+(?:\w+\.\w+)?)(?: \((\w+)\))?`")
"""A file or folder in running text, and what in it is spoken of."""


SYSTEM = {
    "docs": "the documentation: what it quotes, what it types, the site that it makes",
    "layout": "the rules of the house, this file",
    "readme": "the README, typed as it stands in a fresh copy",
    "system_commands": "every command as a user calls it",
    "system_fall": "somebody who falls, from a clip to the joints, and what it leaves of the rig",
    "system_full_disk": "a disk that takes no more, from the first message to the resumed run",
    "system_hosts": "containers and units of a rig over hosts: what they start is there",
    "system_live_view": "a live view's frames: decoder, clock and landmarks from outside by hand",
    "system_live_pictures": "live runs that keep their pictures, and the clip that they leave",
    "system_live_fallback": "live runs that lose a view: real processes that are killed or frozen",
    "system_lost_view": "both viewers and the integrator in lock-step, then one of them alone",
    "system_many_views": "the fusion of landmarks of three views and more",
    "system_matrix": "what CI says of the Pythons that it lacks",
    "system_meeting": "how the processes of a run wait for each other",
    "system_viewer": "the viewer's loop, and how it starts: frames, guides and clock by hand",
    "system_viewer_frame": "one frame of a viewer before a background of its own",
    "system_three_cameras": "live runs of three cameras, which lose one or two and get them back",
    "system_wheel": "the wheel, installed beside files of the same names",
    "system_namespaces": "a room on four simulated hosts: their clocks, slow, lossy and cut cables",
    "system_seeds": "what a seed makes of people, motions, rigs, rooms and pictures",
    "system_puppet": "bodies of the Anny model where it is not installed: a puppet of its bones",
    "system_naming": "from a clip to the name of its posture",
}
"""Tests of more than one module; every other file of tests bears its module's name."""
MOST_LINES = 300
"""Of a file."""
MOST_FILES = 15
"""Of a folder: more are a heap, no longer a list."""


@pytest.fixture(scope="module")
def found() -> list[Source]:
    return sources(ROOT)


def test_imports_go_downwards_only(found: list[Source]) -> None:
    """tritrack -> lab -> runtime -> integrator -> calibration -> common, none across."""
    assert {each.package for each in found} == set(BELOW)
    for importer, file in arrows(ROOT, found):
        above, below = importer.parts[0], file.parts[0]
        assert below == above or below in BELOW[above], f"{importer} imports {file}"


def test_no_imports_turn_in_circles(found: list[Source]) -> None:
    """Neither of files nor of the folders in a package."""
    between = arrows(ROOT, found)
    assert circles(pointing((str(a), str(b)) for a, b in between)) == []
    rooms = ((room_of(a), room_of(b)) for a, b in between)
    assert circles(pointing((a, b) for a, b in rooms if a != b)) == []


def test_what_lies_below_the_shells_is_imported_where_no_process_can_be_forked(
    found: list[Source],
) -> None:
    """By itself, and without what runs it; all but the platform that uses that."""
    rooms = {"common", "calibration", "viewer", "integrator", "recognizer"}
    names = {
        ".".join(each.path.with_suffix("").parts).removesuffix(".__init__")
        for each in found
        if each.package in rooms and each.folder != LINUX
    }
    assert in_vain(names) == []
    assert in_vain({"common.platform.linux.linux_platform"}) != []


def test_what_only_linux_has_is_named_in_its_platform_alone(found: list[Source]) -> None:
    for each in found:
        named = set(OF_LINUX.findall((ROOT / each.path).read_text()))
        allowed = {OF_LINUX_ELSEWHERE.get(each.path.as_posix(), "")}
        assert each.folder == LINUX or named <= allowed, f"{each.path} names {named}"


def test_no_file_but_the_platforms_table_knows_which_platform_it_is_on(
    found: list[Source],
) -> None:
    inside = {each.path for each in found if each.folder.startswith("common/platform")}
    for importer, file in arrows(ROOT, found):
        public = file.stem in {"__init__", "platform", "platforms"}
        assert importer in inside or file not in inside or public, f"{importer} imports {file}"


def in_vain(names: set[str]) -> list[str]:
    """Which of our modules cannot be imported where HIDING hides."""
    asked = [sys.executable, "-c", HIDING, *sorted(names)]
    got = subprocess.run(asked, cwd=ROOT, capture_output=True, text=True, check=True)
    return [line.partition(":")[0] for line in got.stdout.splitlines()]


def test_every_folder_is_a_package_that_says_what_it_is(found: list[Source]) -> None:
    """In the first line of its `__init__.py`, as every file does."""
    named = {each.folder for each in found if each.path.name == "__init__.py"}
    assert {each.folder for each in found} == named


def test_no_folder_is_a_heap(found: list[Source]) -> None:
    files = Counter(each.folder for each in found)
    assert {folder: n for folder, n in files.items() if n > MOST_FILES} == {}


@pytest.mark.parametrize(
    ("counted", "usual", "share", "most"),
    [("code_lines", 20, 0.95, 45), ("nesting", 3, 0.98, 5), ("parameters", 6, 0.99, 9)],
)
def test_functions_are_small_but_for_a_few(
    found: list[Source], counted: str, usual: int, share: float, most: int
) -> None:
    """Rule 7 of CONTRIBUTING.md. Options are a command's parameters, as arrays are a kernel's."""
    given = [each for source in found for each in source.functions]
    if counted == "parameters":
        given = [each for each in given if each.kind == "plain"]
    sizes = {each.place: getattr(each, counted) for each in given}
    assert {place: n for place, n in sizes.items() if n > most} == {}
    long = sorted((each for each in sizes if sizes[each] > usual), key=lambda each: -sizes[each])
    assert len(long) <= (1.0 - share) * len(given), long[:10]


def test_no_file_is_longer_than_one_can_hold(found: list[Source]) -> None:
    lengths = {each.path: len((ROOT / each.path).read_text().splitlines()) for each in found}
    assert {path: n for path, n in lengths.items() if n > MOST_LINES} == {}


def test_rule_7_names_what_is_held() -> None:
    """The numbers of both tests above, and of folders, as CONTRIBUTING.md has them."""
    rule = re.search(r"^7\. (.+?)^8\. ", (ROOT / "CONTRIBUTING.md").read_text(), re.M | re.DOTALL)
    assert rule is not None
    told = [int(n) for n in re.findall(r"\d+", rule[1])]
    assert told == [100, 95, 20, 98, 3, 99, 6, 45, 5, 9, MOST_LINES, MOST_FILES]


def test_a_test_bears_the_name_of_what_it_tests() -> None:
    paths = [path.relative_to(ROOT) for path in tracked(ROOT) if path.suffix == ".py"]
    modules = {path.stem for path in paths if path.parts[0] != "tests"}
    tests = {path.stem.removeprefix("test_") for path in paths if path.stem.startswith("test_")}
    assert tests - modules == set(SYSTEM)


def test_what_tests_are_rewritten_to_is_kept_whatever_the_machine_says(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Else each process of each run rewrites all of them."""
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    runpy.run_path(str(ROOT / "tests/conftest.py"))
    assert not sys.dont_write_bytecode
    assert "PYTHONDONTWRITEBYTECODE" not in os.environ


def test_newer_pythons_are_tried_with_tests_that_are_there() -> None:
    listed = re.search(
        r"^core=\((.+?)\)", (ROOT / ".ci/matrix").read_text(), re.DOTALL | re.MULTILINE
    )
    assert listed is not None
    names = listed[1].split()
    assert names
    assert [name for name in names if not (ROOT / f"tests/test_{name}.py").is_file()] == []


@pytest.mark.parametrize(
    ("module", "heavy"),
    [
        ("tritrack.__main__", {*HEAVY, "filterpy", "numba", "cv2", "scipy"}),
        ("runtime.offline.lockstep", {*HEAVY, "filterpy", "scipy.optimize", "scipy.stats"}),
        ("viewer.__main__", {*HEAVY, "filterpy"} - {"zenoh"}),
        ("recognizer.__main__", {*HEAVY, "filterpy"} - {"zenoh"}),
    ],
    ids=["help", "track", "viewer", "recognizer"],
)
def test_nothing_heavy_is_imported_before_it_is_needed(module: str, heavy: set[str]) -> None:
    code = f"import sys, {module}; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, check=True, text=True
    )
    assert heavy.isdisjoint(done.stdout.split())


@pytest.mark.slow
def test_filterpy_is_imported_as_the_integrator_is_warmed_up() -> None:
    """A second's import, for a view alone: in the midst of a run it would be missed frames."""
    code = (
        "import sys; from common.config.settings import Settings; "
        "from integrator.integrator_warmup import warm_up; "
        "warm_up(Settings(), (160, 120)); print(*sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, check=True, text=True
    )
    assert "filterpy.kalman" in done.stdout.split()


def test_a_plain_installation_brings_the_five_given_packages() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    base = {re.split(r"[<>=]", each)[0] for each in project["dependencies"]}
    given = {"numpy", "opencv-python-headless", "eclipse-zenoh", "hmmlearn", "filterpy"}
    assert given <= base


def test_only_one_file_has_functions_compiled() -> None:
    """Through numba's own decorators a function would keep its code when a callee changes."""
    for package in BELOW:
        for path in (ROOT / package).rglob("*.py"):
            compiles = re.search(r"(@|numba\.|numba import )n?jit\b", path.read_text())
            assert not compiles or path.name == "compiled.py", path


def test_no_file_name_occurs_twice() -> None:
    names = Counter(path.name for path in tracked(ROOT) if path.suffix == ".py")
    twice = {name for name, times in names.items() if times > 1}
    asked_for = {"pictures.py"}  # of the benchmarks, by this name
    assert twice <= {"__init__.py", "__main__.py"} | asked_for


def test_every_file_says_what_it_is_in_its_first_line() -> None:
    for path in tracked(ROOT):
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
    for path in tracked(ROOT):
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


def is_there(path: str, inside: str) -> bool:
    """Whether a file, or a folder, exists, and what is named of a file is defined in it."""
    place = ROOT / path
    if not inside:
        return place.is_dir() if path.endswith("/") else place.is_file()
    defined = re.compile(rf"(def|class) {inside}\b|^{inside}\b", re.MULTILINE)
    return place.is_file() and bool(defined.search(place.read_text()))


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md", "docs/architecture.md"])
def test_what_a_page_points_to_is_there(page: str) -> None:
    """Every file and folder that it names, every name in a file, every link to a file of ours."""
    text = (ROOT / page).read_text()
    named = NAMED.findall(text)
    assert named
    assert [place for place in named if not is_there(*place)] == []
    links = re.findall(r"\]\((?!http)([^)#]+)\)", text)
    assert [link for link in links if not (ROOT / page).parent.joinpath(link).is_file()] == []


@pytest.mark.parametrize("row", rows(), ids=[row[0] for row in rows()])
def test_what_is_listed_of_an_id_is_there(row: tuple[str, str, str, str]) -> None:
    """Every file, function or name in it, and test that docs/requirements.md names exists."""
    name, what, where, proof = row
    assert len(what) > 5
    places, tests = PLACE.findall(where), TEST.findall(proof)
    assert places or where in {"later", "-"}, f"{name} says neither where nor later"
    assert tests or proof in {"later", "-"}, f"{name} has neither a test nor later"
    for path, inside in places:
        assert is_there(path, inside), f"{path} ({inside})"
    for path, test in tests:
        assert f"def {test}(" in (ROOT / "tests" / path).read_text(), f"{path}::{test}"
