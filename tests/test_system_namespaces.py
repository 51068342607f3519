"""A room on four hosts, each with a clock of its own: slow, lossy and cut cables between them.

Two viewers, integrator and recogniser as `docs/serving.md` starts them, with keys as `tritrack keys`
makes them; on the recogniser's host somebody listens. Hosts are simulated (`tests/hosts.py`).
"""

import json
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

from common.config import Settings
from tritrack.offline.lockstep import Decoders, track_clip

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
from common.config import BusSettings, load
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
WAIT_S: Final = 150.0
NEAR_M: Final = 0.02
"""Bodies of the same instant differ by less where a guide came late; those of others by far more."""


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
def long_clip(clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Some twenty seconds."""
    folder = copied(clip, tmp_path_factory.mktemp("far") / "walk")
    refilmed(folder, lambda film: [*film, *(3 * [*film[::-1], *film])][:450])
    return folder


@pytest.fixture(scope="module")
def offline(long_clip: Path) -> dict[int, dict[str, Any]]:
    """The bodies that lock-step gives, by their frames."""
    with Decoders() as decoders:
        bodies = track_clip(Settings(clip=str(long_clip)), decoders).bodies
    return {
        body.frame: {"views": body.views, "joints_m": np.array(body.joints_m)} for body in bodies
    }


@pytest.fixture(scope="module")
def rigs(network: Hosts, long_clip: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
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
        (own / "room.toml").write_text(
            f'clip = "{long_clip}"\nroom = "far"\n[bus]\nendpoint = "tls/{hub}:7447"\n'
            'keys = "keys"\nsession = "one"\n[page]\nport = 0\n'
        )
    return folder


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
def room(network: Hosts, rigs: Path, tmp_path: Path) -> Iterator[Callable[[], Room]]:
    """Starts the parts, once; cables are good again afterwards."""
    ear = rigs / "recognizer" / "ear.toml"
    ear.write_text((rigs / "recognizer" / "room.toml").read_text())
    with ExitStack() as doors:
        yield lambda: Room(network, rigs, tmp_path, doors)
    for part in PARTS:
        network.cable(part)


def apart_m(heard: Heard, offline: dict[int, dict[str, Any]]) -> np.ndarray:
    """How far the bodies of both views are from those that lock-step gives of the same frame."""
    both = [body for body in heard.bodies if body["views"] == "both" and body["joints_m"]]
    pairs = [(np.array(body["joints_m"]), offline[body["frame"]]["joints_m"]) for body in both]
    return np.array([np.linalg.norm(a - b, axis=1).mean() for a, b in pairs if len(b)])


@pytest.mark.slow
def test_clocks_three_seconds_apart_do_not_confuse_instants(
    room: Callable[[], Room], offline: dict[int, dict[str, Any]]
) -> None:
    """Each viewer estimates how far the room's clock is from its own."""
    heard = room().over()
    frames = [body["frame"] for body in heard.bodies]
    assert frames == sorted(set(frames))
    assert len(frames) >= len(offline) - 3
    same = [body["views"] == offline[body["frame"]]["views"] for body in heard.bodies]
    assert np.mean(same) > 0.8
    assert np.quantile(apart_m(heard, offline), 0.95) < NEAR_M
    assert heard.newest("integrator")["latency_p50_ms"] < 500
    assert heard.postures


def show(heard, offline):
    from collections import Counter

    frames = [b["frame"] for b in heard.bodies]
    print(
        len(frames),
        len(offline),
        Counter(b["views"] for b in heard.bodies),
        "sorted",
        frames == sorted(set(frames)),
    )
    a = apart_m(heard, offline)
    print("apart", len(a), np.quantile(a, [0.5, 0.95, 1.0]) if len(a) else None)
    for p in ("integrator", "viewer 1", "viewer 2", "recognizer"):
        try:
            print(heard.newest(p))
        except IndexError:
            print(p, "none")
    for k, v in heard.logs.items():
        print("==", k)
        print(v[-1500:])
    print({d for p in heard.pulses for d in p["detail"].splitlines()})


@pytest.mark.slow
@pytest.mark.parametrize("cable", [Cable(0.2), Cable(loss=0.05)], ids=["200 ms", "5 %"])
@pytest.mark.parametrize("whose", [("viewer2",), ("viewer1", "viewer2")], ids=["one", "both"])
def test_explore(room, network, offline, cable, whose):
    for part in whose:
        network.cable(part, cable)
    r = room()
    try:
        heard = r.over()
    finally:
        show(r.heard(), offline)
    assert 0


@pytest.mark.slow
@pytest.mark.parametrize("whose", ["viewer1", "integrator"])
def test_cut(room, network, offline, whose):
    r = room()
    try:
        r.until(lambda h: h.bodies and h.bodies[-1]["frame"] > 60)
        network.cable(whose, Cable(cut=True))
        time.sleep(6)
        network.cable(whose)
        heard = r.over()
    finally:
        show(r.heard(), offline)
    assert 0
