"""OSC, read back by hand: every joint and angle by name, and errors that name the cure."""

import errno
import os
import socket
import sys

import msgspec
import pytest
from meeting import a_body
from moving import random_joints
from osc_reader import read_osc

from common.body.body import ANGLE_NAMES, JOINT_NAMES
from common.bus.messages import Body, Performance, Posture
from runtime.bridges.osc import BridgeError, osc_packet, osc_sender, posture_packet

pytest.importorskip("pythonosc", reason="pip install 'tritrack[osc]'")


def test_a_packet_has_every_joint_and_angle_by_name() -> None:
    body = a_body(7, random_joints(3)[0])
    told = read_osc(osc_packet(body))
    by_name = dict(told)
    assert len(told) == len(by_name) == 1 + len(JOINT_NAMES) + len(ANGLE_NAMES)
    assert by_name["/tritrack/frame"] == [7, body.captured_s, body.clock_s, "tracking"]
    assert by_name["/tritrack/joint/l_wrist"] == pytest.approx([*body.joints_m[5], 0.5], abs=1e-6)
    assert by_name["/tritrack/angle/l_shoulder_z"] == pytest.approx([180.0])


def test_each_of_several_people_has_addresses_of_their_own() -> None:
    alone = a_body(7, random_joints(3)[0])
    second = msgspec.structs.replace(alone, person=2)
    expected = [
        (f"/tritrack/person/2/{address.removeprefix('/tritrack/')}", values)
        for address, values in read_osc(osc_packet(alone))
    ]
    assert read_osc(osc_packet(second)) == expected
    assert expected[1][0] == "/tritrack/person/2/joint/pelvis"


def test_nobody_is_told_by_the_frame_alone() -> None:
    body = Body(frame=3, captured_s=0.2, clock_s=0.2, status="empty", views="none")
    assert read_osc(osc_packet(body)) == [("/tritrack/frame", [3, 0.2, 0.2, "empty"])]


def test_a_posture_says_what_is_being_done_and_a_performance_that_it_has_ended() -> None:
    ended = Performance(
        "kick_left_forward", 30, 59, onset_s=2.0, end_s=4.0, posterior=0.75, times=3
    )
    posture = Posture(
        frame=60, captured_s=4.25, clock_s=9.0, name="kick_left_forward", doing="squat", times=1
    )
    now = ("/tritrack/posture", [60, 4.25, "squat", 1, "kick_left_forward"])
    assert read_osc(posture_packet(posture)) == [now]
    after = msgspec.structs.replace(posture, event=ended, person=2)
    event = ("/tritrack/person/2/event", ["kick_left_forward", 2.0, 4.0, 3, 0.75])
    assert read_osc(posture_packet(after)) == [("/tritrack/person/2/posture", now[1]), event]


@pytest.mark.parametrize("to", ["", "127.0.0.1", "127.0.0.1:many", "127.0.0.1:70000"])
def test_what_is_no_address_is_named(to: str) -> None:
    with pytest.raises(BridgeError, match="is no address: write it like"):
        osc_sender(to)


def test_a_broadcast_and_an_address_in_brackets_are_sent_to() -> None:
    """How several computers of a stage hear one sender."""
    osc_sender("255.255.255.255:9000")(b"to all")
    with socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) as ear:
        ear.bind(("::1", 0))
        ear.settimeout(10.0)
        osc_sender(f"[::1]:{ear.getsockname()[1]}")(b"to one")
        assert ear.recv(16) == b"to one"


def test_a_network_that_goes_away_is_said_once_and_ends_nothing(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    sent: list[bytes] = []
    gone = True

    class Door(socket.socket):
        def sendto(self, packet: bytes, *_: object) -> int:  # type: ignore[override]
            if gone:
                raise OSError(errno.ENETUNREACH, os.strerror(errno.ENETUNREACH))
            sent.append(packet)
            return len(packet)

    monkeypatch.setattr(socket, "socket", Door)
    send = osc_sender("127.0.0.1:9000")
    send(b"lost")
    send(b"lost too")
    assert [record.getMessage() for record in caplog.records] == [
        "nothing reaches 127.0.0.1:9000 (Network is unreachable): look at the network"
    ]
    gone = False
    send(b"again")
    assert sent == [b"again"]


def test_without_the_library_the_cure_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pythonosc", None)
    with pytest.raises(BridgeError, match=r"pip install 'tritrack\[osc\]'"):
        osc_sender("127.0.0.1:9000")
