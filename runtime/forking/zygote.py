"""The zygote: a process with everything imported and compiled, of which a run's parts are forked.

A fork works within milliseconds, where a process of its own imports and loads for seconds, and
shares with the others what it does not change. The zygote opens no door and begins no thread. When
it dies its forks live on (`reparenting.py`), and the next that is started brings up another one.

A process that was itself forked of a zygote, as that of a site is, has its own zygote by one fork
more: all rooms of a machine share what was loaded once.
"""

import logging
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from importlib import import_module
from multiprocessing import forkserver, util
from multiprocessing.context import ForkServerContext, SpawnContext
from typing import Any, Final

from common.cache_folder import mark_of_all
from common.child import parent_death

SPAWN: Final = multiprocessing.get_context("spawn")
FORK: Final = multiprocessing.get_context("forkserver")
"""Never the plain fork: Zenoh's threads are not inherited."""
WARMED: Final = f"{__package__}.warmed"
BOUND: Final = f"{parent_death.__package__}.parent_bound"
"""Imported first: what is loaded takes seconds, in which this process may die."""
WARM_S: Final = 20.0
"""So long a run waits for its zygote at most."""
COMPILED_S: Final = 600.0
"""So long where all is compiled anew: parts that did so each for itself would take far longer, and
compile in the midst of the run what they meet there first."""
LOOK_S: Final = 0.05

log = logging.getLogger(__name__)


class Zygote:
    """The zygote of this process: one for all its runs."""

    def __init__(
        self, inherited: Callable[[], AbstractContextManager[None]], loaded: str = WARMED
    ) -> None:
        """Started now, in the main thread: Linux takes the end of that for this process's.

        Args:
            inherited: Arranges what processes of a run take over from this one.
            loaded: The module that it imports, `warmed` or one that imports that.
        """
        self._warm = self._coming = False
        self._inherited = inherited
        if sys.platform != "linux":  # elsewhere libraries do not bear a fork
            return
        FORK.set_forkserver_preload([BOUND, loaded])
        self._warm = forked_by() is not None
        try:
            with _forked() if self._warm else nullcontext():
                self._begun()
        except OSError as error:  # as where the folder of temporary files has a long name
            log.info("no zygote, each part imports for itself: %s", error)
            self._warm = False
        else:
            self._expect()

    @property
    def context(self) -> ForkServerContext | SpawnContext:
        """In which a process begins soonest."""
        return FORK if self._warm else SPAWN

    def wait(self, stop: threading.Event, look: Callable[[], None], most_s: float = WARM_S) -> None:
        """Until it is warm, or that takes too long, or the run shall end; `look` meanwhile."""
        until_s = time.monotonic() + (most_s if mark_of_all().exists() else COMPILED_S)
        while self._coming and not (self._warm or stop.wait(LOOK_S)):
            if time.monotonic() > until_s:
                self._coming = False
                break
            look()

    def ready(self) -> bool:
        """Whether a process may begin now; asked in the main thread.

        A zygote that died is begun anew: who asks again and again need not stand still until it is
        warm, as who starts a process at once does.
        """
        if self._warm and self._begun():
            self._warm = False
            self._expect()
        return self._warm or not self._coming

    def _begun(self) -> bool:
        """See that it runs; whether it did not."""
        server: Any = forkserver._forkserver
        before = server._forkserver_pid
        with self._inherited():
            os.environ.update(_same_modules())
            forkserver.ensure_running()
        return bool(server._forkserver_pid != before)

    def _expect(self) -> None:
        """Notice when it is warm."""
        self._coming = not self._warm
        if self._warm:
            return
        threading.Thread(target=self._await, name="zygote", daemon=True).start()

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


@contextmanager
def _forked() -> Iterator[None]:
    """Meanwhile multiprocessing's server begins as a fork of this process, not as a new Python."""
    begun = util.spawnv_passfds
    util.spawnv_passfds = lambda path, args, passfds: _fork(passfds)  # noqa: ARG005
    try:
        yield
    finally:
        util.spawnv_passfds = begun


def _fork(passed: Sequence[int]) -> int:
    """A fork of this process that serves forks, given the files of multiprocessing's server; its
    number.

    No library may have begun a thread: forks would lack it.
    """
    starter = os.getpid()
    number = os.fork()
    if number:
        return number
    try:
        import_module(WARMED).begin(starter)
        for heeded in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            signal.signal(heeded, signal.SIG_DFL)  # this process's own are not for its parts
        listener, alive, *_ = passed
        forkserver.main(listener, alive, [])
    finally:
        os._exit(1)


def _tell() -> None:
    raise SystemExit(0 if forked_by() else 1)


def _same_modules() -> dict[str, str]:
    """What lets another Python import what this one does, and no file of the working directory."""
    paths = os.pathsep.join(path or os.getcwd() for path in sys.path)
    return {"PYTHONSAFEPATH": "1", "PYTHONPATH": paths}
