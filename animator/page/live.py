"""The live page: present and past messages to every browser, and the browsers' commands."""

import queue
import threading
import time
from collections import deque
from collections.abc import Sequence
from typing import Final

import msgspec

from animator.page.door import Entrance
from animator.page.page_messages import CAMERAS, Asked, Greeting, Over, ShownHealth, Told
from animator.page.page_server import PageServer
from animator.page.shown import shown_frame, shown_room
from animator.scene import Snapshot
from common.bus.control_messages import Answer, Pulse
from common.bus.messages import Posture
from common.npz_file import Facts
from common.rig.camera import Rig

MOST_BYTES: Final = 32_000_000
"""Upper bound of the kept messages, bytes: some minutes of a run, with pictures one."""


class LivePage:
    """A page for browsers at `address`, until `close`.

    Args:
        title: The run's title.
        port: A free port of this machine.
        commands: Whether any process carries out the user's commands.
        entrance: Where the page listens, and who may enter.
        cameras: What the page calls each camera, by its number.
        most_bytes: Upper bound of the frames that are kept for late browsers.

    Raises:
        PageError: When the port is 0, taken or not allowed.
    """

    def __init__(
        self,
        title: str,
        port: int,
        commands: bool,
        entrance: Entrance = Entrance(),
        cameras: tuple[str, ...] = CAMERAS,
        most_bytes: int = MOST_BYTES,
    ) -> None:
        self._hello = Greeting(title, time.time_ns() // 1_000_000, commands, cameras)
        self._lock = threading.Lock()
        self._frames: deque[bytes] = deque()
        self._bytes = self._shown = 0
        self._most_bytes = most_bytes
        self._rig: Rig | None = None
        self._last: dict[type, bytes] = {}
        self._server = PageServer(port, self._greeting, entrance)
        self.address = self._server.address
        """Address of the page."""

    @property
    def watched(self) -> bool:
        """Whether any browser shows the page."""
        return self._server.watched

    @property
    def was_watched(self) -> bool:
        """Whether any browser ever showed it."""
        return self._server.came > 0

    def set_rig(self, rig: Rig) -> None:
        """Draw the room of these cameras from now on."""
        self._rig = rig
        self._tell(shown_room(rig))

    def show(self, snapshot: Snapshot, ended: Sequence[Posture] = ()) -> None:
        """Send every browser the newest bodies, once the cameras are known.

        Args:
            snapshot: The newest of everything.
            ended: The postures since the frame before with which a performance ended.
        """
        if self._rig is None:
            return
        frame = shown_frame(snapshot, ended, self._rig, self._shown)
        if frame is None:
            return
        self._shown += 1
        said = msgspec.json.encode(frame)
        with self._lock:
            self._frames.append(said)
            self._bytes += len(said)
            while self._bytes > self._most_bytes:
                self._bytes -= len(self._frames.popleft())
        self._server.tell(said)

    def show_health(self, pulses: Sequence[Pulse]) -> None:
        """Send how the processes are doing."""
        self._tell(ShownHealth(sorted(pulses, key=lambda each: each.process)))

    def answer(self, answer: Answer) -> None:
        """Send the outcome of a command; late browsers learn of a recording in progress."""
        said = msgspec.json.encode(Told(answer.what, answer.well, answer.text))
        with self._lock:
            if answer.well and answer.what == "record":
                self._last[Told] = said
            elif answer.well and answer.what == "end_record":
                self._last.pop(Told, None)
        self._server.tell(said)

    def end(self, facts: Facts) -> None:
        """The run is over: the page becomes its player."""
        self._tell(Over(facts))

    def asked(self) -> list[Asked]:
        """The browsers' commands since the last call; malformed ones are dropped."""
        wishes = []
        while True:
            try:
                wishes.append(msgspec.json.decode(self._server.asked.get_nowait(), type=Asked))
            except queue.Empty:
                return wishes
            except msgspec.DecodeError:
                continue

    def close(self) -> None:
        """Take the page down and free the port."""
        self._server.close()

    def _tell(self, message: msgspec.Struct) -> None:
        """Send to every browser, now and later."""
        said = msgspec.json.encode(message)
        with self._lock:
            self._last[type(message)] = said
        self._server.tell(said)

    def _greeting(self) -> list[bytes]:
        """The messages to a new browser: all of the run that is kept."""
        with self._lock:
            last = dict(self._last)
            over = last.pop(Over, None)
            ending = [] if over is None else [over]
            return [msgspec.json.encode(self._hello), *last.values(), *self._frames, *ending]
