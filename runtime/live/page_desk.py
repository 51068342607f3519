"""The run's side of its page: starts its process, carries out commands, reports the end."""

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
"""Folder in the run's for the parts that the user saved."""
LAST_S: Final = 15.0
ANSWERS_S: Final = 0.2
FOLLOWED: Final = ("tracking", "predicted")
"""Statuses of a person who may be lost."""
GONE_S: Final = 2.0
"""Seconds within which an unwatched page has closed."""

FactsOf = Callable[[SoFar], Facts]
"""Gives the summary's facts for a part of the run."""


class PageDesk:
    """The run's side of its page; without a page all methods do nothing."""

    def __init__(
        self,
        settings: Settings,
        out: Path,
        title: str,
        context: ProcessContext,
        launcher: Launcher | None = None,
    ) -> None:
        """Start the page's process at once: users need not wait for compilation.

        A restarted page uses the launcher, if there is one.
        """
        self.stopped = False
        """True: the run was ended at the page."""
        self.facts: FactsOf = lambda _: {}
        """Gives the summary's facts for a saved part."""
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
        """Address and token of the page; "" while it does not answer."""
        if self.watched is None:
            return ""
        port = self._settings.page.port
        try:
            socket.create_connection((self._entrance.host, port), ANSWERS_S).close()
        except OSError:
            return ""
        return invitation_of(self._entrance, port)

    def listen(self, bus: Bus) -> None:
        """Subscribe to commands from now on."""
        self._bus, self._commands = bus, bus.subscribe(Command)

    def serve(self, heard: Any, stop: threading.Event) -> None:
        """Carry out the commands since the last call.

        Args:
            heard: The run's messages so far: `bodies` and `postures`.
            stop: Ends the run, if that is commanded.
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
        """The run is over, and its bus about to close: write the recorded part, unsubscribe."""
        self._finish(heard)
        self._bus = self._commands = None

    def _finish(self, heard: Any) -> None:
        """Write the recorded part, if any; if that fails, recording goes on."""
        if self._began_s is not None and self._write(
            "end_record", self._began_s, "recording", heard
        ):
            self._began_s = None

    def end(self, facts: Facts, stop: threading.Event, say: Callable[[], None]) -> None:
        """Report the run's end to the page, and wait until no browser shows it.

        Args:
            facts: Outcome of the run.
            stop: Ends the wait.
            say: Called where it waits.
        """
        if self.watched is None or self._ending is None:
            return
        try:
            self._ending.send({**facts, "out": str(self._out)})
        except OSError:  # it has ended
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
        """Save the time before a person was lost, no moment twice."""
        for body in heard.bodies.newest(lambda body: body.captured_s > self._seen_s):
            self._seen_s = body.captured_s
            if self._followed and body.status == "lost" and self._seen_s > self._kept_s + LAST_S:
                self._kept_s = self._seen_s
                self._write("save", self._seen_s - LAST_S, "lost", heard)
            self._followed = body.status in FOLLOWED

    def _write(self, what: Wish, first_s: float, name: str, heard: Any) -> bool:
        """Save a part of the run as a run folder, including messages no longer in memory;
        whether it was saved."""
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
    """Capture time of the newest body; 0 where there is none."""
    newest = bodies.newest(lambda _: True, most=1)
    return float(newest[0].captured_s) if newest else 0.0
