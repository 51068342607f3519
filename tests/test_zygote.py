"""Parts forked of a process that has imported everything: real processes, no bus."""

import os
import signal
import subprocess
import sys
import threading
import time
from multiprocessing import forkserver
from pathlib import Path
from typing import Any

import psutil
import pytest
from test_own_process import PATIENCE_S, SOON_S, ended_within, sleeps, written

from common.platform.linux.zygote import Zygote
from runtime.live.process_table import Part, end, started
from runtime.live.session import WARMED
from runtime.live.supervise import PartFailed, watched

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="parts are forked on Linux alone"),
]

PARENT = """
import sys, threading, time
from test_own_process import sleeps
from runtime.live.process_table import Part, started
from common.platform.linux.zygote import Zygote
if __name__ == "__main__":
    zygote = Zygote("runtime.warming.warmed")
    zygote.wait(threading.Event(), lambda: None)
    child = started(Part("viewer 1", sleeps, (sys.argv[1],), launcher=zygote))
    time.sleep(600)
"""


WITHOUT = """
import threading
from common.platform.linux.zygote import Zygote
if __name__ == "__main__":
    zygote = Zygote("runtime.warming.warmed")
    zygote.wait(threading.Event(), lambda: None)
    print(not zygote.warm)
"""


LOADING = """
import sys, time
from multiprocessing import forkserver
from pathlib import Path
from common.platform.linux.zygote import Zygote
if __name__ == "__main__":
    zygote = Zygote("runtime.warming.warmed")
    Path(sys.argv[1]).write_text(str(forkserver._forkserver._forkserver_pid))
    time.sleep(600)
"""


@pytest.fixture(scope="module")
def zygote() -> Zygote:
    one = Zygote(WARMED)
    one.wait(threading.Event(), lambda: None)
    assert one.warm
    return one


def number_of_the_zygote() -> int:
    server: Any = forkserver._forkserver
    return int(server._forkserver_pid)


def says_what_it_has(path: str) -> None:
    modules = {"cv2", "zenoh", "viewer.track", "integrator.merge", "recognizer.spotting"}
    threads = len(os.listdir("/proc/self/task"))
    Path(path).write_text(f"all {modules <= set(sys.modules)}, {threads} threads")
    sleeps(f"{path}.pid")


def is_a_site(folder: str) -> None:
    """A part with a run of its own, which has a zygote in its turn."""
    own = Zygote(WARMED)
    assert own.warm, "it was not ready at once"
    part = started(Part("viewer 1", sleeps, (f"{folder}/part",), launcher=own))
    sleeps(f"{folder}/site")
    end(part)


def fails() -> None:
    raise ValueError("no camera")


def test_a_part_has_all_modules_as_it_begins_and_no_threads_but_the_one_that_ends_it(
    zygote: Zygote, tmp_path: Path
) -> None:
    """Libraries' threads would be lacking in it, and what waits for them would wait for ever."""
    one = started(Part("viewer 1", says_what_it_has, (str(tmp_path / "said"),), launcher=zygote))
    try:
        assert written(tmp_path / "said.pid") == one.process.pid
        assert (tmp_path / "said").read_text() == "all True, 2 threads"
    finally:
        end(one)
    assert one.process.exitcode == -signal.SIGTERM


def test_a_part_is_deaf_to_what_a_terminal_says_to_all(zygote: Zygote, tmp_path: Path) -> None:
    one = started(Part("viewer 1", sleeps, (str(tmp_path / "pid"),), launcher=zygote))
    try:
        pid = written(tmp_path / "pid")
        for number in (signal.SIGINT, signal.SIGHUP):
            os.kill(number_of_the_zygote(), number)
            os.kill(pid, number)
        assert not ended_within(pid, 0.5)
    finally:
        end(one)


