"""Serving of sites: started, monitored, changed with their file, and ended together."""

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import Final

from rich.console import Console
from rich.live import Live as LiveDisplay

from common.bus.process import HANG_UP
from common.config.part_settings import SettingsError
from common.heeded_signals import heeding
from common.platform.platforms import platform
from runtime.live.free_ports import refuse_held_metrics, refuse_held_ports, with_free_endpoint
from runtime.live.table import table_of
from runtime.serving.served_rooms import House
from runtime.serving.sites import Sites, files_of, load_sites
from runtime.terminal import say, warn

LOOK_S: Final = 0.1
WARM_S: Final = 300.0
"""Longest wait of rooms for the launcher, seconds: a compilation is done once for all."""
CHANGED_S: Final = 1.0
"""Interval of checks whether a file has changed, seconds."""


class SitesWatch:
    """The file of sites, and whether it or a file that it names has changed."""

    def __init__(self, path: Path) -> None:
        """Read it.

        Raises:
            SettingsError: When it cannot be used.
        """
        self.sites = load_sites(path)
        """The sites in the file when it could last be used."""
        self._path = path
        self._seen, self._next_s = _stamps(path), 0.0

    def changed(self, now_s: float, asked: threading.Event) -> bool:
        """Whether it must be read again: its modification time is checked once a second, or
        SIGHUP came."""
        if now_s < self._next_s:
            return False
        self._next_s = now_s + CHANGED_S
        if not asked.is_set() and _stamps(self._path) == self._seen:
            return False
        asked.clear()
        return True

    def read(self) -> str:
        """Read it again; why it cannot be used, or ""."""
        self._seen = _stamps(self._path)
        try:
            self.sites = load_sites(self._path)
        except SettingsError as error:
            return str(error)
        return ""


def serve(path: Path, console: Console) -> None:
    """Serve the sites of a file until SIGINT or SIGTERM; SIGHUP rereads it.

    A closed terminal sends SIGHUP too: where the console was on one, that ends the service.

    Args:
        path: The file of sites.
        console: Shows a table of the sites, and news.

    Raises:
        SettingsError, PortHeld, PageError: When the file cannot be used; nothing was started.
    """
    file = SitesWatch(path)
    metrics = file.sites.metrics
    _refuse_what_is_held(file.sites)
    launcher = platform().launcher(f"{__package__}.warmed_sites")
    with (
        _signals(console) as (stop, anew),
        LiveDisplay(console=console, transient=True) as display,
        House(launcher, lambda told: say(console, told), lambda told: warn(console, told)) as house,
        _answers(file.sites, house),
    ):
        launcher.wait(stop, lambda: None, WARM_S)
        house.become({} if stop.is_set() else file.sites.sites)
        while not stop.wait(LOOK_S):
            house.look()
            display.update(table_of(house.names, house.pulses, str(path)))
            if file.changed(time.monotonic(), anew):
                trouble = file.read()
                if trouble:
                    warn(console, f"all sites go on as they were: {trouble}")
                if file.sites.metrics != metrics:
                    warn(console, "metrics: another address counts from the next start on")
                house.become(file.sites.sites)


def _refuse_what_is_held(sites: Sites) -> None:
    refuse_held_metrics(sites.metrics)
    for site in sites.sites.values():
        refuse_held_ports(with_free_endpoint(site.settings))


def _stamps(path: Path) -> dict[Path, tuple[int, int] | None]:
    """Attributes of the files whose change means a change of the sites."""
    return {file: _stamp(file) for file in files_of(path)}


def _stamp(path: Path) -> tuple[int, int] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def _answers(sites: Sites, house: House) -> AbstractContextManager[None]:
    """Metrics and health of all sites over HTTP, where wanted."""
    if not sites.metrics:
        return nullcontext()
    from runtime.outside.metrics_server import served

    return served(sites.metrics, house.metrics, house.health)


@contextmanager
def _signals(console: Console) -> Iterator[tuple[threading.Event, threading.Event]]:
    """Set by SIGINT, SIGTERM and the end of the console's terminal, and by any other SIGHUP."""
    stop, anew = threading.Event(), threading.Event()
    attended = console.is_terminal

    def heed(number: int) -> None:
        closed = attended and not console.file.isatty()
        console.quiet |= closed  # writing to it would fail
        (anew if number == HANG_UP and not closed else stop).set()

    heeded = (signal.SIGINT, HANG_UP) if HANG_UP else (signal.SIGINT,)
    with heeding(heed, *heeded), platform().asked_to_end(lambda: heed(signal.SIGTERM)):
        yield stop, anew
