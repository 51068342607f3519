"""The zygote: a process with everything imported and compiled, which forks a run's parts.

A fork works within milliseconds, while a new process imports and loads for seconds; a fork also
shares unchanged memory with the others. The zygote opens no sockets and starts no threads. When it
dies its forks live on (`reparenting.py`), and the next start of a part begins a new zygote.

A process that was itself forked of a zygote, as a site's is, gets its own zygote by another fork:
all rooms of a machine share what was loaded once.
"""

import logging
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from importlib import import_module
from multiprocessing import forkserver, util
from typing import Any, Final

from common.cache_folder import mark_of_all
from common.platform.linux.forked_child import FORK
from common.platform.linux.part_process import begun, inherited
from common.platform.platform import COMPILED_S, WARM_S, Job, Started

SERVING: Final = f"{__package__}.serving_forks"
"""Imported first: loading takes seconds, in which this process may die."""
LOOK_S: Final = 0.05

log = logging.getLogger(__name__)


class Zygote:
    """The zygote of this process: one for all its runs."""

    def __init__(self, loaded: str) -> None:
        """Started now, in the main thread: Linux takes that thread's end for this process's.

        Args:
            loaded: The module that it imports.
        """
        self._coming, self._loaded = False, loaded
        FORK.set_forkserver_preload([SERVING, begun.__module__, loaded])
        self.warm = is_forked()
        """Whether workers are forked, and not new Pythons."""
        try:
            with _forked() if self.warm else nullcontext():
                self._begun()
        except OSError as error:  # as where the folder of temporary files has a long name
            log.info("no zygote, each part imports for itself: %s", error)
            self.warm = False
        else:
            self._expect()

    def start(self, job: Job) -> Started:
        """Begin a worker: forked where the zygote is warm, else a new Python."""
        if self.warm:
            with suppress(EOFError, OSError):  # the zygote died just now
                return begun(job, forked=True)
        return begun(job, forked=False)

    def wait(self, stop: threading.Event, look: Callable[[], None], most_s: float = WARM_S) -> None:
        """Wait until it is warm, or that takes too long, or the run shall end; `look` meanwhile."""
        until_s = time.monotonic() + (most_s if mark_of_all().exists() else COMPILED_S)
        while self._coming and not (self.warm or stop.wait(LOOK_S)):
            if time.monotonic() > until_s:
                self._coming = False
                break
            look()

    def ready(self) -> bool:
        """Whether a process may begin now; called in the main thread.

        A dead zygote is begun again: a caller that asks repeatedly need not wait until it is warm,
        unlike one that starts a process at once.
        """
        if self.warm and self._begun():
            self.warm = False
            self._expect()
        return self.warm or not self._coming

    def _begun(self) -> bool:
        """Ensure that it runs; whether it did not."""
        server: Any = forkserver._forkserver
        before = server._forkserver_pid
        with inherited():
            os.environ.update(_same_modules())
            forkserver.ensure_running()
        return bool(server._forkserver_pid != before)

    def _expect(self) -> None:
        """Notice when it is warm."""
        self._coming = not self.warm
        if self.warm:
            return
        threading.Thread(target=self._await, name="zygote", daemon=True).start()

    def _await(self) -> None:
        """Its first fork exists as soon as it is warm, and reports that."""
        first = FORK.Process(target=_tell, args=(self._loaded,), daemon=True)
        with suppress(EOFError, OSError):  # it died: workers are new Pythons then
            first.start()
            first.join()
            self.warm = first.exitcode == 0
        self._coming = self.warm


def is_forked() -> bool:
    """Whether this process was forked of a zygote."""
    return SERVING in sys.modules


@contextmanager
def _forked() -> Iterator[None]:
    """Inside this context multiprocessing's server begins as a fork of this process, not as a
    new Python."""
    begun = util.spawnv_passfds
    util.spawnv_passfds = lambda path, args, passfds: _fork(passfds)  # noqa: ARG005
    try:
        yield
    finally:
        util.spawnv_passfds = begun


def _fork(passed: Sequence[int]) -> int:
    """A fork of this process that serves forks, given the files of multiprocessing's server; its
    number.

    No library may have started a thread: forks would lack it.
    """
    starter = os.getpid()
    number = os.fork()
    if number:
        return number
    import_module(SERVING).serve(starter, passed)  # it does not return
    raise AssertionError("a zygote went on as the process that it was forked of")


def _tell(loaded: str) -> None:
    raise SystemExit(0 if loaded in sys.modules else 1)


def _same_modules() -> dict[str, str]:
    """Arguments with which another Python imports the same modules, and no file of the working
    directory."""
    paths = os.pathsep.join(path or os.getcwd() for path in sys.path)
    return {"PYTHONSAFEPATH": "1", "PYTHONPATH": paths}
