"""Compiled functions: numba's decorators, and what they compiled, kept for the next process."""

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
from common.cache_folder import compiled_folder, used_s
from common.packages import PACKAGES
from common.source_digest import module_digest

KEPT: Final = 8
"""States of the sources of which compiled code stays, for each function and signature: branches
and edits that come and go need not compile again."""

log = logging.getLogger(__name__)

Function = TypeVar("Function", bound=Callable[..., object])


class KeptOverloads(NullCache):
    """numba's cache of one function: a file for each signature and each state of the sources that
    the function rests on.

    numba's own is not for us: it looks at a function's own file alone, so a callee that changed in
    another one goes unnoticed, and two processes that compile two signatures at once give both the
    same name. A file here is named by all that decides its content; it is whole or not there.
    """

    def __init__(self, function: Callable[..., object]) -> None:
        """Nothing but sources is read, and nothing written, before the function is called."""
        self._name = f"{function.__module__}.{function.__qualname__}"
        self._sources = module_digest(function.__module__)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What was kept for a signature; None where nothing was, or what cannot be read."""
        target_context.refresh()
        key = (sig, target_context.codegen().magic_tuple())
        try:
            kept, payload = pickle.loads(self._path(key).read_bytes())
        except (OSError, EOFError, pickle.UnpicklingError):
            return None
        return CompileResult._rebuild(target_context, *payload) if kept == key else None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep it, but not what holds addresses of this process; on a full disk do without."""
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
        return compiled_folder() / f"{self._stem(key)}-{self._sources}.nbc"

    def _stem(self, key: Any) -> str:
        return f"{self._name}-{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}"

    def _prune(self, key: Any) -> None:
        """Remove what older sources gave for a signature, all but the newest KEPT."""
        of_all = compiled_folder().glob(f"{glob.escape(self._stem(key))}-*.nbc")
        for path in sorted(of_all, key=used_s, reverse=True)[KEPT:]:
            path.unlink(missing_ok=True)


class Compiler(Protocol):
    """A decorator: what it compiles is called as before."""

    def __call__(self, function: Function, /) -> Function:
        """The function, compiled where it is first called."""
        ...


def compiling(**flags: bool | str) -> Compiler:
    """A decorator: numba's njit with these flags, which keeps what it compiled and lets other
    threads run meanwhile.

    Functions of a module that runs as the program, or of a test, are compiled anew each time: the
    next process cannot know them by the name `__main__`, and no digest speaks for them.
    """

    def decorate(function: Function) -> Function:
        dispatcher = numba.njit(nogil=True, **flags)(function)
        if function.__module__.split(".")[0] in PACKAGES:
            dispatcher._cache = KeptOverloads(function)
        return dispatcher

    return decorate


compiled: Final = compiling()
"""A function that computes as Python does; division by zero is an error."""
KERNEL: Final = compiling(fastmath=True, error_model="numpy")
"""A whole-picture pass."""
INLINE: Final[Compiler] = numba.njit(fastmath=True, error_model="numpy", inline="always")
"""What a pass does at a pixel; calls that carry arrays would cost more than the work."""
