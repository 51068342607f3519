"""Bodies and postures as Open Sound Control: joints and angles by name, a bundle for each."""

import logging
import socket
from collections.abc import Callable
from typing import Any

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, JOINT_NAMES
from common.bus.messages import Body, Posture

log = logging.getLogger(__name__)


class BridgeError(RuntimeError):
    """A bridge that cannot be opened; the text names the cure."""


def osc_packet(body: Body) -> bytes:
    """A bundle of a body's numbers; joints and angles only where it has a pose.

    Of several people each has addresses of their own: /tritrack/person/2/joint/l_wrist.
    """
    from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder

    bundle: Any = OscBundleBuilder(IMMEDIATELY)
    root = _root_of(body.person)
    told = [body.frame, body.captured_s, body.clock_s, body.status]
    bundle.add_content(message(f"{root}/frame", told, "idds"))
    for name, place_m, sure in zip(JOINT_NAMES, body.joints_m, body.confidence, strict=False):
        bundle.add_content(message(f"{root}/joint/{name}", [*place_m, sure], "ffff"))
    for name, i in zip(ANGLE_NAMES, ANGLES_IN_POSE, strict=True) if body.pose else ():
        bundle.add_content(message(f"{root}/angle/{name}", [body.pose[i]], "f"))
    packet: bytes = bundle.build().dgram
    return packet


def posture_packet(posture: Posture) -> bytes:
    """A bundle of a frame's posture and, where a performance has ended, of that event."""
    from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder

    bundle: Any = OscBundleBuilder(IMMEDIATELY)
    root = _root_of(posture.person)
    now = [posture.frame, posture.captured_s, posture.doing, posture.times, posture.name]
    bundle.add_content(message(f"{root}/posture", now, "idsis"))
    if (event := posture.event) is not None:
        ended = [event.name, event.onset_s, event.end_s, event.times, event.posterior]
        bundle.add_content(message(f"{root}/event", ended, "sddif"))
    packet: bytes = bundle.build().dgram
    return packet


def _root_of(person: int) -> str:
    return f"/tritrack/person/{person}" if person > 0 else "/tritrack"


def message(address: str, values: list[Any], types: str) -> Any:
    """One OSC message; `types` in OSC's notation, a letter per value."""
    from pythonosc.osc_message_builder import OscMessageBuilder

    builder = OscMessageBuilder(address)
    for value, kind in zip(values, types, strict=True):
        builder.add_arg(value, kind)
    return builder.build()


def osc_sender(to: str) -> Callable[[bytes], None]:
    """A sender of packets to `HOST:PORT` by UDP; no receiver is required.

    The host may be a network's broadcast address. While the network is down, packets are dropped,
    which is logged once, until it is back.

    Raises:
        BridgeError: When that is no address, or python-osc is not installed.
    """
    try:
        import pythonosc  # noqa: F401
    except ImportError as error:
        raise BridgeError("OSC and VMC need python-osc: pip install 'tritrack[osc]'") from error
    family, kind, address = _address_of(to)
    door, failing = socket.socket(family, kind), False
    door.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)

    def send(packet: bytes) -> None:
        nonlocal failing
        try:
            door.sendto(packet, address)
        except OSError as error:
            if not failing:
                log.warning("nothing reaches %s (%s): look at the network", to, error.strerror)
            failing = True
        else:
            failing = False

    return send


def host_and_port(to: str) -> tuple[str, int]:
    """The two of `HOST:PORT`, a host of IPv6 without its brackets.

    Raises:
        BridgeError: When it is not of that form, or the port is none.
    """
    host, _, port = to.rpartition(":")
    if not (host and port.isdecimal() and 0 < int(port) < 1 << 16):
        raise BridgeError(f"--to {to} is no address: write it like 127.0.0.1:9000")
    return host.strip("[]"), int(port)


def _address_of(to: str) -> tuple[int, int, Any]:
    """Family, kind and address of a socket to it."""
    host, port = host_and_port(to)
    try:
        family, kind, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
    except (OSError, UnicodeError) as error:
        raise BridgeError(f"--to {to} is no address: write it like 127.0.0.1:9000") from error
    return family, kind, address
