"""Which process works in a folder: one that is over, or another of its number, does not."""

import os
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from common.folder_owner import other_owner, take


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "owner"


def test_another_process_that_runs_is_named_and_this_one_is_not(file: Path) -> None:
    assert other_owner(file) is None
    take(file)
    assert other_owner(file) is None
    file.write_text(str(os.getppid()))
    assert other_owner(file) == os.getppid()


def test_a_process_that_began_later_has_its_number_by_chance(file: Path) -> None:
    file.write_text(str(os.getppid()))
    before_s = psutil.Process(os.getppid()).create_time() - 5.0
    os.utime(file, (before_s, before_s))
    assert other_owner(file) is None


def test_a_process_that_is_over_or_killed_works_nowhere(file: Path) -> None:
    killed = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    file.write_text(str(killed.pid))
    assert other_owner(file) == killed.pid
    killed.kill()
    os.waitid(os.P_PID, killed.pid, os.WEXITED | os.WNOWAIT)
    assert other_owner(file) is None, "it is not waited for yet"
    killed.communicate()
    assert other_owner(file) is None


@pytest.mark.parametrize("text", ["", "no number", "-1", "99999999999"])
def test_what_names_no_process_is_nobodys(file: Path, text: str) -> None:
    file.write_text(text)
    assert other_owner(file) is None
