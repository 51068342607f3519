"""Processor time of a frame by people and cameras: of one viewer, and of the integrator.

Run from the checkout: .venv/bin/python benchmarks/people_speed.py [--people 1 2] [--cameras 2 3]

Scenes are made in which everybody performs at their place, all of them followed in lock-step by one
thread. A table in Markdown gives milliseconds of processor time, which other work on the machine
hardly changes, as the median over the frames after the opening: of a viewer's frame, its 99th
percentile, and of the integrator's instant. A live run has each in a process of its own, with
decoding, JPEGs for the page and messages beside.
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final, Literal, NamedTuple
from unittest.mock import patch

import numpy as np

from common.config.settings import Settings
from runtime.offline import performance
from runtime.offline.lockstep import Decoders, track_clip
from runtime.steps import together
from synth.scene.scene_clips import SceneSet, write_scenes
from tritrack.demo import POSTURES

SEED: Final = 91_001
SECONDS: Final = 5.0
FIRST: Final = 45
"""Frames of the opening, and of becoming known, which are not counted."""
SIZE: Final = (320, 240)


class Cost(NamedTuple):
    """Milliseconds of processor time, frame by frame."""

    viewer_ms: list[float]
    """Of one viewer, the mean of all."""
    integrator_ms: list[float]


def timed(function: Callable[..., Any], spent_ms: list[float], share: int) -> Callable[..., Any]:
    """The function, with its processor time noted, divided by the number of its workers."""

    def call(*given: Any) -> Any:
        before_s = time.process_time()
        found = function(*given)
        spent_ms.append(1000.0 * (time.process_time() - before_s) / share)
        return found

    return call


def cost_of(clip: Path, cameras: int, people: int) -> Cost:
    """What tracking a clip costs."""
    cost = Cost([], [])

    def one_by_one(viewers: Any, frames: Any, guide: Any, _: Any) -> Any:
        return together.looked(viewers, frames, guide, map)

    follows: Literal[1, "all"] = 1 if people == 1 else "all"
    with (
        patch.object(performance, "looked", timed(one_by_one, cost.viewer_ms, cameras)),
        patch.object(performance, "joined", timed(together.joined, cost.integrator_ms, 1)),
        Decoders() as decoders,
    ):
        track_clip(Settings(clip=str(clip), people=follows), decoders)
    return cost


def row_of(people: int, cameras: int, cost: Cost) -> str:
    """A line of the table."""
    viewer_ms, integrator_ms = (np.array(each[FIRST:]) for each in cost)
    figures = (
        np.median(viewer_ms),
        np.percentile(viewer_ms, 99),
        np.median(integrator_ms),
        np.percentile(integrator_ms, 99),
        cameras * np.mean(viewer_ms) + np.mean(integrator_ms),
    )
    return f"| {people} | {cameras} | " + " | ".join(f"{each:.1f}" for each in figures) + " |"


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the scenes, track them, print the table line by line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--people", type=int, nargs="*", default=[1, 2, 3, 4])
    parser.add_argument("--cameras", type=int, nargs="*", default=[2, 3, 4])
    given = parser.parse_args(arguments)
    print("| people | cameras | viewer, ms | p99 | integrator, ms | p99 | all, mean |")
    print("|---|---|---|---|---|---|---|")
    for people in given.people:
        for cameras in given.cameras:
            with tempfile.TemporaryDirectory(prefix="tritrack-speed-") as folder:
                wanted = SceneSet(people, SECONDS, 1, SEED, cameras, postures=POSTURES[:people])
                (clip,) = write_scenes(Path(folder), wanted, SIZE)
                print(row_of(people, cameras, cost_of(clip, cameras, people)), flush=True)


if __name__ == "__main__":
    main()
