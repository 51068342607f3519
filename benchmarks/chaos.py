"""What a live run loses when a part is killed or frozen, it is stopped, or its parent is killed.

Run from the checkout: .venv/bin/python benchmarks/chaos.py [--trials N] [--only CASE...] [--json]

With --people 2 --cameras 3 the demo of several people is run, and each person has figures. A clip
of a scene in which one of them leaves is given by --clip FOLDER, with --only "left alone".
"""

import argparse
import itertools
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, Literal, NamedTuple

import cv2
import numpy as np
import psutil
from rich.console import Console

from common.bus.bus import BusError, open_client
from common.bus.control_messages import Pulse
from common.bus.messages import Body
from common.config.part_settings import BusSettings, PageSettings
from common.config.settings import Settings
from common.npz_file import Arrays
from common.video.clips import open_clip
from runtime.live.free_ports import free_settings
from runtime.live.table import table_of_rows
from runtime.store.past_run import PastRunError, open_run
from runtime.store.run_people import people_of
from runtime.store.runs import BELIEVED
from tritrack import demo

HARM_S: Final = 4.0
"""After the first body: the person is measured then."""
FREEZE_S: Final = 2.0
STARTING_S: Final = (0.3, 1.0, 3.0, 0.5, 2.0, 5.0)
"""When a run that starts is stopped: one moment a trial, in turn. Python itself needs the first
tenth of a second, in which it heeds no signal."""
ORPHANED_S: Final = 2.0
PATIENCE_S: Final = 120.0
LIVE: Final = (sys.executable, "-m", "tritrack", "live")
STARTED: Final = ("animator", "integrator", "recognizer")
"""In the order in which a run starts them; then come the viewers, by number."""
COVERED_S: Final = (6.0, 9.0)
"""From when to when camera 1 is covered, where it is."""


class Outcome(NamedTuple):
    """What one trial showed."""

    missing: int | None
    """Frames of the clip without a row; None where the run was to end early."""
    gap: int
    """Most of them in a row."""
    back_s: float | None
    """From the harm until the part works again; None where it was not to be started again."""
    code: int
    orphans: int
    """Processes of the run that live two seconds after its end."""
    ports: int
    """Ports that are still held then."""
    rows: int | None
    """Rows of the run; None where it cannot be read."""
    lost_s: float | None = None
    """What was heard before the parent died and is not in the run, seconds."""
    people: str = ""
    """Of each of several people: the number, rows, and share of them that are believed."""


