"""What each departure from the paper buys: steps added one by one, and each left out of all.

Run from the checkout, on clips with a truth; names of performers are the columns:

    .venv/bin/python benchmarks/ablation.py clips/*/ [--size 160x120] [--processes 2]

The steps are switched off from outside, by putting something plainer in the place of a function;
with all of them off, `default` mode is `paper` mode on plain silhouettes. Prints a table in
Markdown: mean error of 12 joints, share of frames lost, CPU milliseconds a frame pair of the
tracking process (the empty room's learning included, the decoders not).
"""

import argparse
import os
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack, contextmanager
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

from integrator.paper.arbiter import arbitrate

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import cv2
import msgspec
import numpy as np

from common import config
from integrator import merge, outgoing
from integrator.fit import shape_fit
from integrator.paper import fused_pose, silhouette_vote
from integrator.proposal import pose_proposal
from tritrack.accuracy.accuracy import compare, summary
from tritrack.offline.lockstep import Decoders, overridden, track_clip
from tritrack.store.runs import poses
from viewer import track
from viewer.silhouette import silhouette

PLAIN_LEVELS = 25
"""Grey levels by which a pixel of a plain silhouette differs from the room."""


def plain_label(mask: Any, _: Any, frame: Any, room: Any, *given: Any) -> None:
    """Subtraction, threshold and a 3x3 opening, as printed (section 1), near the person."""
    _, gain, _, cells, cell = given
    off = np.abs(frame - room * gain).max(axis=2)
    opened = cv2.morphologyEx(
        (off > PLAIN_LEVELS).astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3))
    )
    near = cells.repeat(cell, axis=0).repeat(cell, axis=1)[: mask.shape[0], : mask.shape[1]]
    mask[:] = opened & near


def only(*given: Any) -> Any:
    """No doubt: the pose so far, (1, 25), is the last argument but one."""
    return given[-2][None]


def guided_alone(guide_of: Any, state: Any, *given: Any) -> Any:
    """Each viewer starts where it had the body itself."""
    printed = msgspec.structs.replace(state.settings, mode="paper")
    return guide_of(state._replace(settings=printed), *given)


def on_the_cylinders(pose_and_rest: Any, *given: Any) -> Any:
    """The pose, and joints that lie nowhere beside it."""
    pose, rest = pose_and_rest(*given)
    return pose, np.zeros_like(rest)


class Step(NamedTuple):
    """A departure, and what stands in its place when it is off."""

    what: str
    instead: tuple[tuple[Any, str, Any], ...]
    """Module, name in it, what takes its place."""


SILHOUETTES = (
    Step(
        "silhouettes follow the exposure",
        ((silhouette, "light_gain", lambda *_: np.ones(3, np.float32)),),
    ),
    Step("silhouettes by noise, shadows and neighbours", ((silhouette, "label", plain_label),)),
    Step(
        "silhouettes know the body's colours",
        ((silhouette, "familiar", lambda counts: np.zeros(counts.shape[1], np.float32)),),
    ),
    Step(
        "outlines drawn by coverage and a network",
        ((silhouette, "_outlined", lambda first: first.mask),),
    ),
    Step("the room follows slow light", ((silhouette, "_follow", lambda state, *_: state),)),
)
"""How a viewer finds its silhouette: in both modes, but more than is printed."""

