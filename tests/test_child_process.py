"""A child process that answers: small modules of this test's own, which die in every way."""

import fcntl
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil
import pytest

from common.child import child_process
from common.child.child_process import PIPE_BYTES, Broken, Child

ECHO = """
import os, sys
print("not an answer"); print("nor this", file=sys.stderr); sys.stdout.flush()
answers = int(sys.argv[1])
for line in sys.stdin:
    said = [line.strip()[::-1], *sys.argv[2:], str(os.getpgrp() == os.getpid())]
    os.write(answers, "|".join(said).encode())
"""
"""Answers a line with its letters the other way round, and what it was started with."""

Begin = Callable[..., Child]


@pytest.fixture
def begin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Begin]:
    """Starts a child of such a text; all are closed in the end."""
    children = []
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))

    def begun(text: str, stall_s: float = 20.0, **more: Any) -> Child:
        (tmp_path / "spoken.py").write_text(text)
        children.append(Child("spoken", stall_s, **more))
        return children[-1]

    yield begun
    for child in children:
        child.close()


def read(child: Child, count: int) -> bytes:
    buffer = bytearray(count)
    child.read_into(memoryview(buffer))
    return bytes(buffer)


@contextmanager
def broken(how: str) -> Iterator[None]:
    with pytest.raises(Broken) as caught:
        yield
    assert str(caught.value) == how


def test_it_answers_lines_and_gets_what_it_was_told_and_prints_to_no_one(
    begin: Begin, capfd: pytest.CaptureFixture[str]
) -> None:
    """It leads a group of its own, which a terminal's Ctrl-C does not reach."""
    child = begin(ECHO, told=("left", "right"))
    assert child.pid != os.getpid()
    assert not child.answers_within(0.0)
    for asked, due in ((b"abc", b"cba|left|right|True"), (b"12", b"21|left|right|True")):
        child.ask(asked)
        assert child.answers_within(20.0)
        assert read(child, len(due)) == due
    assert capfd.readouterr() == ("", "")
    child.close()
    assert not psutil.pid_exists(child.pid)


def test_who_waits_for_an_answer_waits_seconds(begin: Begin) -> None:
    child, began_s = begin("import time; time.sleep(60)"), time.monotonic()
    assert not child.answers_within(0.15)
    assert 0.15 <= time.monotonic() - began_s < 5.0
    assert not child.answers_within(-1.0)


def test_an_answer_that_comes_in_pieces_is_whole(begin: Begin) -> None:
    piece = "os.write(int(sys.argv[1]), b'%d' % n * 3); time.sleep(0.02)"
    child = begin(f"import os, sys, time\nfor n in range(4): {piece}")
    assert read(child, 12) == b"000111222333"


def test_a_child_that_gives_nothing_for_the_time_agreed_is_stuck_and_ended(begin: Begin) -> None:
    child = begin("import time; time.sleep(60)", stall_s=0.25)
    began_s = time.monotonic()
    with broken("it gave nothing for 0.25 s"):
        read(child, 3)
    assert 0.25 <= time.monotonic() - began_s < 5.0
    assert child._process.wait(5.0) == -9


@pytest.mark.parametrize(
    ("end", "how"),
    [
        ("sys.exit(3)", "exit code 3"),
        ("os.kill(os.getpid(), 15)", "killed by SIGTERM"),
        ("pass", "exit code 0"),
    ],
)
def test_how_a_child_died_is_said_to_who_reads_and_to_who_asks(
    begin: Begin, end: str, how: str
) -> None:
    child = begin(f"import os, sys\nos.write(int(sys.argv[1]), b'ab')\n{end}")
    with broken(how):
        read(child, 3)
    with broken(how):
        child.ask(b"more")


def test_a_child_that_closed_its_pipe_and_lives_is_ended(
    begin: Begin, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(child_process, "END_S", 0.05)
    child = begin("import os, sys, time\nos.close(int(sys.argv[1])); time.sleep(60)")
    with broken("it closed its pipe"):
        read(child, 1)
    assert child._process.wait(5.0) == -9


def test_who_is_killed_while_another_reads_ends_the_reading(begin: Begin) -> None:
    child = begin("import time; time.sleep(60)")
    child.kill()
    with broken("killed by SIGKILL"):
        read(child, 1)


def test_a_child_shares_the_files_that_it_is_given(begin: Begin, tmp_path: Path) -> None:
    (tmp_path / "shared").write_bytes(b"0123456789")
    with (tmp_path / "shared").open("rb") as shared:
        text = "import os, sys\nos.write(int(sys.argv[1]), os.read(int(sys.argv[2]), 4))"
        child = begin(text, told=(str(shared.fileno()),), files=(shared.fileno(),))
        assert read(child, 4) == b"0123"


def test_a_module_in_the_working_directory_is_not_run(
    begin: Begin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    strange = tmp_path / "strange"
    strange.mkdir()
    (strange / "json.py").write_text("raise SystemExit(9)")
    monkeypatch.chdir(strange)
    assert read(begin("import json, os, sys\nos.write(int(sys.argv[1]), b'ours')"), 4) == b"ours"


@pytest.mark.skipif(sys.platform != "linux", reason="Linux alone says how large a pipe is")
def test_a_child_may_run_ahead_by_a_megabyte_and_its_pipes_are_closed_with_it(
    begin: Begin,
) -> None:
    before = psutil.Process().num_fds()
    child = begin(ECHO)
    assert fcntl.fcntl(child._answers, fcntl.F_GETPIPE_SZ) == PIPE_BYTES
    assert psutil.Process().num_fds() == before + 2  # one to ask, one to hear
    child.close()
    assert psutil.Process().num_fds() == before


def test_a_child_is_forked_where_that_can_be_and_it_shares_no_files(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
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
    assert begun("m", 3, 4, ("x",), ()) == "forked"
    assert begun("m", 3, 4, ("x",), (7,)) == ("m", 3, 4, ("x",), (7,))
    assert begun("lost", 3, 4, ("x",), ()) == ("lost", 3, 4, ("x",), ())
    assert asked == [("m", 3, 4, ("x",)), ("lost", 3, 4, ("x",))]
    monkeypatch.setattr(child_process, "can_fork", lambda: False)
    assert begun("m", 3, 4, ("x",), ()) == ("m", 3, 4, ("x",), ())
    assert len(asked) == 2
