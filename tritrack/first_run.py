"""Compilation of all that commands run by default: `make setup` waits for it."""

import tempfile
import time
from pathlib import Path
from typing import Final

from common.cache_folder import mark_of_all

MOTION_S: Final = 1.0
"""Length of what follows the opening posture: as long as any longer clip for what is compiled."""


def compile_all() -> None:
    """Track a short synthetic clip with both cameras and with one, and execute the code of live
    parts, so that no later run needs to compile.

    Each in a process of its own, on two cores. They begin with different code: who needs a function
    that the other has compiled loads it.

    A marker in the folder of compiled code says that this was done: the next call takes no longer
    than importing numba.
    """
    mark = mark_of_all()
    if mark.exists():
        return
    began = time.perf_counter()
    _run_all()
    mark.touch()
    print(f"compiled in {time.perf_counter() - began:.0f} s; the next start loads it")


def _run_all() -> None:
    from common.platform.platform import Job
    from common.platform.platforms import platform
    from runtime.warming.parts_warmup import compile_parts, warm_up

    parts = platform().start(Job("compiling", compile_parts, ())).worker
    _track()
    parts.join()
    if parts.exitcode:
        warm_up()  # what it died of is said here


def _track() -> None:
    from common.config.settings import Settings
    from runtime.offline.lockstep import Decoders, track_clip
    from runtime.warming.first_compilation import SIZE
    from tritrack.demo import made_clip

    with tempfile.TemporaryDirectory(prefix="tritrack-first-") as folder, Decoders() as decoders:
        settings = Settings(clip=str(made_clip(Path(folder), 2, SIZE, MOTION_S)))
        track_clip(settings, decoders)
        track_clip(settings, decoders, (1,))


if __name__ == "__main__":
    compile_all()