POSES = (
    Step(
        "facing by sizes at the same distance",
        (
            (
                fused_pose,
                "arbitrate",
                lambda one, other, _, real=arbitrate: real(one, other, 1.0),
            ),
        ),
    ),
    Step(
        "views start where both have the body",
        ((outgoing, "guide_of", partial(guided_alone, outgoing.guide_of)),),
    ),
    Step("the body fitted to outlines", ((shape_fit, "step", lambda opening, *_: opening),)),
    Step("S1 S2: squats with a bowed trunk", ((silhouette_vote, "squatted", only),)),
    Step("S1 S2: place", ((silhouette_vote, "shifted", only),)),
    Step(
        "S1 S2: which arm swings, arms regained",
        tuple((silhouette_vote, n, only) for n in ("swung", "regained")),
    ),
    Step("S1 S2: joint by joint, unmeasured bodies", ((silhouette_vote, "turned", only),)),
    Step(
        "joints proposed by the network, not searched for",
        tuple((module, "proposes", lambda *_: False) for module in (track, merge)),
    ),
    Step(
        "joints beside the cylinders",
        ((pose_proposal, "pose_and_rest", partial(on_the_cylinders, pose_proposal.pose_and_rest)),),
    ),
)
"""What `default` mode does and `paper` mode does not."""

STEPS = (*SILHOUETTES, *POSES)


class Row(NamedTuple):
    """A line of the table."""

    what: str
    off: tuple[Step, ...]


class Result(NamedTuple):
    """What a row gave for one performer."""

    mean_mm: float
    lost: float
    ms: float


def rows(steps: Sequence[Step] = STEPS) -> list[Row]:
    """The paper's stages on plain silhouettes, every step added in turn, every one left out."""
    added = [Row(f"+ {step.what}", tuple(steps[i + 1 :])) for i, step in enumerate(steps)]
    left = [Row(f"all but: {step.what}", (step,)) for step in steps]
    return [Row("the paper's stages, plain silhouettes", tuple(steps)), *added, *left]


@contextmanager
def without(steps: Iterable[Step]) -> Iterator[None]:
    """Switch steps off, and on again.

    Raises:
        AttributeError: When a step's function is no longer there: this table is out of date.
    """
    with ExitStack() as doors:
        for step in steps:
            for module, name, instead in step.instead:
                doors.enter_context(patch.object(module, name, instead))
        yield


def measured(row: Row, clips: Sequence[Path], size: str | None) -> dict[str, Result]:
    """Track all clips with a row's steps off: its figures by performer."""
    found: dict[str, list[tuple[Any, float, int]]] = {}
    with Decoders() as decoders, without(row.off):
        for clip in clips:
            settings = overridden(config.load(clip), "default", size)
            began_s = time.process_time()
            done = track_clip(settings, decoders)
            spent_s = time.process_time() - began_s
            with np.load(clip / "truth.npz", allow_pickle=False) as truth:
                rows_of_run = poses([body for body in done.bodies if body.frame >= 0])
                one = compare(rows_of_run, truth)
            of_performer = found.setdefault(done.clip.meta.performer, [])
            of_performer.append((one, spent_s, len(done.bodies)))
    return {name: _result(each) for name, each in sorted(found.items())}


def _result(each: list[tuple[Any, float, int]]) -> Result:
    told = summary([one for one, _, _ in each])
    pairs = sum(count for _, _, count in each)
    ms = 1e3 * sum(spent_s for _, spent_s, _ in each) / pairs
    return Result(told["abs_mm"]["mean"], told["lost"], ms)


def numbered(number: int, clips: Sequence[Path], size: str | None) -> dict[str, Result]:
    """A row by its number, as another process asks for it."""
    cv2.setNumThreads(1)
    return measured(rows()[number], clips, size)


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
    parser.add_argument("--processes", type=int, default=1)
    given = parser.parse_args()
    bare = [clip for clip in given.clips if not (clip / "truth.npz").is_file()]
    if bare:
        parser.error(f"{bare[0]} has no truth.npz")
    work = partial(numbered, clips=given.clips, size=given.size)
    table = rows()
    with ProcessPoolExecutor(given.processes, get_context("spawn")) as pool:
        for number, results in enumerate(pool.map(work, range(len(table)))):
            if number == 0:
                print(f"| | {' | '.join([*results, 'all'])} | CPU ms a pair |")
                print("|---" * (len(results) + 3) + "|")
            print(line(table[number].what, results))
            sys.stdout.flush()


if __name__ == "__main__":
    main()
