"""What the commands run by default, compiled once: what `make setup` waits for."""

import tempfile
import time
from pathlib import Path

from common.cache_folder import mark_of_all


def compile_all() -> None:
    """Track a synthetic clip by both cameras and by one, and pass through what live parts and a
    video meet besides, so that no later run need compile.

    A mark in the folder of what is compiled says that this was done: the next time takes no longer
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
