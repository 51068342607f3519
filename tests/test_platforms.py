"""What is asked of every platform, and that each gives it: real processes, which die in every way.

Children and workers are small modules of this test's own.
"""

import ast
import contextlib
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from test_own_process import SOON_S, ended_within, written
from worker_jobs import heeds, says, sleeps

from common.config.part_settings import SettingsError
from common.packages import PACKAGES, ROOT
from common.platform import platforms
from common.platform.platform import Broken, Child, Job, Platform
from common.platform.platforms import CHOICE, PLATFORMS, platform

ECHO = """
import os, sys
def main(asker):
    print("not an answer"); print("nor this", file=sys.stderr); sys.stdout.flush()
    for line in asker.requests:
        asker.answers.write(line.strip()[::-1])
        asker.answers.flush()
"""
"""Answers a line with its letters the other way round."""
SHOWN = """
def main(asker):
    for line in asker.requests:
        asker.answers.write(asker.picture[0, 0].tobytes() + asker.picture[-1, -1].tobytes())
        asker.answers.flush()
"""
"""Answers with the first and the last pixel of the picture."""
STARTER = """
import sys, time
from pathlib import Path
from common.platform.platform import Job
from common.platform.platforms import platform
from worker_jobs import sleeps
if __name__ == "__main__":
    if sys.argv[1] == "child":
        one = platform().child("spoken", 20.0)
        Path(sys.argv[2]).write_text(str(one.pid))
        one.read_into(memoryview(bytearray(1)))
        Path(sys.argv[2] + ".up").write_text("1")
    else:
        one = platform().start(Job("part", sleeps, (sys.argv[2],)))
    time.sleep(600)
"""
"""Starts a child or a worker, and works."""

Begin = Callable[..., Child]


def main_of(*lines: str) -> str:
    """A child's module whose `main` is of such lines."""
    return "\n    ".join(["import os, sys, time\ndef main(asker):", *lines])


@pytest.fixture(params=PLATFORMS)
def own(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Platform]:
    """Each platform, chosen by its name as a user does."""
    monkeypatch.setenv(CHOICE, request.param)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(Path(__file__).parent), *sys.path]))
    platform.cache_clear()
    yield platform()
    platform.cache_clear()


