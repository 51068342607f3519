"""The zygote's own code: it forks from now on, and ends with the process that started it.

Only the zygote imports this module, first of all, and the import does the work: multiprocessing
gives its server no other hook. Its forks recognise themselves as forks by this module.
"""

import os
import signal
from collections.abc import Sequence
from multiprocessing import forkserver
from typing import NoReturn

from common.platform.linux.own_process import end_with


def begin(starter: int) -> None:
    """Fork from now on, and end with the starter, given by number, not before.

    SIGTERM stays blocked in each fork until it can handle it: sent to all processes of a service,
    as by systemd, it must not end the zygote, and all forks with it.
    """
    signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGTERM,))
    end_with(starter)


def serve(starter: int, passed: Sequence[int]) -> NoReturn:
    """Be the zygote of the process that this one was forked of, until that ends.

    Args:
        starter: Number of that process.
        passed: The files of multiprocessing's server.
    """
    try:
        begin(starter)
        for heeded in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            signal.signal(heeded, signal.SIG_DFL)  # the starter's own are not for its parts
        listener, alive, *_ = passed
        forkserver.main(listener, alive, [])
    finally:
        os._exit(1)


begin(os.getppid())
