"""Compilation of all that commands run by default: `make setup` waits for it."""

import tempfile
import time
from pathlib import Path

from common.cache_folder import mark_of_all


def compile_all() -> None:
    """Track a synthetic clip with both cameras and with one, and execute the further code of live
    parts and videos, so that no later run needs to compile.

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
    from common.config.settings import Settings
    from runtime.offline.lockstep import Decoders, track_clip
    from runtime.warming.parts_warmup import warm_up
    from tritrack.demo import made_clip

    with tempfile.TemporaryDirectory(prefix="tritrack-first-") as folder, Decoders() as decoders:
        settings = Settings(clip=str(made_clip(Path(folder))))
        track_clip(settings, decoders)
        track_clip(settings, decoders, (1,))
    warm_up()


if __name__ == "__main__":
    compile_all()
