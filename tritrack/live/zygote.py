"""The zygote: a process with everything imported and compiled, of which a run's parts are forked.

A fork works within milliseconds, where a process of its own imports and loads for seconds, and
shares with the others what it does not change. The zygote opens no door and begins no thread. When
it dies so do its forks, and the next that is started brings up another one.
"""

import logging
import multiprocessing
import os
import sys
import threading
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
from multiprocessing import forkserver
from multiprocessing.context import ForkServerContext, SpawnContext
from typing import Final

SPAWN: Final = multiprocessing.get_context("spawn")
FORK: Final = multiprocessing.get_context("forkserver")
"""Never the plain fork: Zenoh's threads are not inherited."""
WARMED: Final = f"{__package__}.warmed"
WARM_S: Final = 20.0
"""So long a run waits for its zygote at most: when all is compiled anew, its parts do without."""
LOOK_S: Final = 0.05

log = logging.getLogger(__name__)


class Zygote:
    """The zygote of this process: one for all its runs."""

    def __init__(self, inherited: Callable[[], AbstractContextManager[None]]) -> None:
        """Started now, in the main thread: Linux takes the end of that for this process's.

        Args:
            inherited: Arranges what processes of a run take over from this one.
        """
        self._warm = self._coming = False
        if sys.platform != "linux":  # elsewhere libraries do not bear a fork
            return
        FORK.set_forkserver_preload([WARMED])
        with inherited():
            os.environ.update(_same_modules())
            try:
                forkserver.ensure_running()
            except OSError as error:  # as where the folder of temporary files has a long name
                log.info("no zygote, each part imports for itself: %s", error)
                return
        self._coming = True
        threading.Thread(target=self._await, name="zygote", daemon=True).start()

    @property
    def context(self) -> ForkServerContext | SpawnContext:
        """In which a process begins soonest."""
        return FORK if self._warm else SPAWN

    def wait(self, stop: threading.Event, look: Callable[[], None]) -> None:
        """Until it is warm, or that takes too long, or the run shall end; `look` meanwhile."""
        until_s = time.monotonic() + WARM_S
        while self._coming and not (self._warm or stop.wait(LOOK_S)):
            if time.monotonic() > until_s:
                break
            look()

    def _await(self) -> None:
        """Its first fork is there as soon as it is warm, and says whether it is."""
        first = FORK.Process(target=_tell, daemon=True)
        with suppress(EOFError, OSError):  # it died: who needs it does without
            first.start()
            first.join()
            self._warm = first.exitcode == 0
        self._coming = self._warm


def forked_by() -> int | None:
    """The zygote that this process was forked of, by its number; None where it was not."""
    warmed = sys.modules.get(WARMED)
    return None if warmed is None else int(warmed.PID)


def _tell() -> None:
    raise SystemExit(0 if forked_by() else 1)


def _same_modules() -> dict[str, str]:
    """What lets another Python import what this one does, and no file of the working directory."""
    paths = os.pathsep.join(path or os.getcwd() for path in sys.path)
    return {"PYTHONSAFEPATH": "1", "PYTHONPATH": paths}
