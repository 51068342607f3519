"""Bridges as processes: every body arrives at a receiver of another make, and soon."""

import io
import json
import socket
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
from meeting import EARLY, a_body, saying
from moving import random_joints
from osc_reader import read_osc
from rich.console import Console

from common.bus.bus import BusError
from common.bus.bus_keys import KeysError
from common.bus.messages import Body, Message, Posture
from runtime.bridges import bridging, senders
from runtime.client import WAIT_S
from tritrack import subscribe

pytest.importorskip("pythonosc", reason="pip install 'tritrack[osc]'")

ROOT = Path(__file__).parents[1]
MOST_ADDED_S = 0.005
SAID = 60
"""Bodies, two seconds of them."""


@pytest.mark.slow
@pytest.mark.live
@pytest.mark.parametrize("protocol", ["osc", "vmc"])
def test_every_body_arrives_with_little_added(protocol: str) -> None:
    """Held against a subscriber in this process, which hears the same bodies, once both do."""
    address = {"osc": "/tritrack/frame", "vmc": "/VMC/Ext/T"}[protocol]
    arrived: dict[int, float] = {}
    heard: dict[int, float] = {}
    begin, sent = threading.Event(), 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear, saying(SAID, begin) as endpoint:
        ear.bind(("127.0.0.1", 0))
        ear.settimeout(60.0)
        to = f"127.0.0.1:{ear.getsockname()[1]}"
        command = [sys.executable, "-m", "tritrack", "bridge", protocol, "--to", to]
        bridge = subprocess.Popen(
            [*command, "--endpoint", endpoint, "--json"],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            text=True,
        )

        def listen() -> None:
            for body in subscribe(endpoint, wait_s=60.0):
                heard[body.frame] = time.monotonic()

        plain = threading.Thread(target=listen)
        plain.start()
        while SAID - 1 not in arrived:
            told = dict(read_osc(ear.recv(65536)))[address]
            frame = told[0] if protocol == "osc" else round(30 * told[0])
            arrived[frame] = time.monotonic()
            sent += 1
            if EARLY in heard:
                begin.set()
        plain.join()
        said, _ = bridge.communicate(timeout=60)
    assert sorted(arrived) == sorted(heard) == [EARLY, *range(SAID)]
    assert json.loads(said) == {"bodies": sent}
    added_s = statistics.median(arrived[frame] - heard[frame] for frame in range(SAID))
    print(f"{protocol}: {1e3 * added_s:.2f} ms added")
    assert added_s < MOST_ADDED_S


def test_who_waits_for_a_run_is_told_so_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    heard = Console(file=io.StringIO(), width=500)

    def subscribed(*_: object, **__: object) -> Iterator[Body]:
        assert isinstance(heard.file, io.StringIO)
        yield from ()
        assert heard.file.getvalue() == (
            "waiting for a run at tcp/127.0.0.1:7447 (room attic), at most 60 s\n"
        )

    monkeypatch.setattr(bridging, "subscribe", subscribed)
    endpoint = "tcp/127.0.0.1:7447"
    assert bridging.bridge("osc", endpoint, "attic", "127.0.0.1:9000", heard) == 0


def test_keys_that_are_missing_are_told_before_a_run_is_waited_for(tmp_path: Path) -> None:
    heard = io.StringIO()
    with pytest.raises(KeysError, match=r"cannot read .*nope/ca\.pem"):
        bridging.bridge(
            *("osc", "tls/127.0.0.1:7447", "attic", "127.0.0.1:9000"),
            Console(file=heard),
            str(tmp_path / "nope"),
        )
    assert heard.getvalue() == ""


@pytest.mark.parametrize(
    ("protocol", "sent", "address"),
    [("osc", 3, "/tritrack/frame"), ("vmc", 2, "/VMC/Ext/OK"), ("lsl", 3, "")],
)
def test_each_body_is_handed_on_in_the_protocol_that_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
    protocol: senders.Kind,
    sent: int,
    address: str,
) -> None:
    """Of three bodies the second has no pose, which VMC has no word for."""
    first, last = (a_body(frame, row) for frame, row in enumerate(random_joints(2)[:2]))
    empty = Body(frame=1, captured_s=0.1, clock_s=0.1, status="empty", views="none")
    packets: list[Any] = []
    asked: list[Any] = []
    heard = Console(file=io.StringIO(), width=500)

    def subscribed(*given: object, **named: object) -> Iterator[Message]:
        asked.append((given, named))
        return iter(() if "kind" in named else (first, empty, last))

    def sender(to: str) -> Callable[[bytes], None]:
        asked.append(to)
        return packets.append

    monkeypatch.setattr(bridging, "subscribe", subscribed)
    monkeypatch.setattr(senders, "osc_sender", sender)
    monkeypatch.setattr(senders, "lsl_outlet", lambda: packets.append)
    monkeypatch.setattr(senders, "marker_outlet", lambda: None)
    found = bridging.bridge(protocol, "tcp/10.0.0.1:7447", "attic", "127.0.0.1:9000", heard)
    assert (found, len(packets)) == (sent, sent)
    there, waits = ("tcp/10.0.0.1:7447", "attic"), {"wait_s": WAIT_S, "keys": ""}
    assert asked[:2] == [(there, waits), (there, {"kind": Posture, **waits})]
    assert isinstance(heard.file, io.StringIO)
    assert heard.file.getvalue() == (
        f"waiting for a run at tcp/10.0.0.1:7447 (room attic), at most {WAIT_S:.0f} s\n"
    )
    if protocol == "lsl":
        assert packets == [first, empty, last]
    else:
        assert asked[2:] == ["127.0.0.1:9000"]
        assert all(dict(read_osc(packet)).keys() >= {address} for packet in packets)


