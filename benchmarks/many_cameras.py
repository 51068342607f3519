"""Whether more cameras are no worse than the best two of them, on clips of three and four cameras.

Run from the checkout: .venv/bin/python benchmarks/many_cameras.py FOLDER [--size 320x240]

FOLDER keeps the clips, made once, and the runs: with all cameras and with each pair. What is there
is not tracked again: name another FOLDER after a change. A table in Markdown gives the mean
distance of 12 joints from the truth over the frames with a pose, and in brackets the share of
frames that are lost: without a pose, or with a joint more than 200 mm off.
"""

import argparse
import subprocess
import sys
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from common.config.picture_size import size_of
from lab.accuracy.accuracy import LOST_MM, compare
from runtime.faults import UNFOLLOWED
from synth.write import ClipSet, write_set

SEED: Final = 97_001
"""Of the first clip; each has a seed, and so a person, a room and a rig, of its own."""
MOTIONS: Final = ("free", "walk_toward", "free", "kick_left_side", "squat_arms_forward")
"""What the people of each number of cameras do."""
CAMERAS: Final = (3, 4)
FILMED_PX: Final = (320, 240)

Views = tuple[str, ...]
"""Numbers of the cameras that are tracked."""


class Score(NamedTuple):
    """How far off a run is."""

    off_mm: float
    """Mean over joints and frames that have a pose."""
    lost: float
    """Share of the frames with a person."""

    def __str__(self) -> str:
        """As the table shows it."""
        return f"{self.off_mm:.1f} ({self.lost:.1%})"


def made(folder: Path, cameras: int) -> list[Path]:
    """The clips of a number of cameras, rendered where they are not there yet."""
    clips = []
    for n, motion in enumerate(MOTIONS):
        seed = SEED + cameras * len(MOTIONS) + n
        out = folder / "clips" / str(seed)
        if not [*out.glob("*/truth.npz")]:
            write_set(out, _wanted(motion, seed, cameras), FILMED_PX)
        clips += [path.parent for path in out.glob("*/truth.npz")]
    return clips


def _wanted(motion: str, seed: int, cameras: int) -> ClipSet:
    if motion == "free":
        return ClipSet("free", seed=seed, cameras=cameras)
    return ClipSet("postures", seed=seed, postures=(motion,), cameras=cameras)


def views_of(cameras: int) -> list[Views]:
    """All cameras, then each pair."""
    numbers = [str(n + 1) for n in range(cameras)]
    return [tuple(numbers), *combinations(numbers, 2)]


def track(clips: Sequence[Path], views: Views, out: Path, size: str) -> None:
    """Track clips with some of their cameras, by the command; what has a run is left."""
    due = [str(clip) for clip in clips if not (out / clip.name / "poses.npz").exists()]
    if not due:
        return
    seen = ("--views", ",".join(views), "--size", size, "--out", str(out))
    command = (sys.executable, "-m", "tritrack", "track", *due, *seen)
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode not in (0, UNFOLLOWED):
        sys.exit(f"{' '.join(command)}\n{done.stderr}")


def score(run: Path, clip: Path) -> Score:
    """A run against its clip's truth."""
    with np.load(run / "poses.npz") as poses, np.load(clip / "truth.npz") as truth:
        found = compare(dict(poses), dict(truth))
    followed = int((found.off_mm <= LOST_MM).all(axis=1).sum())
    return Score(float(found.off_mm.mean()), 1.0 - followed / found.due)


def row(clip: Path, scores: dict[Views, Score]) -> str:
    """A clip's line of the table."""
    everything, *pairs = scores
    pairs.sort(key=scores.__getitem__)
    shown = [f"{scores[pair]} {'+'.join(pair)}" for pair in (pairs[0], pairs[-1])]
    no_worse = "yes" if scores[everything].off_mm <= scores[pairs[0]].off_mm else "no"
    cells = [clip.name, len(everything), scores[everything], *shown, no_worse]
    return f"| {' | '.join(map(str, cells))} |"


def main() -> None:
    """Make the clips, track them, print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--size", default="320x240", help="that the clips are tracked at")
    given = parser.parse_args()
    size_of(given.size)
    print("| clip | cameras | all, mm (lost) | best pair | worst pair | all no worse than best |")
    print("|---|---|---|---|---|---|")
    for cameras in CAMERAS:
        clips, runs = made(given.folder, cameras), given.folder / f"runs_{given.size}"
        for views in views_of(cameras):
            track(clips, views, runs / "+".join(views), given.size)
        for clip in clips:
            found = {
                views: score(runs / "+".join(views) / clip.name, clip)
                for views in views_of(cameras)
            }
            print(row(clip, found), flush=True)


if __name__ == "__main__":
    main()
