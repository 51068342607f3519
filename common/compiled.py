"""Compiled functions: numba's decorators, with compiled code cached for the next process."""

import glob
import hashlib
import logging
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, Protocol, TypeVar

import numba
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from common.atomic_file import replacing
from common.cache_folder import COMPILED, compiled_folder, used_s
from common.packages import PACKAGES
from common.source_digest import module_digest

KEPT: Final = 8
"""Number of source states whose compiled code is kept, for each function and signature:
switching between branches and edits then needs no new compilation."""

log = logging.getLogger(__name__)

Function = TypeVar("Function", bound=Callable[..., object])


class KeptOverloads(NullCache):
    """numba's cache of one function: a file for each signature and each state of the sources that
    the function depends on.

    numba's own cache looks at a function's own file alone, so it misses a change of a callee in
    another file. Two processes that compile two signatures at once would also write the same file
    name. Here the name contains all that decides the content, and the file is complete or absent.
    """

    def __init__(self, function: Callable[..., object]) -> None:
        """Before the first call nothing but sources is read, and nothing is written."""
        self._name = f"{function.__module__}.{function.__qualname__}"
        self._sources = module_digest(function.__module__)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The cached code for a signature; None where there is none, or where it cannot be read."""
        target_context.refresh()
        key = (sig, target_context.codegen().magic_tuple())
        try:
            kept, payload = pickle.loads(self._path(key).read_bytes())
        except (OSError, EOFError, pickle.UnpicklingError):
            return None
        return CompileResult._rebuild(target_context, *payload) if kept == key else None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Cache compiled code, unless it contains addresses of this process; a full disk is
        ignored."""
        if data.library.has_dynamic_globals:
            return
        key = (sig, data.codegen.magic_tuple())
        path = self._path(key)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with replacing(path) as new:
                new.write_bytes(dumps((key, data._reduce())))
            self._prune(key)
        except OSError as error:
            log.info("not kept: %s", error)

    def _path(self, key: Any) -> Path:
        return compiled_folder() / f"{self._stem(key)}-{self._sources}{COMPILED}"

    def _stem(self, key: Any) -> str:
        return f"{self._name}-{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}"

    def _prune(self, key: Any) -> None:
        """Remove the code of older sources for a signature, all but the newest KEPT."""
        of_all = compiled_folder().glob(f"{glob.escape(self._stem(key))}-*{COMPILED}")
        for path in sorted(of_all, key=used_s, reverse=True)[KEPT:]:
            path.unlink(missing_ok=True)


class Compiler(Protocol):
    """A decorator that keeps the signature of what it compiles."""

    def __call__(self, function: Function, /) -> Function:
        """The function, compiled at its first call."""
        ...


def compiling(**flags: bool | str) -> Compiler:
    """A decorator: numba's njit with these flags and this cache; other threads run during its
    calls.

    Functions of a module that runs as the program, or of a test, are compiled anew each time. The
    next process does not know them by the name `__main__`, and no digest covers them.
    """

    def decorate(function: Function) -> Function:
        dispatcher = numba.njit(nogil=True, **flags)(function)
        if function.__module__.split(".")[0] in PACKAGES:
            dispatcher._cache = KeptOverloads(function)
        return dispatcher

    return decorate


compiled: Final = compiling()
"""Compile a function that computes as Python does; division by zero is an error."""
KERNEL: Final = compiling(fastmath=True, error_model="numpy")
"""Compile a pass over a whole picture."""
INLINE: Final[Compiler] = numba.njit(fastmath=True, error_model="numpy", inline="always")
"""Compile an operation on one pixel; passing arrays to it would cost more than the work."""
