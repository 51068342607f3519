"""Several rooms served as a user does: real processes, a file that changes, signals."""

import os
import pty
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import psutil
import pytest

pytest.importorskip("prometheus_client", reason="pip install 'tritrack[metrics]'")

from metrics_reader import read
from spoiling import copied, edit_json, refilmed
from test_metrics_server import asked, free_address
from test_own_process import ended_within

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
PATIENCE_S = 180.0
SOON_S = 20.0
LOOK_S = 0.05
SITE = """
[[site]]
name = "{name}"
together = {together}
[site.settings]
clip = "clip"
size = "{size}"
page = {{ port = 0 }}
bus = {{ endpoint = "auto" }}
"""
ON_TERMINAL = (
    "import os, sys; os.open(os.ttyname(0), os.O_RDWR); os.execv(sys.argv[1], sys.argv[1:])"
)
"""Who leads a session and opens a terminal is told when that is closed."""


class Service:
    """`tritrack serve`, and what is seen of it from outside."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.address = folder, free_address()
        self._ended: Callable[[], int | None] = lambda: None

    def write(self, *, together: bool = False, **sizes: str) -> None:
        """Sites by their names, with the sizes of their pictures; at once, as editors do."""
        word = str(together).lower()
        text = "".join(
            SITE.format(name=name, size=size, together=word) for name, size in sizes.items()
        )
        new = self.folder / "new.toml"
        new.write_text(f'metrics = "{self.address}"\n{text}')
        new.rename(self.folder / "sites.toml")

    @contextmanager
    def running(self, terminal: int | None = None) -> Iterator[psutil.Process]:
        """Alone in its session; on that terminal, if one is given."""
        command = [sys.executable, "-m", "tritrack", "serve", str(self.folder / "sites.toml")]
        own = subprocess.Popen(
            command if terminal is None else [sys.executable, "-c", ON_TERMINAL, *command],
            cwd=ROOT,
            start_new_session=True,
            stdin=terminal,
            stdout=terminal,
            stderr=terminal,
        )
        if terminal is not None:
            os.close(terminal)
        self._ended = own.poll
        try:
            yield psutil.Process(own.pid)
        finally:
            own.kill()
            own.wait()

    def health(self) -> tuple[int, str]:
        try:
            return asked(self.address, "/healthz")
        except OSError:
            return 0, "nobody answers"

    def until(self, what: str, seen: Callable[[], bool]) -> None:
        until_s = time.monotonic() + PATIENCE_S
        while not seen():
            assert time.monotonic() < until_s, f"waited in vain for {what}: {self.health()}"
            assert self._ended() is None, f"it ended with {self._ended()} before {what}"
            time.sleep(0.1)

    def until_well(self, *names: str) -> None:
        def are_well() -> bool:
            code, text = self.health()
            states = {line.split(",")[0] for line in text.splitlines()}
            return code == 200 and states == {f"{name}: running" for name in names}

        self.until(f"{names} to be well", are_well)

    def pids_of(self, own: psutil.Process, name: str) -> set[int]:
        """The processes that write the log of a site."""
        log = str(self.folder / "runs" / name / "log.txt")
        found = set()
        for one in own.children(recursive=True):
            try:
                if log in {file.path for file in one.open_files()}:
                    found.add(one.pid)
            except psutil.Error:
                continue
        return found

    def supervisor_of(self, own: psutil.Process, name: str) -> psutil.Process:
        """The process of a site, a child of the service."""
        pids = self.all_of(own, name)
        (found,) = (one for one in own.children() if one.pid in pids)
        return found

    def frames(self, name: str) -> float:
        """Bodies of a site so far."""
        found = read(asked(self.address, "/metrics")[1])
        return found.by("room", "tritrack_frames_total").get(name, 0.0)

    def all_of(self, own: psutil.Process, name: str) -> set[int]:
        """The same, when the last of them is there: a supervisor and four parts."""
        self.until(f"all of {name}", lambda: len(self.pids_of(own, name)) == 5)
        return self.pids_of(own, name)


def zygote_of(own: psutil.Process) -> psutil.Process:
    """The zygote of a service or of a site: its first fork, before all that are forked of it."""
    forked = [one for one in own.children() if "forkserver" in " ".join(one.cmdline())]
    return min(forked, key=lambda one: (one.create_time(), one.pid))


def pids_in(own: psutil.Process) -> list[int]:
    """All processes of a service but its first."""
    return [one.pid for one in own.children(recursive=True)]


def alive(processes: Iterable[int], within_s: float = 2.0) -> list[int]:
    """Those that still live after so long, by their numbers.

    Who has ended does not, whether it was asked for or not: forks of a process that died too are
    asked for by the machine's first process, on a busy one seconds later.
    """
    until_s = time.monotonic() + within_s
    return [
        pid for pid in processes if not ended_within(pid, max(LOOK_S, until_s - time.monotonic()))
    ]


@pytest.fixture
def service(clip: Path, tmp_path: Path) -> Service:
    folder = copied(clip, tmp_path / "clip")
    refilmed(folder, lambda film: film + 14 * (film[:29:-1] + film[29:]))
    edit_json(folder / "meta.json", lambda meta: meta.update(fps=5.0))
    return Service(tmp_path)


def test_a_changed_file_changes_what_it_must_and_leaves_the_others_alone(service: Service) -> None:
    service.write(hall="160x120", lobby="160x120", stage="160x120")
    with service.running() as own:
        service.until_well("hall", "lobby", "stage")
        before = {name: service.all_of(own, name) for name in ("hall", "lobby", "stage")}

        service.write(hall="160x120", lobby="128x96", annex="160x120")
        service.until("stage to be gone", lambda: "stage" not in service.health()[1])
        service.until_well("hall", "lobby", "annex")
        assert service.pids_of(own, "hall") == before["hall"]
        assert not service.pids_of(own, "lobby") & before["lobby"]
        assert alive(before["stage"], LOOK_S) == []

        (service.folder / "sites.toml").write_text("[[site]]\nname = 3")
        own.send_signal(signal.SIGHUP)
        time.sleep(3.0)
        service.until_well("hall", "lobby", "annex")
        assert service.pids_of(own, "hall") == before["hall"]

        everybody = pids_in(own)
        own.send_signal(signal.SIGTERM)
        assert own.wait(SOON_S) == 0
        assert alive(everybody) == [], "somebody was left behind"
    for name in ("hall", "lobby", "annex", "stage"):
        assert (service.folder / "runs" / name / "summary.json").is_file(), name
    with np.load(service.folder / "runs" / "hall" / "poses.npz") as found:
        assert len(found["frame"]) > 0


def test_a_site_that_is_killed_is_started_again_and_the_other_goes_on(service: Service) -> None:
    service.write(hall="160x120", lobby="160x120")
    with service.running() as own:
        service.until_well("hall", "lobby")
        hall, lobby = (service.all_of(own, name) for name in ("hall", "lobby"))
        service.until("hall to have measured something", lambda: service.frames("hall") > 10)
        service.supervisor_of(own, "hall").kill()
        told = (0, "")

        def is_told() -> bool:
            nonlocal told
            told = service.health()
            return told[0] == 503

        service.until("the loss to be told", is_told)
        assert "hall: " in told[1]
        service.until_well("hall", "lobby")
        assert not service.pids_of(own, "hall") & hall
        assert service.pids_of(own, "lobby") == lobby
        found = read(asked(service.address, "/metrics")[1])
        assert found.by("room", "tritrack_restarts_total") == {"hall": 1.0, "lobby": 0.0}
        own.send_signal(signal.SIGTERM)
        assert own.wait(SOON_S) == 0
    assert list((service.folder / "runs" / "hall" / "saved").glob("cut_short_*"))


def test_sites_go_on_where_the_zygotes_are_killed_that_they_and_their_parts_came_of(
    service: Service,
) -> None:
    service.write(hall="160x120", lobby="160x120")
    with service.running() as own:
        service.until_well("hall", "lobby")
        before = {name: service.all_of(own, name) for name in ("hall", "lobby")}
        hall = service.supervisor_of(own, "hall")
        zygotes = [zygote_of(own), zygote_of(hall)]
        # The decoders before that read the background, and end.
        service.until("the hall to have begun", lambda: service.frames("hall") > 0)
        service.until("two decoders", lambda: len(zygotes[1].children()) == 2)
        decoders = [one.pid for one in zygotes[1].children()]
        for zygote in zygotes:
            zygote.kill()
        assert alive([zygote.pid for zygote in zygotes]) == []
        bodies = service.frames("hall")
        service.until("the hall to go on", lambda: service.frames("hall") > bodies + 10)
        service.until_well("hall", "lobby")
        assert {name: service.all_of(own, name) for name in ("hall", "lobby")} == before
        assert alive(decoders, LOOK_S) == decoders

        part = next(one for one in hall.children() if one.pid in before["hall"])
        part.kill()
        service.until("a new part", lambda: part.pid not in service.all_of(own, "hall"))
        service.until_well("hall", "lobby")
        assert hall.is_running(), "its run was cut in two"
        own.send_signal(signal.SIGTERM)
        assert own.wait(SOON_S) == 0
    assert alive(before["hall"] | before["lobby"] | set(decoders)) == []


def test_a_room_in_one_process_comes_back_when_that_is_killed(
    service: Service,
) -> None:
    service.write(together=True, hall="160x120")
    with service.running() as own:
        service.until_well("hall")
        (before,) = service.pids_of(own, "hall")
        service.until("hall to have measured something", lambda: service.frames("hall") > 40)
        psutil.Process(before).kill()
        service.until("another process", lambda: bool(service.pids_of(own, "hall") - {before}))
        service.until_well("hall")
        service.until("hall to measure on", lambda: service.frames("hall") > 80)
        everybody = pids_in(own)
        own.send_signal(signal.SIGTERM)
        assert own.wait(SOON_S) == 0
        assert alive(everybody) == [], "somebody was left behind"
    again = service.folder / "runs" / "hall"
    assert list((again / "saved").glob("cut_short_*")), "what it had measured is kept"
    assert " viewer 1 " in (again / "log.txt").read_text(), "parts have their names in the log"
    assert (again / "summary.json").is_file()


def test_sigterm_to_all_processes_ends_each_run_in_order(service: Service) -> None:
    """As systemd stops a service."""
    service.write(hall="160x120")
    with service.running() as own:
        service.until_well("hall")
        service.until("hall to have measured something", lambda: service.frames("hall") > 10)
        os.killpg(own.pid, signal.SIGTERM)
        assert own.wait(SOON_S) == 0
    assert (service.folder / "runs" / "hall" / "summary.json").is_file()


def test_nothing_outlives_a_service_that_is_killed(service: Service) -> None:
    service.write(hall="160x120")
    with service.running() as own:
        service.until_well("hall")
        everybody = pids_in(own)
        own.kill()
        assert alive(everybody, 5.0) == []


def test_a_closed_terminal_ends_all_sites_in_order(service: Service) -> None:
    service.write(hall="160x120")
    with terminal() as (theirs, close), service.running(theirs) as own:
        service.until_well("hall")
        service.until("hall to have measured something", lambda: service.frames("hall") > 10)
        everybody = pids_in(own)
        close()
        assert own.wait(SOON_S) == 0
        assert alive(everybody) == [], "somebody was left behind"
    assert (service.folder / "runs" / "hall" / "summary.json").is_file()
    assert "Traceback" not in (service.folder / "runs" / "hall" / "log.txt").read_text()


@contextmanager
def terminal() -> Iterator[tuple[int, Callable[[], None]]]:
    """A terminal that is looked at, and what closes it."""
    ours, theirs = pty.openpty()
    closing = threading.Event()

    def look() -> None:
        while not closing.is_set():
            if select.select([ours], [], [], 0.1)[0]:
                os.read(ours, 4096)
        os.close(ours)

    def close() -> None:
        closing.set()
        looking.join()

    looking = threading.Thread(target=look)
    looking.start()
    try:
        yield theirs, close
    finally:
        close()


def test_sighup_to_all_processes_leaves_them_alone_where_no_terminal_was_closed(
    service: Service,
) -> None:
    """As when a session ends that the service was started in by `nohup`."""
    service.write(hall="160x120")
    with service.running() as own:
        service.until_well("hall")
        service.all_of(own, "hall")
        everybody = pids_in(own)
        os.killpg(own.pid, signal.SIGHUP)
        assert alive(everybody, 1.0) == everybody
        own.send_signal(signal.SIGTERM)
        assert own.wait(SOON_S) == 0
