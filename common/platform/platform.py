"""The interface to the operating system: workers, children, shared pictures, priority."""

import signal
import threading
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from multiprocessing.connection import Connection
from typing import Any, Final, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

WARM_S: Final = 20.0
"""Longest wait of a run for its launcher, seconds."""
COMPILED_S: Final = 600.0
"""The same where everything must be compiled: parts that compiled separately would take far
longer, and would stall during the run at code that they meet there first."""
Picture = NDArray[np.uint8]
"""(H, W, 3), in memory that a child and its starter share."""


class Broken(RuntimeError):
    """A child died or was stuck, and has been ended; the text says how."""


def how_it_ended(code: int) -> str:
    """A process's exit code in words; a negative one is the signal that killed it."""
    return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"


class Job(NamedTuple):
    """A worker's job."""

    name: str
    """Name in `ps`, where the system has names."""
    main: Callable[..., None]
    """Called with `arguments`, and last with a Connection for reporting its error."""
    arguments: tuple[Any, ...]
    nests: bool = False
    """It starts processes of its own."""


class Worker(Protocol):
    """A process that does one part of a run; it ends with the process that started it."""

    @property
    def pid(self) -> int | None:
        """Its process number."""

    @property
    def exitcode(self) -> int | None:
        """None while it lives; negative the signal that killed it."""

    def is_alive(self) -> bool:
        """Whether it lives."""

    def join(self, timeout: float | None = None) -> None:
        """Wait for its end, or so many seconds."""

    def terminate(self) -> None:
        """Ask it to end (`Platform.asked_to_end`); one that cannot receive that yet ends at
        once."""

    def kill(self) -> None:
        """End it."""


class Started(NamedTuple):
    """A started worker."""

    worker: Worker
    words: Connection
    """Connection on which its job reports its error."""


class Launcher(Protocol):
    """Starts workers as fast as possible: where the system allows, it has loaded what they need."""

    def wait(self, stop: threading.Event, look: Callable[[], None], most_s: float = WARM_S) -> None:
        """Wait until that is loaded, or takes too long, or `stop` is set; `look` meanwhile.

        Args:
            stop: Ends the wait.
            look: Called repeatedly.
            most_s: Longest wait; COMPILED_S where everything must be compiled.
        """

    def ready(self) -> bool:
        """Whether a worker may begin now; called in the main thread."""

    def start(self, job: Job) -> Started:
        """Begin a worker."""


class Child(Protocol):
    """A Python module that answers requests with bytes; it holds nothing to save, and may be
    killed.

    It ends with its starter, and ignores a terminal's signals.
    """

    @property
    def pid(self) -> int:
        """Its process number."""

    @property
    def picture(self) -> Picture | None:
        """Shared with it; None where none was requested."""

    def ask(self, request: bytes) -> None:
        """Send one line.

        Raises:
            Broken: When it died.
        """

    def read_into(self, buffer: memoryview) -> None:
        """Fill `buffer`, plain bytes, with its answer.

        Raises:
            Broken: When it died or was stuck before that.
        """

    def answers_within(self, wait_s: float) -> bool:
        """Whether something can be read in time: an answer, or its death."""

    def kill(self) -> None:
        """End it, from any thread; a reading thread then gets Broken."""

    def close(self) -> None:
        """End it, and release everything shared with it."""


class Answers(Protocol):
    """A file of bytes."""

    def write(self, answer: bytes | memoryview, /) -> int:
        """Append to the answer."""

    def flush(self) -> None:
        """Send what was written so far."""


class Asker(NamedTuple):
    """A child's starter, as the child sees it: the argument of its module's `main`."""

    requests: Iterable[bytes]
    """The requests, one line each; they end only with the child."""
    answers: Answers
    picture: Picture | None = None
    """Shared with the starter; read-only."""


class Platform(Protocol):
    """The system services that the parts of a run use."""

    def launcher(self, loaded: str) -> Launcher:
        """The launcher of workers.

        Args:
            loaded: A module whose import imports and compiles what they need.
        """

    def start(self, job: Job) -> Started:
        """Begin a worker as a new Python: one thread per library, without terminal signals."""

    def asked_to_end(self, end: Callable[[], None]) -> AbstractContextManager[None]:
        """Inside this context `end` is called when this process is asked to end."""

    def child(
        self, module: str, stall_s: float, picture_size: tuple[int, int] | None = None
    ) -> Child:
        """Begin a child.

        Args:
            module: Its `main` is called with an Asker.
            stall_s: Seconds without an answer after which it counts as stuck.
            picture_size: Width and height of the shared picture, px.
        """

    def give_way(self, niceness: int) -> None:
        """Lower the priority of this process, in the system's steps."""