def test_why_a_part_fails_and_how_it_was_killed_is_known_as_of_any_other(
    zygote: Zygote, tmp_path: Path
) -> None:
    with watched(Part("viewer 1", fails, (), launcher=zygote)) as one:
        one.running.process.join()
        with pytest.raises(PartFailed, match=r"viewer 1: .*no camera"):
            one.refuse_failure()
    with watched(Part("viewer 1", sleeps, (str(tmp_path / "pid"),), launcher=zygote)) as one:
        os.kill(written(tmp_path / "pid"), signal.SIGKILL)
        one.running.process.join()
        assert one.running.process.exitcode == -signal.SIGKILL


def test_a_part_that_its_zygote_dies_before_forking_is_a_new_python(
    zygote: Zygote, tmp_path: Path
) -> None:
    before = number_of_the_zygote()
    os.kill(before, signal.SIGSTOP)
    killed = threading.Timer(0.5, os.kill, (before, signal.SIGKILL))
    killed.start()
    one = started(Part("viewer 1", sleeps, (str(tmp_path / "pid"),), launcher=zygote))
    killed.join()
    try:
        assert written(tmp_path / "pid") == one.process.pid
    finally:
        end(one)


def test_a_part_outlives_its_zygote_and_how_it_ends_is_known(
    zygote: Zygote, tmp_path: Path
) -> None:
    with watched(Part("viewer 1", sleeps, (str(tmp_path / "pid"),), launcher=zygote)) as one:
        pid, before = written(tmp_path / "pid"), number_of_the_zygote()
        assert psutil.Process(pid).ppid() == os.getpid()
        os.kill(before, signal.SIGKILL)
        assert ended_within(before, SOON_S)
        assert not ended_within(pid, 0.5)
        assert one.look(time.monotonic(), {}) == ""
        os.kill(pid, signal.SIGKILL)
        one.running.process.join(SOON_S)
        assert one.look(time.monotonic(), {}) == (
            "viewer 1: killed by signal 9; it is started again in 0.5 s (1 of 5 times)"
        )


def test_where_the_zygote_died_the_next_part_has_another(zygote: Zygote, tmp_path: Path) -> None:
    before = number_of_the_zygote()
    os.kill(before, signal.SIGKILL)
    assert ended_within(before, SOON_S)
    one = started(Part("viewer 1", sleeps, (str(tmp_path / "pid"),), launcher=zygote))
    try:
        assert written(tmp_path / "pid") == one.process.pid
        assert number_of_the_zygote() != before
    finally:
        end(one)


