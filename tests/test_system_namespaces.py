"""A room on four hosts, each with a clock of its own: slow, lossy and cut cables between them.

Two viewers, integrator and recogniser as `docs/serving.md` starts them, with keys that `tritrack
keys` made; on the recogniser's host somebody listens. Hosts are simulated (`tests/hosts.py`).
"""

import json
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import pytest
from hosts import Cable, Hosts, Unsimulated, hosts_of
from spoiling import copied, refilmed

from common.config.settings import Settings
from runtime.offline.lockstep import Decoders, track_clip

PARTS: Final = {
    "integrator": ("integrate",),
    "recognizer": ("recognize",),
    "viewer1": ("view", "--viewer", 1),
    "viewer2": ("view", "--viewer", 2),
}
"""The command of each host, by the name of its part."""
AHEAD_S: Final = {"integrator": 0, "recognizer": 5000, "viewer1": 3, "viewer2": 0}
"""How far each host's clock is ahead of the first's."""
EAR: Final = """
import json, sys, threading
from common.bus.bus import open_client
from common.bus.control_messages import Pulse
from common.bus.messages import Body, Posture
from common.config.config_file import load
from common.config.part_settings import BusSettings
import msgspec
from pathlib import Path
settings = load(Path(sys.argv[1]))
with open_client(settings.bus, settings.room, 120.0) as bus, open(sys.argv[2], "w") as file:
    boxes = [bus.subscribe(kind) for kind in (Body, Pulse, Posture)]
    while True:
        for box in boxes:
            message = box.take(0.02)
            while message is not None:
                told = {"kind": type(message).__name__, **msgspec.to_builtins(message)}
                file.write(json.dumps(told) + "\\n")
                message = box.take(0.0)
        file.flush()
"""
FRAMES: Final = 390
"""Nearly half a minute, for a cable that is cut and mended."""
FEW: Final = 135
"""For a cable that stays as it is from the first frame to the last."""
WAIT_S: Final = 150.0
NEAR_M: Final = 0.02
"""Bodies of the same frames differ by less where a guide came late or a view was missing before."""


class Heard(NamedTuple):
    """What was said on the bus, in its order."""

    bodies: list[dict[str, Any]]
    pulses: list[dict[str, Any]]
    postures: list[dict[str, Any]]
    logs: dict[str, str]

    def newest(self, process: str) -> dict[str, Any]:
        """The last pulse of a process."""
        return [pulse for pulse in self.pulses if pulse["process"] == process][-1]

    def told(self) -> str:
        """All that any process said was odd."""
        return "\n".join(pulse["detail"] for pulse in self.pulses)


@pytest.fixture(scope="module")
def network() -> Iterator[Hosts]:
    try:
        with hosts_of([*PARTS]) as hosts:
            yield hosts
    except Unsimulated as error:
        pytest.skip(f"hosts cannot be simulated here: {error}")


