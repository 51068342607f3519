"""One live run that is harmed, and what is left of it."""

import itertools
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final, Literal, NamedTuple

import numpy as np
import psutil

from common.bus.bus import open_client
from common.bus.control_messages import Pulse
from common.bus.messages import Body
from common.config.part_settings import BusSettings, PageSettings
from common.config.settings import Settings
from common.npz_file import Arrays
from lab.accuracy.identity import gaps_of, presences
from runtime.live.free_ports import free_settings
from runtime.store.past_run import PastRunError, open_run
from runtime.store.run_people import people_of
from runtime.store.runs import BELIEVED
from synth.write import FPS

HARM_S: Final = 4.0
"""After the first body: the person is measured then."""
ORPHANED_S: Final = 2.0
PATIENCE_S: Final = 120.0
AWAY_FRAMES: Final = 15
"""Shortest absence from a scene that counts, frames."""
LIVE: Final = (sys.executable, "-m", "tritrack", "live")
STARTED: Final = ("animator", "integrator", "recognizer")
"""In the order in which a run starts them; then come the viewers, by number."""


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
        self.clip = clip
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
            people_in(poses) + who_is_who(poses, self.clip),
        )


def people_in(poses: Arrays) -> str:
    """Of each of several people: the number, rows, and share of them that are believed."""
    lines = []
    for number in people_of(poses):
        own = poses["status"][poses["person"] == number]
        lines.append(f"{number}: {len(own)} rows, {np.isin(own, BELIEVED).mean():.0%}")
    return "" if people_of(poses) == (0,) else ", ".join(lines)


def who_is_who(poses: Arrays, clip: Path) -> str:
    """Of a made-up scene of several: as which number each person was followed, again when they
    have come back, and in which share of their frames."""
    if people_of(poses) == (0,) or not (clip / "truth.npz").exists():
        return ""
    with np.load(clip / "truth.npz") as file:
        truth = dict(file)
    lines = [
        f"; {one.who} from {one.first / FPS:.1f} to {one.last / FPS:.1f} s as {one.number} "
        f"({one.share:.0%})"
        for one in presences(gaps_of(poses, truth), AWAY_FRAMES)
    ]
    return "".join(lines)


def spoken_of(processes: Sequence[psutil.Process], word: str) -> list[psutil.Process]:
    return [one for one in processes if word in " ".join(one.cmdline())]


def by_age(processes: Sequence[psutil.Process]) -> list[psutil.Process]:
    return sorted(processes, key=lambda one: (one.create_time(), one.pid))


def pipes(process: psutil.Process) -> set[str]:
    """The pipes that a process holds an end of."""
    held = Path(f"/proc/{process.pid}/fd").iterdir()
    return {name for name in map(os.readlink, held) if name.startswith("pipe:")}


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
