"""The WebSocket, read back by another client, by the page in a browser and by the Unity script."""

import http.client
import json
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgpack
import msgspec
import pytest
from browser import open_tab, waited
from meeting import a_body
from moving import random_joints
from waiting import until
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

from animator.page.door import PageError
from common.bus.messages import Performance, Posture
from runtime.bridges import websocket
from runtime.bridges.osc import BridgeError
from runtime.bridges.websocket import WAITING, WebSocket
from runtime.live.free_ports import free_port

SCRIPTS = Path(__file__).parents[1] / "docs/scripts"
UNITY = Path(__file__).parent / "data/unity_outside.cs"
SCHEMA = Path(__file__).parents[1] / "docs/messages.schema.json"
POSTURE = Posture(
    frame=7,
    captured_s=0.5,
    clock_s=9.0,
    name="walk_in_place",
    doing="squat",
    event=Performance("walk_in_place", 1, 5, onset_s=0.1, end_s=0.4, posterior=0.9),
)


@pytest.fixture
def bridge() -> Iterator[WebSocket]:
    server = WebSocket(f"127.0.0.1:{free_port()}")
    yield server
    server.close()


def socket_of(bridge: WebSocket) -> str:
    return f"{bridge.address.replace('http', 'ws')}/bodies"


def listening(bridge: WebSocket, count: int = 1) -> None:
    """Wait until so many programs listen."""
    assert until(lambda: len(bridge._waiting) == count)


@pytest.mark.parametrize("subprotocol", [None, "tritrack.json", "tritrack.msgpack"])
def test_a_body_and_a_posture_arrive_as_their_schema_says(
    bridge: WebSocket, subprotocol: Any
) -> None:
    """By the library msgpack and Python's json, not by what wrote them."""
    body = a_body(7, random_joints(3)[0])
    offered = [subprotocol] if subprotocol else None
    with connect(socket_of(bridge), subprotocols=offered) as program:
        listening(bridge)
        bridge.send_body(body)
        bridge.send_posture(POSTURE)
        is_binary = subprotocol == "tritrack.msgpack"
        came = [program.recv(timeout=20) for _ in range(2)]
    assert all(isinstance(each, bytes) == is_binary for each in came)
    first, second = (msgpack.unpackb(each) if is_binary else json.loads(each) for each in came)
    assert first == {"body": json.loads(msgspec.json.encode(body))}
    assert first["body"]["joints_m"][5] == pytest.approx(body.joints_m[5])
    assert second["posture"]["doing"] == "squat"
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads(SCHEMA.read_text())
    for kind, message in (("Body", first["body"]), ("Posture", second["posture"])):
        ref = {"$ref": f"#/$defs/{kind}", "$defs": schema["$defs"]}
        jsonschema.validate(message, ref)


@pytest.mark.parametrize(
    ("origin", "may"),
    [
        (None, True),
        ("http://127.0.0.1:5173", True),
        ("http://localhost:3000", True),
        ("http://example.org", False),
        ("http://127.0.0.1.example.org", False),
        ("null", False),
    ],
)
def test_pages_of_this_machine_may_listen_and_no_others(
    bridge: WebSocket, origin: Any, may: bool
) -> None:
    if may:
        with connect(socket_of(bridge), origin=origin) as program:
            assert program.close_code is None
        return
    with pytest.raises(InvalidStatus) as refused:
        connect(socket_of(bridge), origin=origin)
    assert refused.value.response.status_code == 403


def test_a_foreign_name_that_points_here_is_refused(bridge: WebSocket) -> None:
    """DNS rebinding: the browser sends that name as Host."""
    port = int(bridge.address.rpartition(":")[2])
    with socket.create_connection(("127.0.0.1", port)) as door:
        door.sendall(b"GET / HTTP/1.1\r\nHost: example.org\r\n\r\n")
        assert door.recv(64).startswith(b"HTTP/1.1 403")


def test_where_other_machines_can_connect_a_token_is_due() -> None:
    bridge = WebSocket(f"0.0.0.0:{free_port()}")
    try:
        at = bridge.address.partition("?")[2]
        port = bridge._port
        assert at.startswith("token=")
        with pytest.raises(InvalidStatus):
            connect(f"ws://127.0.0.1:{port}/bodies")
        with connect(f"ws://127.0.0.1:{port}/bodies?{at}") as program:
            assert program.close_code is None
        page = http.client.HTTPConnection("127.0.0.1", port)
        page.request("GET", f"/?{at}")
        kept = page.getresponse()
        cookie = {"Cookie": str(kept.headers["Set-Cookie"]).partition(";")[0]}
        page = http.client.HTTPConnection("127.0.0.1", port)
        page.request("GET", "/bodies.js", headers=cookie)
        assert (kept.status, page.getresponse().status) == (303, 200)
    finally:
        bridge.close()


