"""What each departure from the paper buys: fields of a Method added one by one, and each left out.

Run from the checkout, on clips with a truth; names of performers are the columns:

    .venv/bin/python benchmarks/ablation.py clips/*/ [--size 160x120] [--views 1] [--processes 2]
        [--rows arm squat_first]

The rows follow from `common.method.Method`: the paper, then every departure of the default method
added in turn, then each left out of all; of one view the thesis and its departure too. Prints a
table in Markdown: mean error of 12 joints, with one view after the hips are moved together, share
of frames lost, CPU milliseconds an instant of the tracking process (the background's learning
included, the decoders not).
"""

import argparse
import os
import sys
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import cv2
import msgspec
import numpy as np

from common.bus.messages import ViewerNumber
from common.config import config_file
from common.method import DEFAULT, PAPER, THESIS, Method
from lab.accuracy.accuracy import compare, summary
from runtime.offline.lockstep import Decoders, track_clip
from runtime.overrides import overridden
from runtime.store.pose_arrays import poses

SILHOUETTE_FIELDS = ("steady_light", "pixel_evidence", "body_colours", "alpha_matte", "slow_light")
"""With these alone it is the paper's search on our silhouettes."""


class Row(NamedTuple):
    """A line of the table."""

    what: str
    method: Method


class Result(NamedTuple):
    """What a row gave for one performer."""

    mean_mm: float
    lost: float
    ms: float


def with_fields(method: Method, names: Iterable[str], like: Method) -> Method:
    """A method with some fields as another has them."""
    return msgspec.structs.replace(method, **{name: getattr(like, name) for name in names})


def departures(method: Method, printed: Method = PAPER) -> tuple[str, ...]:
    """The fields in which a method differs from the print, in the order of their declaration."""
    return tuple(
        name for name in Method.__struct_fields__ if getattr(method, name) != getattr(printed, name)
    )


def rows(alone: bool = False) -> list[Row]:
    """The paper, every departure added in turn, and every one left out of all; of one view alone
    the thesis too, whose elbows no other row looks for."""
    names = departures(DEFAULT)
    first = Row("the paper, its silhouettes too", PAPER)
    added = [
        Row(f"+ {name}", with_fields(PAPER, names[: i + 1], DEFAULT))
        for i, name in enumerate(names)
    ]
    left = [Row(f"all but {name}", with_fields(DEFAULT, (name,), PAPER)) for name in names]
    ours = Row(
        "the paper's search, our silhouettes", with_fields(PAPER, SILHOUETTE_FIELDS, DEFAULT)
    )
    elbows = with_fields(THESIS, ("steady_elbows",), DEFAULT)
    thesis = [Row("the thesis", THESIS), Row("the thesis + steady_elbows", elbows)]
    return [first, *added, *left, ours, *(thesis if alone else [])]


def measured(
    row: Row, clips: Sequence[Path], size: str | None, views: tuple[ViewerNumber, ...]
) -> dict[str, Result]:
    """Track all clips with a row's method: its figures by performer."""
    found: dict[str, list[tuple[Any, float, int]]] = {}
    with Decoders() as decoders:
        for clip in clips:
            settings = overridden(config_file.load(clip), "default", size)
            began_s = time.process_time()
            done = track_clip(settings, decoders, views, method=row.method)
            spent_s = time.process_time() - began_s
            with np.load(clip / "truth.npz", allow_pickle=False) as truth:
                rows_of_run = poses([body for body in done.bodies if body.frame >= 0])
                one = compare(rows_of_run, truth)
            of_performer = found.setdefault(done.clip.meta.performer, [])
            of_performer.append((one, spent_s, len(done.bodies)))
    key = "abs_mm" if len(views) == 2 else "root_mm"
    return {name: _result(each, key) for name, each in sorted(found.items())}


def _result(each: list[tuple[Any, float, int]], key: str) -> Result:
    told = summary([one for one, _, _ in each])
    instants = sum(count for _, _, count in each)
    ms = 1e3 * sum(spent_s for _, spent_s, _ in each) / instants
    return Result(told[key]["mean"], told["lost"], ms)


def numbered(
    number: int, clips: Sequence[Path], size: str | None, views: tuple[ViewerNumber, ...]
) -> dict[str, Result]:
    """A row by its number, as another process asks for it."""
    cv2.setNumThreads(1)
    return measured(rows(len(views) == 1)[number], clips, size, views)


def line(what: str, results: dict[str, Result]) -> str:
    """A row of the table; the last columns are over all performers."""
    each = [*results.values()]
    over = Result(*(float(np.mean(values)) for values in zip(*each, strict=True)))
    cells = [f"{one.mean_mm:.1f} / {100 * one.lost:.1f} %" for one in (*each, over)]
    return f"| {what} | {' | '.join(cells)} | {over.ms:.2f} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("clips", type=Path, nargs="+", help="clip folders with a truth.npz")
    parser.add_argument("--size", help="bound of the working picture")
    parser.add_argument("--views", choices=("12", "1", "2"), default="12")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--rows", nargs="+", default=[""], help="only rows that have such a word")
    given = parser.parse_args()
    bare = [clip for clip in given.clips if not (clip / "truth.npz").is_file()]
    if bare:
        parser.error(f"{bare[0]} has no truth.npz")
    chosen: dict[str, tuple[ViewerNumber, ...]] = {"12": (1, 2), "1": (1,), "2": (2,)}
    work = partial(numbered, clips=given.clips, size=given.size, views=chosen[given.views])
    table = rows(len(chosen[given.views]) == 1)
    asked = [n for n, row in enumerate(table) if any(word in row.what for word in given.rows)]
    with ProcessPoolExecutor(given.processes, get_context("spawn")) as pool:
        for number, results in zip(asked, pool.map(work, asked), strict=True):
            if number == asked[0]:
                print(f"| | {' | '.join([*results, 'all'])} | CPU ms an instant |")
                print("|---" * (len(results) + 3) + "|")
            print(line(table[number].what, results))
            sys.stdout.flush()


if __name__ == "__main__":
    main()