@pytest.mark.parametrize("stopped", [False, True], ids=["works", "is stopped"])
def test_zygote_and_forks_end_when_their_supervisor_is_killed(
    tmp_path: Path, stopped: bool
) -> None:
    script = tmp_path / "parent.py"
    script.write_text(PARENT)
    path = os.pathsep.join((str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")))
    parent = subprocess.Popen(
        [sys.executable, str(script), str(tmp_path / "pid")], env={**os.environ, "PYTHONPATH": path}
    )
    pid = written(tmp_path / "pid")
    assert psutil.Process(pid).ppid() == parent.pid
    others = {one.pid for one in psutil.Process(parent.pid).children()} - {pid}
    assert others
    if stopped:
        os.kill(pid, signal.SIGSTOP)
    parent.kill()
    parent.wait()
    assert ended_within(pid, SOON_S)
    for own in others:
        assert ended_within(own, SOON_S)


def test_a_zygote_that_still_loads_ends_with_its_supervisor_too(tmp_path: Path) -> None:
    """It is stopped meanwhile, so that it cannot see that by itself."""
    script = tmp_path / "parent.py"
    script.write_text(LOADING)
    parent = subprocess.Popen([sys.executable, str(script), str(tmp_path / "pid")])
    pid = written(tmp_path / "pid")
    until_s = time.monotonic() + PATIENCE_S
    while "numpy" not in Path(f"/proc/{pid}/maps").read_text():
        assert time.monotonic() < until_s
    os.kill(pid, signal.SIGSTOP)
    parent.kill()
    parent.wait()
    assert ended_within(pid, SOON_S)


def test_who_starts_a_part_again_is_not_held_up_while_the_next_zygote_loads(
    zygote: Zygote,
) -> None:
    """A supervisor that stood still for so long would be taken for hung."""
    assert zygote.warm
    before = number_of_the_zygote()
    os.kill(before, signal.SIGKILL)
    assert ended_within(before, SOON_S)
    began_s = time.monotonic()
    assert not zygote.ready()
    assert time.monotonic() - began_s < 0.5
    while not zygote.ready():
        assert time.monotonic() - began_s < PATIENCE_S
        time.sleep(0.1)
    assert zygote.warm


@pytest.mark.parametrize("stopped", [False, True], ids=["works", "is stopped"])
def test_a_site_has_a_zygote_of_its_own_by_one_fork_more_and_takes_it_along(
    zygote: Zygote, tmp_path: Path, stopped: bool
) -> None:
    one = started(Part("hall", is_a_site, (str(tmp_path),), nests=True, launcher=zygote))
    part, site = (psutil.Process(written(tmp_path / name)) for name in ("part", "site"))
    (own,) = set(site.children()) - {part}
    assert part.parent() == site
    assert site.parent() == psutil.Process()
    memory = part.memory_full_info()
    assert memory.uss < memory.rss / 4, "what was loaded once is not shared"
    if stopped:
        part.suspend()
    site.kill()
    assert ended_within(own.pid, SOON_S)
    assert ended_within(part.pid, SOON_S)
    assert psutil.Process(number_of_the_zygote()).is_running()
    end(one)


def test_a_zygote_that_is_asked_to_end_with_all_of_a_service_stays_for_its_forks(
    zygote: Zygote, tmp_path: Path
) -> None:
    """As systemd ends a service; who works heeds SIGTERM, at once or as soon as it can."""
    one = started(Part("hall", is_a_site, (str(tmp_path),), nests=True, launcher=zygote))
    part, site = (psutil.Process(written(tmp_path / name)) for name in ("part", "site"))
    for each in {*site.children(), psutil.Process(number_of_the_zygote())} - {part}:
        each.terminate()
    assert not ended_within(site.pid, 0.5)
    assert part.is_running()
    part.terminate()
    assert ended_within(part.pid, SOON_S)
    assert end(one)
    assert one.process.exitcode == -signal.SIGTERM


@pytest.mark.live
def test_a_run_that_is_stopped_does_not_wait_for_it() -> None:
    code = (
        "import threading, time; "
        "from common.platform.linux.zygote import Zygote; stop = threading.Event(); stop.set(); "
        "began = time.monotonic(); Zygote('runtime.warming.warmed').wait(stop, print); "
        "assert time.monotonic() - began < 0.5"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False, timeout=20).returncode == 0


def test_a_file_of_the_working_directory_is_not_taken_for_a_library(tmp_path: Path) -> None:
    (tmp_path / "numpy.py").write_text("raise SystemExit('a stranger')")
    code = (
        "import sys; sys.path = [path for path in sys.path if path]\n"
        "import threading\n"
        "from common.platform.linux.zygote import Zygote\n"
        "if __name__ == '__main__':\n"
        "    one = Zygote('runtime.warming.warmed'); one.wait(threading.Event(), lambda: None)\n"
        "    assert one.warm\n"
    )
    done = subprocess.run([sys.executable, "-c", code], check=False, cwd=tmp_path, timeout=120)
    assert done.returncode == 0


def test_where_temporary_files_lie_too_deep_for_a_socket_parts_begin_without_it(
    tmp_path: Path,
) -> None:
    """A socket's name has 107 letters at most; nobody waits for what does not come."""
    deep = tmp_path / ("deep" * 25)
    deep.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT],
        env={**os.environ, "TMPDIR": str(deep)},
        capture_output=True,
        text=True,
        check=False,
        timeout=15.0,
    )
    assert (done.stdout, done.stderr) == ("True\n", "")