class Trial:
    """One live run, and a witness on its bus."""

    def __init__(self, clip: Path, folder: Path, cameras: int, people: Literal[1, "all"]) -> None:
        """Start it."""
        self.cameras = range(1, cameras + 1)
        settings = free_settings(Settings(clip=str(clip), pictures=True))
        self.bus: BusSettings = settings.bus
        self.page: PageSettings = settings.page
        self.out = folder / "out"
        text = f'clip = "{clip}"\npictures = true\npeople = {json.dumps(people)}\n'
        text += f"[page]\nport = {self.page.port}\n"
        (folder / "run.toml").write_text(f'{text}[bus]\nendpoint = "{self.bus.endpoint}"\n')
        words = [*LIVE, str(folder / "run.toml"), "--no-wait", "--out", str(self.out)]
        self.run = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.began_s = time.monotonic()
        self.bodies: list[Body] = []
        self.back_s: float | None = None
        self.seen: dict[int, psutil.Process] = {}

    def parts(self) -> dict[str, psutil.Process]:
        """Its processes by their names, and each decoder by that of its viewer: both were forked
        by the zygote, and one pipe is theirs alone."""
        children = psutil.Process(self.run.pid).children()
        zygote, *forked = by_age(spoken_of(children, "forkserver"))
        in_order = by_age([*spoken_of(children, "spawn_main"), *forked])
        names = (*STARTED, *(f"viewer {number}" for number in self.cameras))
        named = {"zygote": zygote, **dict(zip(names, in_order, strict=False))}
        decoders = by_age(zygote.children())
        held = {one: pipes(one) for one in [*forked, *decoders]}
        shared = set.intersection(*held.values())
        for number, one in itertools.product(self.cameras, decoders):
            if held.get(one, set()) & held[named[f"viewer {number}"]] - shared:
                named[f"decoder {number}"] = one
        return named

    def harmed(self, part: str, harm: Callable[[psutil.Process], None]) -> None:
        """Listen until the harm is due, do it, and listen until the run is over."""
        with open_client(self.bus, "room", PATIENCE_S) as bus:
            heard, pulses = bus.subscribe(Body), bus.subscribe(Pulse)
            first_s: float | None = None
            harmed_s: float | None = None
            name = part.replace("decoder", "viewer")
            while self.run.poll() is None and time.monotonic() - self.began_s < PATIENCE_S:
                self.bodies += [one for one in [heard.take(0.02), *heard.drain()] if one]
                now_s = time.monotonic()
                first_s = first_s or (now_s if self.bodies else None)
                if harmed_s is None and first_s and now_s - first_s > HARM_S:
                    self.remember()
                    target = self.parts().get(part) if part else psutil.Process(self.run.pid)
                    assert target is not None, f"there is no {part}"
                    pulses.drain()
                    harmed_s = now_s
                    harm(target)
                for pulse in pulses.drain():
                    ready = pulse.process == name and pulse.state in ("ready", "running")
                    if ready and harmed_s and self.back_s is None:
                        self.back_s = time.monotonic() - harmed_s

    def remember(self) -> None:
        """All processes that the run has now."""
        for one in psutil.Process(self.run.pid).children(recursive=True):
            self.seen[one.pid] = one

    def outcome(self, frames: int, whole: bool, restarted: bool) -> Outcome:
        """What is left of it."""
        code = self.run.wait(PATIENCE_S)
        time.sleep(ORPHANED_S)
        alive = [one for one in self.seen.values() if lives(one)]
        held = [port for port in (self.page.port, port_of(self.bus)) if is_held(port)]
        for one in alive:
            one.kill()
        try:
            poses = open_run(self.out).poses
        except PastRunError:
            return Outcome(None, 0, self.back_s, code, len(alive), len(held), None)
        found = np.unique(poses["frame"])
        missing = np.setdiff1d(np.arange(frames), found) if whole else None
        gap = int(np.diff(found).max(initial=1)) - 1
        last_s = float(poses["time_s"][-1]) if len(found) else 0.0
        lost_s = max(0.0, self.bodies[-1].captured_s - last_s) if self.bodies else None
        return Outcome(
            None if missing is None else len(missing),
            gap,
            self.back_s if restarted else None,
            code,
            len(alive),
            len(held),
            len(found),
            None if whole else lost_s,
            people_in(poses),
        )


def people_in(poses: Arrays) -> str:
    """Of each of several people: the number, rows, and share of them that are believed."""
    told = []
    for number in people_of(poses):
        own = poses["status"][poses["person"] == number]
        told.append(f"{number}: {len(own)} rows, {np.isin(own, BELIEVED).mean():.0%}")
    return "" if people_of(poses) == (0,) else ", ".join(told)


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


def spoken_of(processes: Sequence[psutil.Process], word: str) -> list[psutil.Process]:
    return [one for one in processes if word in " ".join(one.cmdline())]


def by_age(processes: Sequence[psutil.Process]) -> list[psutil.Process]:
    return sorted(processes, key=lambda one: (one.create_time(), one.pid))


def pipes(process: psutil.Process) -> set[str]:
    """The pipes that a process holds an end of."""
    held = Path(f"/proc/{process.pid}/fd").iterdir()
    return {name for name in map(os.readlink, held) if name.startswith("pipe:")}


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


def lives(process: psutil.Process) -> bool:
    try:
        return bool(process.is_running() and process.status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False


def port_of(bus: BusSettings) -> int:
    return int(bus.endpoint.rpartition(":")[2])


def is_held(port: int) -> bool:
    with socket.socket() as door:
        door.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            door.bind(("127.0.0.1", port))
        except OSError:
            return True
    return False


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
    views = open_clip(Settings(clip=str(path))).views
    return Clip(path, views[0].frames, len(views), 1 if given.people == 1 else "all")


def main(arguments: Sequence[str] | None = None) -> None:
    """Make a clip, try every case, print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=3)
    parser.add_argument("--only", nargs="*", choices=[case.name for case in CASES])
    parser.add_argument("--people", type=int, default=1)
    parser.add_argument("--cameras", type=int, default=2)
    parser.add_argument("--clip", type=Path, help="this clip, of one person or of --people")
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args(arguments)
    console, rows = Console(stderr=True), []
    with tempfile.TemporaryDirectory(prefix="tritrack-chaos-") as folder:
        clip = clip_of(given, Path(folder))
        for case in CASES:
            if given.only is None or case.name in given.only:
                outcomes = [tried(case, clip, turn) for turn in range(given.trials)]
                rows.append(row_of(case.name, outcomes))
                console.print(" | ".join(str(value) for value in rows[-1].values()))
    print(json.dumps(rows, indent=1)) if given.json else Console(width=160).print(
        table_of_rows(rows)
    )


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
