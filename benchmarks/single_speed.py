"""How many frames a second one view is followed at, from its video to poses, its room known.

Run from the checkout: .venv/bin/python benchmarks/single_speed.py CLIPS... [--mode default|thesis]
"""

import argparse
import os
import sys
from pathlib import Path
from statistics import median
from typing import Any, Final

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

from rich.console import Console

from common.config.config_file import load
from common.config.part_settings import SettingsError
from common.video.clip_sources import ClipError
from common.video.pictures import DecoderDied, Undecodable
from lab.bench.single_bench import followed, parts_ms
from runtime.live.table import table_of_rows
from runtime.overrides import overridden

REPEATS: Final = 3


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clips", nargs="+", type=Path, help="clip folders")
    parser.add_argument("--mode", choices=("default", "thesis"), default="default")
    parser.add_argument("--size", default="320x240", help="of the working picture")
    given = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for path in given.clips:
        try:
            found = followed(overridden(load(path), given.mode, given.size), REPEATS)
        except (SettingsError, ClipError, DecoderDied, Undecodable) as error:
            print(error, file=sys.stderr)
            return 2
        rows.append({"name": path.name, **parts_ms(found), "frames/s": found.frames_a_second})
    middle = {key: median(row[key] for row in rows) for key in rows[0] if key != "name"}
    Console().print(table_of_rows([*rows, {"name": "median", **middle}]))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