@pytest.fixture
def begin(own: Platform, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Begin]:
    """Starts a child of such a text; all are closed in the end."""
    children = []
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv(
        "PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    )

    def begun(text: str, stall_s: float = 20.0, **more: Any) -> Child:
        (tmp_path / "spoken.py").write_text(text)
        children.append(own.child("spoken", stall_s, **more))
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


def test_a_child_answers_lines_and_prints_to_no_one(
    begin: Begin, capfd: pytest.CaptureFixture[str]
) -> None:
    child = begin(ECHO)
    assert child.pid != os.getpid()
    assert not child.answers_within(0.0)
    for asked in (b"abc", b"12"):
        child.ask(asked)
        assert child.answers_within(20.0)
        assert read(child, len(asked)) == asked[::-1]
    assert capfd.readouterr() == ("", "")
    child.close()
    assert not psutil.pid_exists(child.pid)


def test_who_waits_for_an_answer_waits_seconds(begin: Begin) -> None:
    child, began_s = begin(main_of("time.sleep(60)")), time.monotonic()
    assert not child.answers_within(0.15)
    assert 0.15 <= time.monotonic() - began_s < 5.0
    assert not child.answers_within(-1.0)


def test_an_answer_that_comes_in_pieces_is_whole_and_one_piece_may_hold_several(
    begin: Begin,
) -> None:
    piece = "asker.answers.write(b'%d' % n * 3); asker.answers.flush(); time.sleep(0.02)"
    child = begin(main_of(f"for n in range(4): {piece}"))
    assert read(child, 2) == b"00"
    assert child.answers_within(20.0)
    assert read(child, 10) == b"0111222333"


def test_a_large_answer_is_intact(begin: Begin) -> None:
    """More than any pipe holds: ten pictures of 320x240."""
    large = "asker.answers.write(bytes(range(251)) * 9180); asker.answers.flush()"
    assert read(begin(main_of(large)), 251 * 9180) == bytes(range(251)) * 9180


def test_a_child_that_gives_nothing_for_the_time_agreed_is_stuck_and_ended(begin: Begin) -> None:
    child = begin(main_of("time.sleep(60)"), stall_s=0.25)
    began_s = time.monotonic()
    with broken("it gave nothing for 0.25 s"):
        read(child, 3)
    assert 0.25 <= time.monotonic() - began_s < 5.0
    assert ended_within(child.pid, SOON_S)


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
    child = begin(main_of("asker.answers.write(b'ab'); asker.answers.flush()", end))
    with broken(how):
        read(child, 3)
    with broken(how):
        child.ask(b"more")


def test_who_is_killed_while_another_reads_ends_the_reading(begin: Begin) -> None:
    child = begin(main_of("time.sleep(60)"))
    child.kill()
    with broken("killed by SIGKILL"):
        read(child, 1)


def test_a_picture_that_is_shared_is_seen_as_it_was_written_each_time(begin: Begin) -> None:
    child = begin(SHOWN, picture_size=(64, 48))
    assert child.picture is not None
    assert child.picture.shape == (48, 64, 3)
    rng = np.random.default_rng(5)
    for asked in (b"1", b"2"):
        child.picture[:] = rng.integers(0, 256, (48, 64, 3), np.uint8)
        due = child.picture[0, 0].tobytes() + child.picture[-1, -1].tobytes()
        child.ask(asked)
        assert read(child, 6) == due
    child.close()
    assert child.picture is None


def test_a_child_without_a_picture_has_none(begin: Begin) -> None:
    text = "asker.answers.write(repr(asker.picture).encode()); asker.answers.flush()"
    child = begin(main_of(text))
    assert read(child, 4) == b"None"
    assert child.picture is None


def test_a_module_in_the_working_directory_is_not_run(
    begin: Begin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    strange = tmp_path / "strange"
    strange.mkdir()
    (strange / "csv.py").write_text("raise SystemExit(9)")
    monkeypatch.chdir(strange)
    text = main_of("import csv; asker.answers.write(b'ours'); asker.answers.flush()")
    assert read(begin(text), 4) == b"ours"


def test_a_worker_says_its_words_and_begins_with_one_thread_a_library(
    own: Platform, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    monkeypatch.setenv("LEFT", "as it was")
    worker, words = own.start(Job("part", says, ()))
    assert words.recv() == ("1", "as it was")
    worker.join(SOON_S)
    assert (worker.exitcode, worker.is_alive()) == (0, False)
    assert os.environ["OMP_NUM_THREADS"] == "7"


def test_a_worker_that_hears_that_it_shall_end_ends_in_order(own: Platform, tmp_path: Path) -> None:
    worker, words = own.start(Job("part", heeds, (str(tmp_path / "pid"),)))
    assert written(tmp_path / "pid") == worker.pid
    assert (worker.exitcode, worker.is_alive()) == (None, True)
    worker.terminate()
    assert words.recv() == "ended in order"
    worker.join(SOON_S)
    assert worker.exitcode == 5


def test_a_worker_that_does_not_hear_it_ends_at_once(own: Platform, tmp_path: Path) -> None:
    worker, _ = own.start(Job("part", sleeps, (str(tmp_path / "pid"),)))
    written(tmp_path / "pid")
    worker.terminate()
    worker.join(SOON_S)
    assert worker.exitcode in (0, -15)


def test_that_a_worker_was_killed_is_noticed(own: Platform, tmp_path: Path) -> None:
    worker, words = own.start(Job("part", sleeps, (str(tmp_path / "pid"),)))
    written(tmp_path / "pid")
    worker.kill()
    worker.join(SOON_S)
    assert (worker.exitcode, worker.is_alive()) == (-9, False)
    with contextlib.suppress(OSError), pytest.raises(EOFError):
        words.recv()


@pytest.mark.parametrize("kind", ["child", "worker"])
def test_what_was_started_ends_with_who_started_it(
    own: Platform, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    monkeypatch.setenv(
        "PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    )
    (tmp_path / "spoken.py").write_text(
        main_of("asker.answers.write(b'.'); asker.answers.flush()", "time.sleep(600)")
    )
    script = tmp_path / "starter.py"
    script.write_text(STARTER)
    starter = subprocess.Popen([sys.executable, str(script), kind, str(tmp_path / "pid")])
    pid = written(tmp_path / "pid")
    if kind == "child":
        written(tmp_path / "pid.up")
    starter.kill()
    starter.wait()
    assert ended_within(pid, SOON_S)


def test_priority_is_lowered_by_what_is_asked(own: Platform) -> None:
    code = (
        "import psutil; from common.platform.platforms import platform\n"
        "before = psutil.Process().nice(); platform().give_way(5)\n"
        "print(psutil.Process().nice() - before)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "5\n"


def test_linux_is_chosen_where_it_is_there_and_nothing_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv(CHOICE, raising=False)
    tried: list[str] = []

    def has_no_fork(name: str) -> Any:
        tried.append(name)
        if "linux" in name:
            raise ImportError("No module named 'fcntl'")
        return import_module(name)

    uncached = platform.__wrapped__
    assert uncached() is import_module(PLATFORMS["linux"]).PLATFORM
    monkeypatch.setattr(platforms, "import_module", has_no_fork)
    assert uncached() is import_module(PLATFORMS["portable"]).PLATFORM
    assert tried == list(PLATFORMS.values())
    monkeypatch.setenv(CHOICE, "linux")
    with pytest.raises(SettingsError, match=r"TRITRACK_PLATFORM=linux: this system lacks .*fcntl"):
        uncached()


def test_a_platform_that_is_not_there_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CHOICE, "windows")
    with pytest.raises(SettingsError, match=r"TRITRACK_PLATFORM=windows: .* linux, portable"):
        platform.__wrapped__()


UNIX_ONLY = {
    "os": "fork forkpty getuid geteuid getgid getegid getgroups getpgid getpgrp setpgid setsid "
    "killpg nice wait wait3 wait4 waitid mkfifo uname sysconf confstr sched_getaffinity "
    "sched_setaffinity pread pwrite memfd_create getloadavg chown fchown fchmod statvfs fstatvfs "
    "posix_spawn posix_fallocate posix_fadvise pipe2 dup3 sendfile set_blocking get_blocking "
    "openpty ttyname getpriority setpriority lockf sync fdatasync register_at_fork pidfd_open "
    "eventfd O_DIRECTORY O_NOFOLLOW O_CLOEXEC O_NONBLOCK WNOHANG WIFEXITED",
    "signal": "SIGKILL SIGHUP SIGUSR1 SIGUSR2 SIGCHLD SIGSTOP SIGCONT SIGTSTP SIGQUIT SIGPIPE "
    "SIGALRM SIGWINCH pthread_sigmask pthread_kill sigwait setitimer alarm pause SIG_BLOCK "
    "SIG_SETMASK SIG_UNBLOCK",
    "socket": "AF_UNIX SO_REUSEPORT SCM_RIGHTS",
}
"""What Python's documentation calls available on Unix alone, or on Windows after 3.11."""
UNIX_MODULES = {"fcntl", "resource", "pwd", "grp", "termios", "tty", "pty", "posix", "syslog"}
KNOWN = {
    "common/cache_folder.py: os.getuid": "asked for before",
    "common/video/complaints.py: os.set_blocking": "Windows has it from Python 3.12 on",
    "runtime/serving/site_process.py: os.set_blocking": "of `tritrack serve` alone",
    "tritrack/doctor/installation.py: os.sched_getaffinity": "asked for before",
}
"""What is used all the same, and why that does no harm."""


ASKED = re.compile(r"\b(" + "|".join([*UNIX_ONLY, *UNIX_MODULES]) + r")\b")
"""What a file says that uses any of it: of the others nothing need be looked at."""


def unix_only(path: Path) -> Iterator[str]:
    text = path.read_text()
    for node in ast.walk(ast.parse(text)) if ASKED.search(text) else ():
        match node:
            case ast.Attribute(value=ast.Name(id=module), attr=name):
                if name in UNIX_ONLY.get(module, "").split():
                    yield f"{module}.{name}"
            case ast.Import(names=names):
                yield from (each.name for each in names if each.name in UNIX_MODULES)
            case ast.ImportFrom(module=str(module)):
                if module in UNIX_MODULES or module in UNIX_ONLY:
                    yield module


def test_what_unix_alone_has_is_used_by_its_own_platform_alone() -> None:
    """Else the first import on Windows or macOS would show it, where no test runs."""
    found = {
        f"{path.relative_to(ROOT).as_posix()}: {name}"
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        if "platform/linux" not in path.as_posix()
        for name in unix_only(path)
    }
    assert found == set(KNOWN)
