"""The README as a test: what it prints is typed, in its order, in a fresh copy of the checkout.

Its commands are the lines of its indented blocks. Where the product needs cameras or other hosts,
the README speaks of a command in its text, and nothing here runs it.
"""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import distribution
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, NamedTuple
from urllib.request import HTTPCookieProcessor, build_opener

import numpy as np
import pytest
from installing import needed, pip, put_into, refuse_without_network
from source_map import tracked
from visiting import visited

from common.cache_folder import compiled_folder

ROOT: Final = Path(__file__).parents[1]
COMMAND: Final = re.compile(r"^ {4}(\S.*)$", re.MULTILINE)
FENCED: Final = re.compile(r"^```.*?^```$", re.DOTALL | re.MULTILINE)
LIMIT_S: Final = 900.0
"""Who takes longer hangs; the installation is the longest."""
PORTS: Final = (8080, 7447)
"""Of the page and the bus, where a settings file names no others."""
PAGE: Final = re.compile(r"the page is at (http://\S+);")


class Result(NamedTuple):
    """What a command leaves behind."""

    files: tuple[str, ...] = ()
    """Patterns, from the copy's folder; of each there is a file, and none is empty."""
    says: str = ""
    """A pattern of what it prints."""


RESULTS: Final = {
    "make demo": Result(("runs/demo/poses.npz", "runs/demo/posture.json"), "posture: raise_right"),
    "tritrack start": Result(says="the page is at"),
    "tritrack doctor": Result(says="matching kernel"),
    "tritrack synth --out clips": Result(
        ("clips/calibration.json", "clips/s0*/cam1.avi", "clips/s0*/cam2.avi")
    ),
    "tritrack synth --out scenes": Result(("scenes/people2_s00_t1/truth.npz",), "1 clip written"),
    "tritrack track clips": Result(("runs/s0*/poses.npz", "runs/s0*/summary.json")),
    "tritrack track scenes": Result(("runs/people2_s00_t1/poses.npz",), "1 clip tracked"),
    "tritrack report": Result(("runs/s00_t1_12_squat/report.html",)),
    "tritrack live clips": Result(
        ("runs/live/poses.npz", "runs/live/posture.json"), "posture: squat"
    ),
    "tritrack live configs": Result(("runs/1/poses.npz", "runs/1/posture.json"), "posture: squat"),
    "tritrack single": Result(
        ("runs/cam1/poses.npz", "runs/cam1/body.bvh", "runs/cam1/overlay.mp4")
    ),
    "tritrack retouch": Result(says="then fit the video again"),
    "tritrack export": Result(("runs/cam1/poses.csv",), "frames written"),
    "tritrack evaluate tracking": Result(("report/tracking/report.html",), r"mean \d\d\.\d mm"),
    "tritrack train clips/*/": Result(("postures.npz",), "2 postures learnt, 2 known"),
    "tritrack evaluate postures": Result(("report/postures/report.html",), r"all: \d/2"),
    "tritrack calibrate person": Result(("calibration.json",), "cam2"),
    "tritrack calibrate markers": Result(says="cam2"),
    "tritrack calibrate poles": Result(("example_calibration.json",), "cam2"),
}
"""By how a command begins; every command of the README is here."""

FEW: Final = {
    "tritrack track clips": "s0[01]*squat",
    "tritrack evaluate tracking": "s02*squat",
    "tritrack train clips/*/": "s00*",
    "tritrack calibrate person": "s00*",
}
"""Commands that need no more of the clips than these, whatever the README's pattern would take: of
the others the same is asked by another command."""
ENDLESS: Final = ("tritrack start", "tritrack retouch")
"""Pages that serve until Ctrl-C: each is fetched once, then ended so."""
LIVE: Final = ("tritrack live",)
"""Runs with a page, which somebody opens as soon as its address is printed; the demo goes on alone
when nobody came for half a minute.
"""


def commands() -> list[str]:
    """All indented lines; programs stand between fences."""
    typed_ones = FENCED.sub("", (ROOT / "README.md").read_text())
    return [line.strip() for line in COMMAND.findall(typed_ones)]


def result_of(command: str) -> Result:
    (found,) = [result for start, result in RESULTS.items() if command.startswith(start)]
    return found


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """What is under version control as it stands, alone in a folder.

    What these sources were compiled to comes with it, where that is known: `test_system_wheel.py`
    compiles it anew.
    """
    folder = tmp_path / "tritrack"
    for path in tracked(ROOT):
        new = folder / path.relative_to(ROOT)
        new.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(path, new)
    shutil.copytree(compiled_folder(), folder / ".cache" / compiled_folder().name)
    return folder