@pytest.fixture(scope="module")
def clips(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """There and back, by the number of frames; the short one is how the long one begins."""
    folder = tmp_path_factory.mktemp("far")
    found = {frames: copied(clip, folder / f"walk of {frames}") for frames in (FRAMES, FEW)}
    for frames, each in found.items():
        refilmed(each, lambda film, n=frames: [*film, *(3 * [*film[::-1], *film])][:n])  # type: ignore[misc]
    return found


@pytest.fixture(scope="module")
def offline(clips: dict[int, Path]) -> dict[int, dict[str, Any]]:
    """The bodies that lock-step gives of the long clip, by their frames."""
    with Decoders() as decoders:
        bodies = track_clip(Settings(clip=str(clips[FRAMES])), decoders).bodies
    return {
        body.frame: {"views": body.views, "joints_m": np.array(body.joints_m)} for body in bodies
    }


@pytest.fixture(scope="module")
def few(offline: dict[int, dict[str, Any]]) -> dict[int, dict[str, Any]]:
    """Those of the short one."""
    return {frame: body for frame, body in offline.items() if frame < FEW}


@pytest.fixture(scope="module")
def rigs(network: Hosts, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What each host has: settings, the authority, the two files of its part."""
    folder = tmp_path_factory.mktemp("rigs")
    hub = network.address["integrator"]
    command = (sys.executable, "-m", "tritrack", "keys", str(folder / "made"), "--host", hub)
    subprocess.run(command, check=True)
    for part in PARTS:
        own = folder / part
        (own / "keys").mkdir(parents=True)
        held = {"recognizer": ("recognizer", "client")}.get(part, (part,))
        for name in ("ca.pem", *(f"{name}.{end}" for name in held for end in ("pem", "key"))):
            shutil.copy(folder / "made" / name, own / "keys")
        (own / "any.toml").write_text(
            f'room = "far"\n[bus]\nendpoint = "tls/{hub}:7447"\n'
            'keys = "keys"\nsession = "one"\n[page]\nport = 0\n'
        )
    return folder


def looks_at(rigs: Path, clip: Path) -> None:
    """Let every host's settings name a clip."""
    for part in PARTS:
        text = f'clip = "{clip}"\n{(rigs / part / "any.toml").read_text()}'
        for name in ("room.toml", "ear.toml"):
            (rigs / part / name).write_text(text)


class Room:
    """The four parts and an ear, on their hosts."""

    def __init__(self, network: Hosts, rigs: Path, folder: Path, doors: ExitStack) -> None:
        """Start all."""
        self.network, self._folder = network, folder
        self._heard = folder / "heard.jsonl"
        self.parts = {
            part: self._started(doors, part, part, rigs, sys.executable, "-m", "tritrack", *words)
            for part, words in PARTS.items()
        }
        ear = (sys.executable, "-c", EAR)
        self._started(doors, "recognizer", "ear", rigs, *ear, self._heard)

    def heard(self) -> Heard:
        """All that was heard until now."""
        lines = self._heard.read_text().splitlines() if self._heard.exists() else []
        whole = [json.loads(line) for line in lines if line.endswith("}")]
        by_kind = {
            kind: [one for one in whole if one["kind"] == kind]
            for kind in ("Body", "Pulse", "Posture")
        }
        logs = {path.stem: path.read_text() for path in self._folder.glob("*.log")}
        return Heard(by_kind["Body"], by_kind["Pulse"], by_kind["Posture"], logs)

    def until(self, is_so: Callable[[Heard], object]) -> Heard:
        """Wait until something is so of what was heard."""
        until_s = time.monotonic() + WAIT_S
        while not is_so(heard := self.heard()):
            assert time.monotonic() < until_s, (heard.logs, heard.pulses[-4:])
            assert self.parts["integrator"].poll() is None, heard.logs
            time.sleep(0.1)
        return heard

    def over(self) -> Heard:
        """Wait until the clip is over and the integrator has ended."""
        try:
            assert self.parts["integrator"].wait(WAIT_S) == 0, self.heard().logs
        except subprocess.TimeoutExpired:
            pytest.fail(str((self.heard().logs, self.heard().pulses[-4:])))
        return self.heard()

    def _started(
        self, doors: ExitStack, host: str, name: str, rigs: Path, *words: object
    ) -> "subprocess.Popen[str]":
        log = doors.enter_context((self._folder / f"{name}.log").open("w"))
        first, second, third, *rest = words
        settings = rigs / host / "room.toml"
        command = (first, second, third, *rest[:1], settings, *rest[1:])
        if name == "ear":
            command = (first, second, third, settings.with_name("ear.toml"), *rest)
        return doors.enter_context(self.network.running(host, command, log, AHEAD_S[host]))


@pytest.fixture
def room(
    network: Hosts, rigs: Path, clips: dict[int, Path], tmp_path: Path
) -> Iterator[Callable[[int], Room]]:
    """Starts the parts before a clip of so many frames, once; cables are good again afterwards."""

    def started(frames: int) -> Room:
        looks_at(rigs, clips[frames])
        return Room(network, rigs, tmp_path, doors)

    with ExitStack() as doors:
        yield started
    for part in PARTS:
        network.cable(part)


def apart_m(heard: Heard, offline: dict[int, dict[str, Any]]) -> np.ndarray:
    """How far the bodies of both views are from those that lock-step gives of the same frame."""
    both = [body for body in heard.bodies if body["views"] == "both" and body["joints_m"]]
    pairs = [(np.array(body["joints_m"]), offline[body["frame"]]["joints_m"]) for body in both]
    return np.array([np.linalg.norm(a - b, axis=1).mean() for a, b in pairs if len(b)])


def refuse_confusion(heard: Heard, offline: dict[int, dict[str, Any]]) -> None:
    """Every frame comes once and in its order; what both views tell is of one instant."""
    frames = [body["frame"] for body in heard.bodies]
    assert frames == sorted(set(frames))
    assert np.quantile(apart_m(heard, offline), 0.95) < NEAR_M


def share_of_both(heard: Heard, offline: dict[int, dict[str, Any]]) -> float:
    """Of the frames that lock-step has of both views, those that the room has of both."""
    wanted = {frame for frame, body in offline.items() if body["views"] == "both"}
    both = {body["frame"] for body in heard.bodies if body["views"] == "both"}
    return len(both & wanted) / len(wanted)


@pytest.mark.slow
def test_clocks_seconds_apart_do_not_confuse_instants(
    room: Callable[[int], Room], few: dict[int, dict[str, Any]]
) -> None:
    """Viewers and recogniser ask how far the room's clock is from their own."""
    heard = room(FEW).over()
    refuse_confusion(heard, few)
    assert share_of_both(heard, few) > 0.8
    told = re.search(
        r"the room's clock is (\S+) s from ours \(within (\S+)\)", heard.logs["viewer1"]
    )
    assert told is not None
    offset_s, within_s = float(told[1]), float(told[2])
    assert abs(offset_s + AHEAD_S["viewer1"]) <= within_s < 0.01
    assert heard.postures
    for process in ("integrator", "recognizer", "viewer 1"):
        assert 0.0 < heard.newest(process)["latency_p50_ms"] < 500


@pytest.mark.slow
@pytest.mark.parametrize("slow", [("viewer2",), ("viewer1", "viewer2")], ids=["one", "both"])
def test_slow_cables_make_bodies_late_and_are_named(
    slow: tuple[str, ...],
    room: Callable[[int], Room],
    network: Hosts,
    few: dict[int, dict[str, Any]],
) -> None:
    """200 ms each way: the quicker view waits for the slower one."""
    for host in slow:
        network.cable(host, Cable(0.2))
    heard = room(FEW).over()
    refuse_confusion(heard, few)
    assert share_of_both(heard, few) > 0.5
    for host in slow:
        assert re.search(rf"view {host[-1]} is heard 0\.[2-4]\d s late", heard.told())
    assert heard.newest("integrator")["latency_p50_ms"] > 190


@pytest.mark.slow
def test_lossy_cables_lose_little(
    room: Callable[[int], Room], network: Hosts, few: dict[int, dict[str, Any]]
) -> None:
    """5 % of the packets of both viewers, each way."""
    for host in ("viewer1", "viewer2"):
        network.cable(host, Cable(loss=0.05))
    heard = room(FEW).over()
    refuse_confusion(heard, few)
    assert share_of_both(heard, few) > 0.7


@pytest.mark.slow
@pytest.mark.parametrize("host", ["viewer1", "integrator"])
def test_after_a_cut_of_six_seconds_all_are_back(
    host: str, room: Callable[[int], Room], network: Hosts, offline: dict[int, dict[str, Any]]
) -> None:
    """The other viewer goes on alone meanwhile; where the integrator is cut off, nobody does."""
    started = room(FRAMES)
    started.until(lambda heard: heard.bodies and heard.bodies[-1]["frame"] > 60)
    network.cable(host, Cable(cut=True))
    time.sleep(6.0)
    network.cable(host)
    heard = started.over()
    refuse_confusion(heard, offline)
    lost, *_ = re.findall(r"view 1 is lost \(it says nothing", heard.told())
    assert lost
    assert "view 1 is back" in heard.told()
    end = {frame: body for frame, body in offline.items() if frame > 300}
    assert share_of_both(heard, end) > 0.8
    if host == "viewer1":
        assert sum(body["views"] == "2" for body in heard.bodies) > 45
