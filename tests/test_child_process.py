"""A child process as Linux begins it: a group and a pipe of its own, forked where that can be."""

import fcntl
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

from common.platform.linux import child_process
from common.platform.linux.child_process import PIPE_BYTES, ChildProcess
from common.platform.platform import Broken

ANSWERS = """
import os
def main(asker):
    for line in asker.requests:
        os.write(asker.answers.fileno(), repr([line, os.getpgrp() == os.getpid()]).encode())
        if line.startswith(b"deaf"):
            asker.answers.close()
            import time; time.sleep(60)
"""


@pytest.fixture
def child(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ChildProcess]:
    (tmp_path / "spoken.py").write_text(ANSWERS)
    monkeypatch.setenv(
        "PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    )
    one = ChildProcess("spoken", 20.0)
    yield one
    one.close()


def read(child: ChildProcess, due: bytes) -> bytes:
    buffer = bytearray(len(due))
    child.read_into(memoryview(buffer))
    return bytes(buffer)


def test_it_leads_a_group_of_its_own_which_the_ctrl_c_of_a_terminal_does_not_reach(
    child: ChildProcess,
) -> None:
    child.ask(b"x")
    assert read(child, due := b"[b'x\\n', True]") == due


def test_a_child_that_closed_its_pipe_and_lives_is_ended(
    child: ChildProcess, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(child_process, "END_S", 0.05)
    child.ask(b"deaf")
    read(child, b"[b'deaf\\n', True]")
    with pytest.raises(Broken, match=r"^it closed its pipe$"):
        read(child, b".")
    assert child._process.wait(5.0) == -9


def test_it_may_run_ahead_by_a_megabyte_and_all_that_is_open_is_closed_with_it(
    child: ChildProcess,
) -> None:
    assert fcntl.fcntl(child._answers, fcntl.F_GETPIPE_SZ) == PIPE_BYTES
    before = psutil.Process().num_fds()
    other = ChildProcess("spoken", 20.0, (64, 48))
    assert psutil.Process().num_fds() == before + 3  # one to ask, one to hear, the memory's map
    other.close()
    assert psutil.Process().num_fds() == before


def test_a_child_is_forked_where_that_can_be(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def forked(*arguments: object) -> str:
        asked.append(arguments)
        if arguments[0] == "lost":
            raise EOFError
        return "forked"

    monkeypatch.setattr(child_process, "ForkedChild", forked)
    monkeypatch.setattr(child_process, "_executed", lambda *arguments: arguments)
    monkeypatch.setattr(child_process, "can_fork", lambda: True)
    begun: Any = child_process._begun
    assert begun("m", 3, 4) == "forked"
    assert begun("lost", 3, 4) == ("lost", 3, 4)
    assert asked == [("m", 3, 4), ("lost", 3, 4)]
    monkeypatch.setattr(child_process, "can_fork", lambda: False)
    assert begun("m", 3, 4) == ("m", 3, 4)
    assert len(asked) == 2