def test_a_slow_program_loses_the_oldest_and_holds_up_none(bridge: WebSocket) -> None:
    body = a_body(0, random_joints(3)[0])
    at, soon = socket_of(bridge), 0.1
    with connect(at, close_timeout=soon) as slow, connect(at, close_timeout=soon) as quick:
        listening(bridge, 2)
        for frame in range(20 * WAITING):
            bridge.send_body(msgspec.structs.replace(body, frame=frame))
            if frame % 64 == 0:
                assert json.loads(quick.recv(timeout=20))["body"]["frame"] <= frame
        assert all(len(each._waiting) <= WAITING for each in bridge._waiting)
        assert json.loads(slow.recv(timeout=20))["body"]["frame"] == 0


def test_a_program_that_leaves_is_forgotten(bridge: WebSocket) -> None:
    with connect(socket_of(bridge)):
        listening(bridge)
    assert until(lambda: not bridge._waiting)
    assert bridge.send_body(a_body(0, random_joints(3)[0]))


@pytest.mark.parametrize("to", ["", "8765", "127.0.0.1:many", "127.0.0.1:70000"])
def test_what_is_no_address_is_named(to: str) -> None:
    with pytest.raises(BridgeError, match="is no address: write it like"):
        WebSocket(to)


def test_a_taken_port_is_named_with_the_option(bridge: WebSocket) -> None:
    at = bridge.address.removeprefix("http://")
    with pytest.raises(
        PageError, match=r"in use; close what uses it, or take another port by --to"
    ):
        WebSocket(at)


@pytest.mark.slow
def test_the_page_shows_the_body_and_its_posture_in_a_browser(
    bridge: WebSocket,
) -> None:
    """A green figure on white, the person's line beside; nothing but this bridge is asked."""
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("Debian's chromium is not installed")
    body = a_body(7, random_joints(3)[0])
    with open_tab(chromium, ()) as tab:
        tab.call("Page.navigate", url=bridge.address)

        def is_drawn(picture: Any, text: str) -> bool:
            bridge.send_body(body)
            bridge.send_posture(POSTURE)
            green = (abs(picture.astype(int) - (47, 125, 109)).max(axis=2) < 8).sum()
            return bool("squat" in text and "tracking" in text and green > 500)

        picture = waited(tab, is_drawn)
        assert is_drawn(picture, tab.text()), tab.text()
        port = bridge.address.rpartition(":")[2]
        assert all(f"127.0.0.1:{port}/" in asked for asked in tab.asked if asked != "about:blank")


@pytest.mark.slow
def test_the_unity_script_reads_bodies_and_postures(bridge: WebSocket, tmp_path: Path) -> None:
    """Compiled and run by Mono: every ball where its joint is, with Unity's sign of x."""
    if shutil.which("mcs") is None or shutil.which("mono") is None:
        pytest.skip("Debian's mono-mcs is not installed")
    program = tmp_path / "program.exe"
    sources = [SCRIPTS / "TritrackBodies.cs", UNITY]
    subprocess.run(["mcs", f"-out:{program}", *sources], check=True, timeout=120)
    body = a_body(300, random_joints(3)[0])
    command = ["mono", str(program), socket_of(bridge)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as unity:
        listening(bridge)
        bridge.send_body(body)
        bridge.send_posture(POSTURE)
        said, _ = unity.communicate(timeout=60)
    *places, doing = said.splitlines()
    expected = [[-x, y, z] for x, y, z in body.joints_m]
    assert [[float(each) for each in line.split()] for line in places] == [
        pytest.approx(place, abs=1e-5) for place in expected
    ]
    assert doing == "squat"


@pytest.mark.parametrize("host", ["[::1]", "127.0.0.2"])
def test_every_address_of_this_machine_alone_answers(host: str) -> None:
    try:
        bridge = WebSocket(f"{host}:{free_port()}")
    except PageError:
        pytest.skip("this machine has no such address")
    try:
        with connect(socket_of(bridge), origin=Origin(f"http://{host}:3000")) as program:
            assert program.close_code is None
    finally:
        bridge.close()


def test_a_program_that_takes_nothing_more_does_not_hold_up_the_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As one that is stopped in a debugger: its connection stays, and its buffers are full."""
    monkeypatch.setattr(websocket, "ENDS_S", 0.1, raising=False)
    bridge = WebSocket(f"127.0.0.1:{free_port()}")
    stopped = connect(socket_of(bridge), max_queue=1)
    listening(bridge)
    body = a_body(0, random_joints(3)[0])

    def is_stuck() -> bool:
        for _ in range(WAITING):
            bridge.send_body(body)
        time.sleep(0.05)
        return all(len(each._waiting) == WAITING for each in bridge._waiting)

    assert until(is_stuck)
    bridge.close()
    assert until(lambda: not bridge._waiting)
    stopped.socket.close()
