"""What a run does for its page: starts its process, does what is asked for there, tells the end."""

import math
import socket
import threading
from collections.abc import Callable
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Final

from animator.page.door import entrance_of, invitation_of
from common.bus.bus import Bus
from common.bus.control_messages import Answer, Command, Wish
from common.bus.inbox import Inbox
from common.bus.messages import Body, Posture
from common.bus.process import ProcessContext
from common.config.settings import Settings
from common.npz_file import Facts
from common.platform.platform import Launcher
from runtime.live.process_table import Part, page_part
from runtime.live.recorded import MessageLog, SoFar, WholeRun
from runtime.live.supervise import Watched
from runtime.store.past_journal import Journalled
from runtime.store.runs import RunError, write_postures, write_run

SAVED: Final = "saved"
"""Folder of what the person at the page saved, below the run's."""
LAST_S: Final = 15.0
ANSWERS_S: Final = 0.2
FOLLOWED: Final = ("tracking", "predicted")
"""Status of somebody who may be lost."""
GONE_S: Final = 2.0
"""A page at which nobody looks has closed by then."""

FactsOf = Callable[[SoFar], Facts]
"""Gives what the summary of a part of the run says."""


class PageDesk:
    """The run's side of its page; without a page all of it does nothing."""

    def __init__(
        self,
        settings: Settings,
        out: Path,
        title: str,
        context: ProcessContext,
        launcher: Launcher | None = None,
    ) -> None:
        """Start the page's process at once: people shall not wait for what compiles.

        One in its place begins by the launcher, if there is one.
        """
        self.stopped = False
        """The run was ended at the page."""
        self.facts: FactsOf = lambda _: {}
        """Gives what the summary of a saved part tells."""
        self.watched: Watched | None = None
        self._settings, self._out = settings, out
        self._bus: Bus | None = None
        self._commands: Inbox[Command] | None = None
        self._began_s: float | None = None
        self._seen_s = self._kept_s = -math.inf
        self._followed = False
        self._ending: Connection | None = None
        self._entrance = entrance_of(settings.page)
        if settings.page.port:
            theirs, self._ending = Pipe(duplex=False)
            part = page_part(settings, context, title, theirs, self._entrance, launcher)
            self.watched = Watched(part)

    @property
    def parts(self) -> list[Part]:
        """The page's process, if there is one."""
        return [] if self.watched is None else [self.watched.part]

    @property
    def address(self) -> str:
        """What lets a browser find the page, and in; "" while it does not answer."""
        if self.watched is None:
            return ""
        port = self._settings.page.port
        try:
            socket.create_connection((self._entrance.host, port), ANSWERS_S).close()
        except OSError:
            return ""
        return invitation_of(self._entrance, port)

    def listen(self, bus: Bus) -> None:
        """Hear what is asked for from now on."""
        self._bus, self._commands = bus, bus.subscribe(Command)

    def serve(self, heard: Any, stop: threading.Event) -> None:
        """Do what was asked for since.

        Args:
            heard: What the run said so far: `bodies` and `postures`.
            stop: Ends the run, if that is asked for.
        """
        for command in self._commands.drain() if self._commands else ():
            if command.what == "stop":
                self.stopped = True
                stop.set()
            elif command.what == "record":
                if self._began_s is None:  # another browser may have begun it
                    self._began_s = _newest_s(heard.bodies)
                self._say("record", True, "recording")
            elif command.what == "save":
                first_s = _newest_s(heard.bodies) - LAST_S
                self._write("save", first_s, f"last_{LAST_S:.0f}_s", heard)
            elif command.what == "end_record":
                self._finish(heard)
        if self._settings.page.save_lost:
            self._keep_lost(heard)

    def leave(self, heard: Any) -> None:
        """The run is over, and its bus about to close: write what is recorded, hear no more."""
        self._finish(heard)
        self._bus = self._commands = None

    def _finish(self, heard: Any) -> None:
        """Write what is recorded, if anything is; what cannot be written is recorded further."""
        if self._began_s is not None and self._write(
            "end_record", self._began_s, "recording", heard
        ):
            self._began_s = None

    def end(self, facts: Facts, stop: threading.Event, say: Callable[[], None]) -> None:
        """Tell the page that the run is over, and wait until nobody looks at it any more.

        Args:
            facts: What came of the run.
            stop: Ends the wait.
            say: Called where there is a wait.
        """
        if self.watched is None or self._ending is None:
            return
        try:
            self._ending.send({**facts, "out": str(self._out)})
        except OSError:  # it has gone
            return
        process = self.watched.running.process
        process.join(GONE_S)
        if process.is_alive():
            say()
        while process.is_alive() and not stop.wait(0.1):
            pass

    def close(self) -> None:
        """End the page's process."""
        if self.watched is not None:
            self.watched.end()

    def _keep_lost(self, heard: Any) -> None:
        """Write what came before somebody was lost from sight, no moment twice."""
        for body in heard.bodies.newest(lambda body: body.captured_s > self._seen_s):
            self._seen_s = body.captured_s
            if self._followed and body.status == "lost" and self._seen_s > self._kept_s + LAST_S:
                self._kept_s = self._seen_s
                self._write("save", self._seen_s - LAST_S, "lost", heard)
            self._followed = body.status in FOLLOWED

    def _write(self, what: Wish, first_s: float, name: str, heard: Any) -> bool:
        """A part of the run as a run folder of its own, what has left the memory too; whether it
        is there."""
        bodies = WholeRun(heard.bodies, Journalled(self._out, Body), first_s)
        postures = WholeRun(heard.postures, Journalled(self._out, Posture), first_s)
        began_s = next((body.captured_s for body in bodies), None)
        if began_s is None:
            self._say(what, False, "nothing was tracked yet")
            return False
        last_s = _newest_s(heard.bodies)
        folder = self._out / SAVED / f"{name}_to_{last_s:.1f}_s"
        try:
            own = SoFar(bodies, postures)
            write_run(folder, bodies, self._settings, self.facts(own))
            write_postures(folder, postures, own.posture)
        except RunError as error:
            self._say(what, False, str(error)[:400])
            return False
        self._say(what, True, f"{last_s - began_s:.1f} s written to {folder}"[:400])
        return True

    def _say(self, what: Wish, well: bool, text: str) -> None:
        if self._bus is not None:
            self._bus.publish(Answer(what=what, well=well, text=text))


def _newest_s(bodies: MessageLog[Any]) -> float:
    """When the newest body was seen; 0 where there is none."""
    newest = bodies.newest(lambda _: True, most=1)
    return float(newest[0].captured_s) if newest else 0.0