@pytest.mark.parametrize(("protocol", "sent"), [("osc", 4), ("vmc", 2), ("lsl", 2)])
def test_of_several_people_osc_has_all_and_the_others_the_first(
    monkeypatch: pytest.MonkeyPatch, protocol: senders.Kind, sent: int
) -> None:
    bodies = [
        msgspec.structs.replace(a_body(frame, row), person=person)
        for frame, row in enumerate(random_joints(2)[:2])
        for person in (1, 2)
    ]
    packets: list[Any] = []
    monkeypatch.setattr(
        bridging, "subscribe", lambda *_, kind=Body, **__: iter(bodies if kind is Body else ())
    )
    monkeypatch.setattr(senders, "osc_sender", lambda _: packets.append)
    monkeypatch.setattr(senders, "lsl_outlet", lambda: packets.append)
    monkeypatch.setattr(senders, "marker_outlet", lambda: None)
    heard = Console(file=io.StringIO())
    found = bridging.bridge(protocol, "tcp/10.0.0.1:7447", "attic", "127.0.0.1:9000", heard)
    assert (found, len(packets)) == (sent, sent)
    if protocol == "lsl":
        assert [body.person for body in packets] == [1, 1]


class Postures:
    """A subscription to postures that come once the bodies did."""

    def __init__(self, postures: list[Posture], after: threading.Event) -> None:
        self._postures, self._after = postures, after

    def __iter__(self) -> Iterator[Posture]:
        assert self._after.wait(10.0)
        yield from self._postures


@pytest.mark.parametrize(
    ("protocol", "address", "people"),
    [("osc", "/tritrack/posture", 2), ("vmc", "/VMC/Ext/Blend/Apply", 1)],
)
def test_postures_are_forwarded_beside_the_bodies_and_the_first_persons_alone_by_vmc(
    monkeypatch: pytest.MonkeyPatch, protocol: senders.Kind, address: str, people: int
) -> None:
    """Persons 2 and 3 are there, 2 first: VMC has its posture alone."""
    row = random_joints(1)[0]
    packets: list[bytes] = []
    after = threading.Event()
    postures = [
        Posture(frame=4, captured_s=0.2, clock_s=9.0, person=person, name="walk", doing="walk")
        for person in (3, 2)
    ]

    def bodies() -> Iterator[Body]:
        for person in (2, 3):
            yield msgspec.structs.replace(a_body(4, row), person=person)
        after.set()

    def subscribed(*_: object, kind: type[Message] = Body, **__: object) -> Any:
        return bodies() if kind is Body else Postures(postures, after)

    monkeypatch.setattr(bridging, "subscribe", subscribed)
    monkeypatch.setattr(senders, "osc_sender", lambda _: packets.append)
    bridging.bridge(
        protocol, "tcp/10.0.0.1:7447", "a", "127.0.0.1:9000", Console(file=io.StringIO())
    )
    told = [place for packet in packets for place, _ in read_osc(packet)]
    said = [each.replace("/person/2", "").replace("/person/3", "") for each in told]
    assert said.count(address) == people


def test_no_thread_waits_where_no_run_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that returned from Zenoh while Python ends would abort the process."""
    begun: list[str] = []

    def subscribed(*_: object, kind: type[Message] = Body, **__: object) -> Iterator[Message]:
        begun.append(kind.__name__)
        raise BusError("nobody answers")
        yield

    monkeypatch.setattr(bridging, "subscribe", subscribed)
    monkeypatch.setattr(senders, "osc_sender", lambda _: print)
    with pytest.raises(BusError):
        bridging.bridge("osc", "tcp/127.0.0.1:7447", "a", "127.0.0.1:9000", Console(quiet=True))
    assert begun == ["Body"]
    assert not [one for one in threading.enumerate() if one.name == "postures"]


IMPATIENT = (
    "from functools import partial; from runtime.bridges import bridging; "
    "bridging.bridge = partial(bridging.bridge, wait_s=1.0); "
    "from tritrack.__main__ import main; main()"
)
"""The command, which waits for a second and not for a minute."""


@pytest.mark.slow
def test_a_bridge_that_finds_no_run_ends_with_its_code() -> None:
    asked = [sys.executable, "-c", IMPATIENT, "bridge", "osc", "--endpoint", "tcp/127.0.0.1:1"]
    ended = subprocess.run(asked, capture_output=True, text=True, check=False, timeout=120)
    assert "error: nobody answers at tcp/127.0.0.1:1 after 1 s" in ended.stderr
    assert ended.returncode == 2, ended.stderr
