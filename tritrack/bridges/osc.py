"""A body as Open Sound Control: joints and angles by name, one bundle a body."""

import socket
from collections.abc import Callable
from typing import Any

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, JOINT_NAMES
from common.bus.messages import Body


class BridgeError(RuntimeError):
    """A bridge that cannot be built; the text names the cure."""


def osc_packet(body: Body) -> bytes:
    """A bundle of a body's numbers; joints and angles only where it has a pose."""
    from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder

    bundle: Any = OscBundleBuilder(IMMEDIATELY)
    told = [body.frame, body.captured_s, body.clock_s, body.status]
    bundle.add_content(message("/tritrack/frame", told, "idds"))
    for name, place_m, sure in zip(JOINT_NAMES, body.joints_m, body.confidence, strict=False):
        bundle.add_content(message(f"/tritrack/joint/{name}", [*place_m, sure], "ffff"))
    for name, i in zip(ANGLE_NAMES, ANGLES_IN_POSE, strict=True) if body.pose else ():
        bundle.add_content(message(f"/tritrack/angle/{name}", [body.pose[i]], "f"))
    packet: bytes = bundle.build().dgram
    return packet


def message(address: str, values: list[Any], types: str) -> Any:
    """One OSC message; `types` as OSC writes them, a letter a value."""
    from pythonosc.osc_message_builder import OscMessageBuilder

    builder = OscMessageBuilder(address)
    for value, kind in zip(values, types, strict=True):
        builder.add_arg(value, kind)
    return builder.build()


def osc_sender(to: str) -> Callable[[bytes], None]:
    """What sends packets to `HOST:PORT` by UDP; nobody need listen there.

    Raises:
        BridgeError: When that is no address, or python-osc is not installed.
    """
    try:
        import pythonosc  # noqa: F401
    except ImportError as error:
        raise BridgeError("OSC and VMC need python-osc: pip install 'tritrack[osc]'") from error
    host, _, port = to.rpartition(":")
    try:
        if not 0 < int(port) < 1 << 16:
            raise ValueError(port)
        family, kind, *_, address = socket.getaddrinfo(host, int(port), type=socket.SOCK_DGRAM)[0]
    except (OSError, ValueError) as error:
        raise BridgeError(f"--to {to} is no address: write it like 127.0.0.1:9000") from error
    door = socket.socket(family, kind)

    def send(packet: bytes) -> None:
        door.sendto(packet, address)

    return send
