"""What the commands run by default, compiled once: what `make setup` waits for."""

import sys
import tempfile
import time
from pathlib import Path

from common.cache_folder import mark_of_all
from common.child.parent_death import end_with


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
    from runtime.forking.parts_warmup import warm_up
    from runtime.offline.lockstep import Decoders, track_clip
    from tritrack.demo import made_clip

    with tempfile.TemporaryDirectory(prefix="tritrack-first-") as folder, Decoders() as decoders:
        settings = Settings(clip=str(made_clip(Path(folder))))
        track_clip(settings, decoders)
        track_clip(settings, decoders, (1,))
    warm_up()


if __name__ == "__main__":
    if len(sys.argv) > 1:  # the number of who started it, and without which it is not needed
        end_with(int(sys.argv[1]))
    compile_all()