@pytest.fixture
def shell(copy: Path, tmp_path: Path) -> Iterator[dict[str, str]]:
    """A user's environment: no cache but pip's, no virtual environment but the one to be made.

    The libraries that it is to have lie in it already, where this environment has them.
    """
    refuse_without_network(tmp_path)
    extras = re.findall(r"^EXTRAS := (\S+)$", (ROOT / "Makefile").read_text(), re.MULTILINE)
    version = ".".join(map(str, sys.version_info[:2]))
    site = copy / ".venv" / "lib" / f"python{version}" / "site-packages"
    site.mkdir(parents=True)
    put_into(site, needed(distribution("tritrack").requires or (), extras[0].split(",")).values())
    for port in PORTS:
        with socket.socket() as door:
            if door.connect_ex(("127.0.0.1", port)) == 0:
                pytest.skip(f"another program holds port {port}, which the README's commands use")
    ours = {"VIRTUAL_ENV", "TRITRACK_DATA", "TRITRACK_LOG", "NUMBA_CACHE_DIR", "PYTHONPATH"}
    inherited = {name: value for name, value in os.environ.items() if name not in ours}
    here = str(Path(sys.executable).parent)
    places = [place for place in os.environ["PATH"].split(os.pathsep) if place != here]
    with TemporaryDirectory() as short:  # as a user's is: sockets have names of 107 letters at most
        yield inherited | {
            "PATH": os.pathsep.join([str(copy / ".venv/bin"), *places]),
            "PIP_COMPILE": "0",  # but what is imported, which Python does then
            "PIP_CACHE_DIR": pip("cache", "dir").stdout.strip(),
            "XDG_CACHE_HOME": str(tmp_path / "cache"),
            "TMPDIR": short,
        }


def typed(command: str, copy: Path, shell: dict[str, str]) -> tuple[int, str]:
    """Exit code and all that a command printed."""
    with subprocess.Popen(
        ["sh", "-c", f"exec {command}"],
        cwd=copy,
        env=shell,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    ) as process:
        said = ""
        if command.startswith(ENDLESS):
            said = fetched(process)
            os.killpg(process.pid, signal.SIGINT)
        elif command.startswith(LIVE):
            assert process.stdout is not None
            said = visited(process.stdout)
        said += process.communicate(timeout=LIMIT_S)[0]
        return process.returncode, said


def fetched(process: subprocess.Popen[str]) -> str:
    """What was printed until the address of a page, which then answers."""
    assert process.stdout is not None
    said = ""
    for line in process.stdout:
        said += line
        address = PAGE.search(said)
        if address:
            browser = build_opener(HTTPCookieProcessor())  # which keeps the token of an address
            with browser.open(address[1], timeout=LIMIT_S) as page:
                assert page.status == 200
            break
    return said


@contextmanager
def others_aside(command: str, copy: Path) -> Iterator[None]:
    """The clips that a command of `FEW` is not to see lie elsewhere meanwhile."""
    kept = next((few for start, few in FEW.items() if command.startswith(start)), "s*")
    clips, aside = copy / "clips", copy / "aside"
    others = {path.name for path in clips.glob("s*")} - {path.name for path in clips.glob(kept)}
    aside.mkdir()
    for name in others:
        (clips / name).rename(aside / name)
    yield
    for name in others:
        (aside / name).rename(clips / name)
    aside.rmdir()


def posed_rows(path: Path) -> int:
    with np.load(path, allow_pickle=False) as poses:
        return int(np.isfinite(poses["joints_m"]).all(axis=(1, 2)).sum())


def wrong_with(result: Result, copy: Path, said: str) -> Iterator[str]:
    """What a command should have left behind and did not."""
    if not re.search(result.says, said):
        yield f"nothing like {result.says!r} was said"
    for pattern in result.files:
        files = sorted(copy.glob(pattern))
        if not files:
            yield f"there is no {pattern}"
        yield from (f"{path} is empty" for path in files if not path.stat().st_size)
        poses = [path for path in files if path.name == "poses.npz"]
        yield from (f"{path} has no poses" for path in poses if posed_rows(path) < 30)


def test_every_command_of_the_readme_is_known_here() -> None:
    """A new example is run only if it is told what it leaves behind."""
    assert commands()[0].startswith("make demo")
    assert [result_of(command) for command in commands()] == list(RESULTS.values())


def test_the_first_command_says_what_goes_on_before_anything_that_takes_long(copy: Path) -> None:
    planned = subprocess.run(
        ["make", "--no-print-directory", "--dry-run", "demo"],
        cwd=copy,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.splitlines()
    (told,) = [i for i, line in enumerate(planned) if "libraries into .venv" in line]
    assert told < min(i for i, line in enumerate(planned) if " -m " in line)
    assert all("command -v" in line for line in planned[:told])


@pytest.mark.slow
def test_the_commands_of_the_readme_work_one_after_the_other(
    copy: Path, shell: dict[str, str]
) -> None:
    for command in commands():
        with others_aside(command, copy):
            code, said = typed(command, copy, shell)
        assert code == 0, f"{command} ended with {code}:\n{said}"
        assert "Traceback" not in said, f"{command}:\n{said}"
        assert not list(wrong_with(result_of(command), copy, said)), f"{command}:\n{said}"
    assert list(Path(shell["TMPDIR"]).iterdir()) == []
