"""What a live run loses when a part is killed or frozen, it is stopped, or its parent is killed.

Run from the checkout: .venv/bin/python benchmarks/chaos.py [--trials N] [--only CASE...] [--json]

With --people 2 --cameras 3 the demo of several people is run, each person has figures, and there is
one case more: a scene in which one of them leaves and comes back.
"""

import argparse
import itertools
import json
import os
import shutil
import signal
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, Literal, NamedTuple

import cv2
import numpy as np
import psutil
from chaos_trial import Outcome, Trial
from rich.console import Console

from common.bus.bus import BusError
from common.config.settings import Settings
from common.video.clips import open_clip
from runtime.live.table import table_of_rows
from synth.scene.people_scene import LEAVING_TAKE
from synth.scene.scene_clips import SceneSet, write_scenes
from tritrack import demo

FREEZE_S: Final = 2.0
STARTING_S: Final = (0.3, 1.0, 3.0, 0.5, 2.0, 5.0)
"""When a run that starts is stopped: one moment a trial, in turn. Python itself needs the first
tenth of a second, in which it heeds no signal."""
LEAVING_S: Final = 14.0
"""Length of the scene that one person leaves, seconds."""
COVERED_S: Final = (6.0, 9.0)
"""From when to when camera 1 is covered, where it is."""


def covered(clip: Path, folder: Path) -> Path:
    """A copy of a clip in which camera 1 sees nothing for a time."""
    copy = folder / "covered" / clip.name
    shutil.copytree(clip, copy)
    shutil.copy(clip.parent / "calibration.json", copy)
    (video,) = copy.glob("cam1.*")
    pictures = cv2.VideoCapture(str(clip / video.name))
    rate_hz, code = pictures.get(cv2.CAP_PROP_FPS), int(pictures.get(cv2.CAP_PROP_FOURCC))
    size = tuple(int(pictures.get(n)) for n in (cv2.CAP_PROP_FRAME_WIDTH, 4))
    out = cv2.VideoWriter(str(video), code, rate_hz, size)
    for n in itertools.count():
        there, picture = pictures.read()
        if not there:
            break
        is_covered = COVERED_S[0] <= n / rate_hz < COVERED_S[1]
        out.write(np.zeros_like(picture) if is_covered else picture)
    out.release()
    return copy


def kill(process: psutil.Process) -> None:
    process.kill()


def freeze(process: psutil.Process) -> None:
    process.suspend()
    time.sleep(FREEZE_S)
    process.resume()


def by(number: signal.Signals) -> Callable[[psutil.Process], None]:
    return lambda process: process.send_signal(number)


def nothing(_: psutil.Process) -> None:
    """The run is left alone."""


class Case(NamedTuple):
    """What is done to which part; "" is the run's own process."""

    name: str
    part: str
    harm: Callable[[psutil.Process], None]
    whole: bool = True
    """The run goes on until the end of its clip."""
    starting: bool = False
    covers: bool = False
    """Camera 1 is covered for a time."""
    leaves: bool = False
    """Of several people one leaves, and comes back within 5 s."""


CASES: Final = (
    Case("viewer 1 killed", "viewer 1", kill),
    Case("viewer 2 killed", "viewer 2", kill),
    Case("integrator killed", "integrator", kill),
    Case("recogniser killed", "recognizer", kill),
    Case("page killed", "animator", kill),
    Case("zygote killed", "zygote", kill),
    Case("decoder of viewer 1 killed", "decoder 1", kill),
    Case("viewer 1 frozen 2 s", "viewer 1", freeze),
    Case("viewer 2 frozen 2 s", "viewer 2", freeze),
    Case("integrator frozen 2 s", "integrator", freeze),
    Case("camera 1 covered 3 s", "", nothing, covers=True),
    Case("left alone", "", nothing),
    Case("one person leaves", "", nothing, leaves=True),
    Case("SIGINT running", "", by(signal.SIGINT), whole=False),
    Case("SIGTERM running", "", by(signal.SIGTERM), whole=False),
    Case("SIGINT starting", "", by(signal.SIGINT), whole=False, starting=True),
    Case("SIGTERM starting", "", by(signal.SIGTERM), whole=False, starting=True),
    Case("parent killed", "", kill, whole=False),
)


