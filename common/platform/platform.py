"""What is asked of the operating system: workers, children, shared pictures, priority."""

import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from multiprocessing.connection import Connection
from types import FrameType
from typing import Any, Final, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

WARM_S: Final = 20.0
"""So long a run waits for its launcher at most."""
COMPILED_S: Final = 600.0
"""So long where all is compiled anew: parts that did so each for itself would take far longer, and
compile in the midst of the run what they meet there first."""
Picture = NDArray[np.uint8]
"""(H, W, 3), in memory that a child and its starter share."""


class Broken(RuntimeError):
    """A child died or was stuck, and is gone; the text says how."""


def how_it_ended(code: int) -> str:
    """The exit code of a process in words; a negative one is the signal that killed it."""
    return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"


@contextmanager
def heeding_sigterm(end: Callable[[], None]) -> Iterator[None]:
    """Meanwhile SIGTERM calls `end`, where the system sends one; in the main thread alone."""

    def heed(_number: int, _frame: FrameType | None) -> None:
        end()

    before = signal.signal(signal.SIGTERM, heed)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


class Job(NamedTuple):
    """What a worker does."""

    name: str
    """As `ps` shows it, where the system has names."""
    main: Callable[..., None]
    """Called with `arguments`, and last with a Connection on which it may say why it fails."""
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
        """Ask it to end (`Platform.asked_to_end`); one that cannot hear that yet ends at once."""

    def kill(self) -> None:
        """End it."""


class Started(NamedTuple):
    """A worker, begun."""

    worker: Worker
    words: Connection
    """On which its job says why it fails."""


class Launcher(Protocol):
    """Where workers begin soonest: it has loaded what they need, where the system allows that."""

    def wait(self, stop: threading.Event, look: Callable[[], None], most_s: float = WARM_S) -> None:
        """Until it has loaded that, or takes too long, or `stop` is set; `look` meanwhile.

        Args:
            stop: Ends the wait.
            look: Called every while.
            most_s: How long it may take; COMPILED_S where all is compiled anew.
        """

    def ready(self) -> bool:
        """Whether a worker may begin now; asked in the main thread."""

    def start(self, job: Job) -> Started:
        """Begin a worker."""


class Child(Protocol):
    """A Python module that answers requests with bytes; it has nothing to save, and a kill ends it.

    It ends with its starter, and is deaf to what a terminal says to all processes.
    """

    @property
    def pid(self) -> int:
        """Its process number."""

    @property
    def picture(self) -> Picture | None:
        """Shared with it; None where that was not asked for."""

    def ask(self, request: bytes) -> None:
        """Send one line.

        Raises:
            Broken: When it died.
        """

    def read_into(self, buffer: memoryview) -> None:
        """Fill `buffer`, plain bytes, from what it answers.

        Raises:
            Broken: When it died or was stuck before that.
        """

    def answers_within(self, wait_s: float) -> bool:
        """Whether something can be read in time: an answer, or that it died."""

    def kill(self) -> None:
        """End it, from any thread; who reads then meets Broken."""

    def close(self) -> None:
        """End it, and let go of all that is shared with it."""


class Answers(Protocol):
    """A file of bytes."""

    def write(self, answer: bytes | memoryview, /) -> int:
        """Add to the answer."""

    def flush(self) -> None:
        """Send what was written so far."""


class Asker(NamedTuple):
    """The starter of a child, as the child sees it: the argument of its module's `main`."""

    requests: Iterable[bytes]
    """A line each; they end only with the child."""
    answers: Answers
    picture: Picture | None = None
    """Shared with the starter; only to be read."""


class Platform(Protocol):
    """What the parts of a run ask of the operating system."""

    def launcher(self, loaded: str) -> Launcher:
        """Where workers begin soonest.

        Args:
            loaded: A module that imports and compiles what they need as it is imported.
        """

    def start(self, job: Job) -> Started:
        """Begin a worker as a new Python: one thread a library, deaf to its terminal."""

    def asked_to_end(self, end: Callable[[], None]) -> AbstractContextManager[None]:
        """Meanwhile `end` is called where this process is asked to end."""

    def child(
        self, module: str, stall_s: float, picture_size: tuple[int, int] | None = None
    ) -> Child:
        """Begin a child.

        Args:
            module: Its `main` is called with an Asker.
            stall_s: When it gives nothing for so long, it counts as stuck.
            picture_size: Width and height of the picture that is shared with it, px.
        """

    def give_way(self, niceness: int) -> None:
        """Lower the priority of this process, by so much where the system counts it."""
