"""Linux: workers forked of a zygote, children forked or executed, signals, memory by its file."""

import os
import signal
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Final

from common.heeded_signals import heeding
from common.platform.linux.child_process import ChildProcess
from common.platform.platform import Child, Job, Launcher, Platform, Started


class LinuxPlatform:
    """See `Platform`."""

    def launcher(self, loaded: str) -> Launcher:
        """A zygote that imports that module."""
        from common.platform.linux.zygote import Zygote

        return Zygote(loaded)

    def start(self, job: Job) -> Started:
        """Begin a worker as a new Python."""
        from common.platform.linux.part_process import begun

        return begun(job, forked=False)

    def asked_to_end(self, end: Callable[[], None]) -> AbstractContextManager[None]:
        """By SIGTERM."""
        return heeding(lambda _: end(), signal.SIGTERM)

    def child(
        self, module: str, stall_s: float, picture_size: tuple[int, int] | None = None
    ) -> Child:
        """A fork where this process is one, and no picture is shared; else a new Python."""
        return ChildProcess(module, stall_s, picture_size)

    def give_way(self, niceness: int) -> None:
        """By its nice value."""
        os.nice(niceness)


PLATFORM: Final[Platform] = LinuxPlatform()
