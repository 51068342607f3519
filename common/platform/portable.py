"""The platform of Python's own public parts: spawned processes, pipes, shared memory."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

import psutil

from common.heeded_signals import heeding
from common.platform.platform import Child, Job, Launcher, Platform, Started
from common.platform.portable_child import PortableChild
from common.platform.portable_worker import EAR, PortableLauncher, spawned


class PortablePlatform:
    """See `Platform`.

    Each process is spawned, so a program that starts one must guard its own work by `if __name__ ==
    "__main__":`, as multiprocessing requires.
    """

    def launcher(self, loaded: str) -> Launcher:
        """Each worker imports separately; missing compilation is done before."""
        return PortableLauncher(loaded)

    def start(self, job: Job) -> Started:
        """Begin a worker as a new Python."""
        return spawned(job)

    @contextmanager
    def asked_to_end(self, end: Callable[[], None]) -> Iterator[None]:
        """By the worker's pipe; by SIGTERM too, where the system has it."""
        with heeding(lambda _: end(), signal.SIGTERM), EAR.listening(end):
            yield

    def child(
        self, module: str, stall_s: float, picture_size: tuple[int, int] | None = None
    ) -> Child:
        """Begin a child."""
        return PortableChild(module, stall_s, picture_size)

    def give_way(self, niceness: int) -> None:
        """By its nice value, or by a priority class where there are none."""
        own = psutil.Process()
        own.nice(own.nice() + niceness if psutil.POSIX else psutil.BELOW_NORMAL_PRIORITY_CLASS)


PLATFORM: Final[Platform] = PortablePlatform()
