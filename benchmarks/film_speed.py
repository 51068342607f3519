"""How many frames a second `tritrack single` gets through, all of it, if it has one core.

Run from the checkout: .venv/bin/python benchmarks/film_speed.py VIDEOS... [--size 640x480]

From the command to its last line: learning the room, outlines, poses, the overlay, its encoding,
every reading of the film by the decoder, curves, animation, the start of Python. Counted is the
processor time of the command and of the processes that it starts, so that the figure is that of
one core whatever else the machine does. The first run of a changed checkout also compiles: run it
twice.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from rich.console import Console

from runtime.live.table import table_of_rows

ONE_CORE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")


def spent_s() -> float:
    """Processor time of all processes that were waited for."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def row_of(video: Path, size: str) -> dict[str, Any]:
    """The figures of one film; what is wrong with it ends the benchmark."""
    before_s = spent_s()
    with tempfile.TemporaryDirectory(prefix="tritrack-speed-") as folder:
        asked = ["single", str(video), "--out", folder, "--size", size, "--json"]
        done = subprocess.run(
            [sys.executable, "-m", "tritrack", *asked],
            stdout=subprocess.PIPE,
            env=os.environ | ONE_CORE,
            check=True,
        )
        (told,) = json.loads(done.stdout)["clips"].values()
        bytes_ = Path(told["overlay"]).stat().st_size
    all_s = spent_s() - before_s
    return {
        "name": video.name,
        "frames": told["frames"],
        "ms a frame": 1e3 * all_s / told["frames"],
        "frames/s": told["frames"] / all_s,
        "overlay": told["overlay_codec"],
        "kB a frame": 1e-3 * bytes_ / told["frames"],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("videos", nargs="+", type=Path)
    parser.add_argument("--size", default="640x480", help="of the working picture")
    given = parser.parse_args()
    Console(width=140).print(table_of_rows([row_of(video, given.size) for video in given.videos]))


if __name__ == "__main__":
    main()