class Clip(NamedTuple):
    """What the runs are of."""

    path: Path
    frames: int
    cameras: int
    people: Literal[1, "all"]


def tried(case: Case, clip: Clip, turn: int) -> Outcome:
    """One trial of a case."""
    with tempfile.TemporaryDirectory(prefix="tritrack-chaos-") as folder:
        path = covered(clip.path, Path(folder)) if case.covers else clip.path
        one = Trial(path, Path(folder), clip.cameras, clip.people)
        if case.starting:
            time.sleep(STARTING_S[turn % len(STARTING_S)])
            one.remember()
            case.harm(psutil.Process(one.run.pid))
        else:
            try:
                one.harmed(case.part, case.harm)
            except BusError:
                one.run.kill()
        return one.outcome(clip.frames, case.whole, restarted="killed" in case.name and case.whole)


def row_of(name: str, outcomes: Sequence[Outcome]) -> dict[str, object]:
    """A case's trials in a line."""

    def each(values: Sequence[object]) -> str:
        return " ".join("-" if value is None else str(value) for value in values)

    def seconds(values: Sequence[float | None]) -> str:
        return each([None if value is None else round(value, 1) for value in values])

    return {
        "name": name,
        "missing": each([one.missing for one in outcomes]),
        "in a row": each([one.gap for one in outcomes]),
        "back s": seconds([one.back_s for one in outcomes]),
        "lost s": seconds([one.lost_s for one in outcomes]),
        "exit": each([one.code for one in outcomes]),
        "orphans": each([one.orphans for one in outcomes]),
        "ports held": each([one.ports for one in outcomes]),
        "rows": each([one.rows for one in outcomes]),
        "people": " | ".join(one.people for one in outcomes if one.people),
    }


def clip_of(given: argparse.Namespace, folder: Path) -> Clip:
    """The clip that is asked for: the demo's, or another."""
    if given.clip is not None:
        path = given.clip.resolve()
    elif given.people > 1:
        path = demo.made_scene(folder, given.people, given.cameras)
    else:
        path = demo.made_clip(folder, given.cameras)
    return opened(path, given.people)


def opened(path: Path, people: int) -> Clip:
    views = open_clip(Settings(clip=str(path))).views
    return Clip(path, views[0].frames, len(views), 1 if people == 1 else "all")


def leaving_clip(given: argparse.Namespace, folder: Path) -> Clip:
    """A scene in which one of several leaves and comes back."""
    wanted = SceneSet(
        given.people, LEAVING_S, 1, given.seed, given.cameras, first_take=LEAVING_TAKE
    )
    (path,) = write_scenes(folder / "leaving", wanted, demo.SIZE)
    return opened(path, given.people)


def main(arguments: Sequence[str] | None = None) -> None:
    """Make a clip, try every case, print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=3)
    parser.add_argument("--only", nargs="*", choices=[case.name for case in CASES])
    parser.add_argument("--people", type=int, default=1)
    parser.add_argument("--cameras", type=int, default=2)
    parser.add_argument("--clip", type=Path, help="this clip, of one person or of --people")
    parser.add_argument("--seed", type=int, default=90_001, help="of the scene that one leaves")
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args(arguments)
    wanted = [
        case
        for case in CASES
        if (given.only is None or case.name in given.only) and (given.people > 1 or not case.leaves)
    ]
    console, rows = Console(stderr=True), []
    with tempfile.TemporaryDirectory(prefix="tritrack-chaos-") as folder:
        common = clip_of(given, Path(folder)) if any(not case.leaves for case in wanted) else None
        for case in wanted:
            clip = leaving_clip(given, Path(folder)) if case.leaves else common
            assert clip is not None
            outcomes = [tried(case, clip, turn) for turn in range(given.trials)]
            rows.append(row_of(case.name, outcomes))
            console.print(" | ".join(str(value) for value in rows[-1].values()))
    print(json.dumps(rows, indent=1)) if given.json else Console(width=160).print(
        table_of_rows(rows)
    )


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
