"""What CI tries: a Python that is not installed is never taken for one that was tried, and no test
that is asked for lies in a file that is not imported."""

import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from conftest import pytest_ignore_collect, refuse_marks_of_elsewhere

ROOT = Path(__file__).parents[1]


def script(path: Path, text: str = "exit 0") -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """A checkout that wants Pythons which nobody has, on a machine whose tests all pass."""
    shutil.copytree(ROOT / ".ci", tmp_path / ".ci")
    (tmp_path / "Makefile").write_text("NEWER := 3.98 3.99\n")
    script(tmp_path / ".venv" / "bin" / "python")
    script(tmp_path / "bin" / "chromium")
    script(tmp_path / "bin" / "make", f'echo "$*" >> {tmp_path}/made')
    return tmp_path


def test_what_is_installed_is_compiled_where_it_is_imported_and_kept(machine: Path) -> None:
    """Thousands of files that no test imports take minutes."""
    says = '"pip $PIP_COMPILE, python ${PYTHONDONTWRITEBYTECODE-as the machine says}"'
    script(machine / "bin" / "make", f"echo {says} >> {machine}/said")
    run(machine, "run")
    assert set((machine / "said").read_text().splitlines()) == {"pip 0, python "}


def run(machine: Path, *command: str) -> subprocess.CompletedProcess[str]:
    path = f"{machine / 'bin'}:/usr/bin:/bin"
    return subprocess.run(
        [str(machine / ".ci" / command[0]), *command[1:]],
        env={"PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_python_that_is_missing_fails_and_that_is_said(machine: Path) -> None:
    ended = run(machine, "matrix", "3.99")
    assert ended.returncode == 1
    assert "Python 3.99 is not installed, so nothing was tested under it" in ended.stderr
    assert not (machine / "made").exists()


def test_a_command_that_refuses_to_run_is_no_python(machine: Path) -> None:
    """As pyenv's is of a version that is not chosen."""
    script(machine / "bin" / "python3.99", "exit 127")
    assert run(machine, "matrix", "3.99", "find").returncode == 1
    script(machine / "bin" / "python3.99")
    found = run(machine, "matrix", "3.99", "find")
    assert (found.returncode, found.stdout) == (0, f"{machine / 'bin' / 'python3.99'}\n")


@pytest.mark.parametrize(
    ("there", "last"),
    [
        ([], "NO NEWER PYTHON WAS TRIED: this machine has none of 3.98 3.99"),
        (["3.98"], "Tried under Python 3.98; not installed here, so NOT TRIED: 3.99"),
        (["3.98", "3.99"], ""),
    ],
    ids=["none", "one of two", "both"],
)
def test_the_last_line_of_ci_says_what_was_not_tried(
    machine: Path, there: list[str], last: str
) -> None:
    for version in there:
        script(machine / "bin" / f"python{version}")
    ended = run(machine, "run")
    assert ended.returncode == 0, ended.stderr
    assert "\n".join(ended.stdout.splitlines()[-1:]) == last
    made = (machine / "made").read_text().splitlines()
    assert (
        made[0] == f"-j 4 --output-sync everything check collected matrix NEWER={' '.join(there)}"
    )


SLOW, BOTH = "@pytest.mark.slow\n", "pytestmark = [pytest.mark.slow, pytest.mark.live]\n"


@pytest.mark.parametrize(
    ("asked", "text", "left_out"),
    [
        ("slow and not live", SLOW, False),
        ("slow and not live", BOTH, False),
        ("slow and not live", "def test_it() -> None:\n", True),
        ("live", BOTH, False),
        ("live", SLOW, True),
        ("not slow", SLOW, False),
        ("slow or live", SLOW, False),
        ("", "", False),
    ],
)
def test_only_a_file_without_a_mark_that_is_asked_for_is_not_imported(
    tmp_path: Path, asked: str, text: str, left_out: bool
) -> None:
    file = tmp_path / "test_it.py"
    file.write_text(text)
    config: Any = SimpleNamespace(option=SimpleNamespace(markexpr=asked))
    assert bool(pytest_ignore_collect(file, config)) == left_out
    assert not pytest_ignore_collect(tmp_path, config)


def test_a_mark_that_is_not_in_the_file_of_its_test_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "test_it.py"
    item: Any = SimpleNamespace(
        path=file, nodeid="test_it.py::test_it", get_closest_marker=lambda mark: mark == "live"
    )
    file.write_text(BOTH)
    refuse_marks_of_elsewhere([item])
    file.write_text(SLOW)
    with pytest.raises(pytest.UsageError, match=r"test_it\.py::test_it: write its mark"):
        refuse_marks_of_elsewhere([item])
