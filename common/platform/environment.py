"""The environment of started processes: one thread per library, one heap."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Final

FRUGAL: Final = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "1",
}
"""Variables for one thread per library, and one heap for all threads: glibc would make one for
each of Zenoh's."""


@contextmanager
def handed_down(variables: Mapping[str, str]) -> Iterator[None]:
    """Processes started inside this context inherit these variables; afterwards they are
    restored."""
    before = dict(os.environ)
    os.environ.update(variables)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)
