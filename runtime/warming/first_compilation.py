"""Compilation before a run's first frames, in a separate process: compilation starts threads."""

import io
from contextlib import redirect_stdout
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Final

from common.cache_folder import is_new, mark_of_all
from common.platform.platform import Job
from common.platform.platforms import platform

FIRST_RUN: Final = "tritrack.first_run"
"""Named, not imported: rooms import downward only."""


def compile_first() -> None:
    """Compile what is not compiled yet: a part that had to compile during a run would stall."""
    if not mark_of_all().exists():
        platform().start(Job("first run", compile_all, (), nests=True)).worker.join()


def compile_on_a_new_machine() -> None:
    """Compile everything where nothing was ever compiled: on two cores that takes less time than
    what a recorded clip needs does on one."""
    if is_new():
        compile_first()


def compile_all(_words: Connection) -> None:
    """Compile all that commands run by default, silently: a worker's job."""
    with redirect_stdout(io.StringIO()):
        import_module(FIRST_RUN).compile_all()
