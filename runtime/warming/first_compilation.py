"""Compilation before a run's first frames or beside them, in a separate process: compilation
starts threads."""

import io
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Final

from common.cache_folder import is_new, mark_of_all
from common.platform.platform import Job
from common.platform.platforms import platform

FIRST_RUN: Final = "tritrack.first_run"
"""Named, not imported: rooms import downward only."""
SIZE: Final = (160, 120)
"""Size of the synthetic pictures; the compiled code is valid for any."""


def compile_first() -> None:
    """Compile what is not compiled yet: a part that had to compile during a run would stall."""
    if not mark_of_all().exists():
        platform().start(Job("first run", compile_all, (), nests=True)).worker.join()


@contextmanager
def compiling_beside() -> Iterator[None]:
    """Inside this context, where nothing was ever compiled, another process compiles the
    integrator's code: who tracks begins with the viewers', and loads what is compiled already."""
    if not is_new():
        yield
        return
    worker = platform().start(Job("compiling", compile_integrator, ())).worker
    try:
        yield
    finally:
        worker.kill()
        worker.join()


def compile_all(_words: Connection) -> None:
    """Compile all that commands run by default, silently: a worker's job."""
    with redirect_stdout(io.StringIO()):
        import_module(FIRST_RUN).compile_all()


def compile_integrator(_words: Connection) -> None:
    """Compile what an integrator executes, silently: a worker's job."""
    from common.config.settings import Settings
    from integrator.integrator_warmup import warm_up

    with redirect_stdout(io.StringIO()):
        warm_up(Settings(), SIZE)
