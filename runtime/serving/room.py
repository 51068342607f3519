"""One supervised site: its process, its pulse, its error."""

from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Final

import msgspec

from common.bus.control_messages import Pulse
from common.bus.inbox import Alive
from common.bus.message_codec import decode
from common.platform.platform import Launcher
from runtime.live.free_ports import with_free_endpoint
from runtime.live.process_table import Part
from runtime.live.supervise import PartFailed, Watched
from runtime.outside.run_figures import RunFigures, step
from runtime.serving.site_status import Status, status_of
from runtime.serving.sites import Site

END_S: Final = 20.0
"""Time for a site to end its processes and write its run, seconds; all sites end at once."""
AGAIN_S: Final = 60.0
"""Seconds after which a site that failed is tried again: its camera may be back."""
SITE: Final = "site"
"""The part to which a site's figures belong."""


class Room:
    """A started site."""

    def __init__(self, site: Site, launcher: Launcher | None = None) -> None:
        """Started now, by that launcher; an open endpoint is chosen."""
        self.site = site
        self._launcher = launcher
        self.figures = RunFigures()
        self.failure = ""
        """Why it does not run; "" while it does."""
        self._pulses: dict[str, Pulse] = {}
        self._again_s = 0.0
        self._ours, self._theirs = Pipe(duplex=False)
        self._watched = self._started()

    @property
    def status(self) -> Status:
        """Its state."""
        return status_of(self.site.name, self._pulses.get(self.site.name), self.failure)

    @property
    def pulse(self) -> Pulse | None:
        """Its newest pulse."""
        return self._pulses.get(self.site.name)

    def look(self, now_s: float) -> str:
        """Read its pulse, restart it where it died; the line to report, or ""."""
        self._hear(now_s)
        if self.failure:
            if now_s >= self._again_s:
                self.failure = ""
                self._watched = self._started()
            return ""
        try:
            told = self._watched.look(now_s, self._pulses)
        except PartFailed as error:
            return self._fails(str(error), now_s)
        if self._watched.given_up:
            return self._fails(told, now_s)
        self._is_there(self._watched.running.process.is_alive(), now_s)
        return told

    def ask(self) -> None:
        """Ask it to end; `end` waits for it."""
        self._watched.ask()

    def end(self) -> None:
        """End all its processes."""
        self._watched.end()
        self._ours.close()
        self._theirs.close()

    def _started(self) -> Watched:
        self._pulses.clear()
        settings = with_free_endpoint(self.site.settings)
        site = self.site._replace(settings=settings)
        part = Part(
            self.site.name,
            site_main,
            (site, self._theirs),
            beats=True,
            nests=True,
            end_s=END_S,
            launcher=self._launcher,
        )
        return Watched(part)

    def _fails(self, why: str, now_s: float) -> str:
        """It is down for a while."""
        self.failure = (
            f"{why.removeprefix(f'{self.site.name}: ')}; tried anew every {AGAIN_S:.0f} s, or at "
            "once when its settings change"
        )
        self._again_s = now_s + AGAIN_S
        self._is_there(False, now_s)
        return f"{self.site.name}: down: {self.failure}"

    def _hear(self, now_s: float) -> None:
        while self._ours.poll():
            pulse = decode(self._ours.recv_bytes(), Pulse)
            self._pulses[self.site.name] = pulse
            told = msgspec.structs.replace(pulse, process=SITE)
            self.figures = step(self.figures, told, now_s)

    def _is_there(self, there: bool, now_s: float) -> None:
        self.figures = step(self.figures, Alive(SITE, there), now_s)


def site_main(site: Site, words: Connection) -> None:
    """The process of a site, imported in its own process."""
    from runtime.serving.site_process import main

    main(site, words)
