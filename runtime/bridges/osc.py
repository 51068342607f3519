"""A body as Open Sound Control: joints and angles by name, one bundle per body."""

import logging
import socket
from collections.abc import Callable
from typing import Any

from common.body.body import ANGLE_NAMES, ANGLES_IN_POSE, JOINT_NAMES
from common.bus.messages import Body

log = logging.getLogger(__name__)


class BridgeError(RuntimeError):
    """A bridge that cannot be opened; the text names the cure."""


def osc_packet(body: Body) -> bytes:
    """A bundle of a body's numbers; joints and angles only where it has a pose.

    Of several people each has addresses of their own: /tritrack/person/2/joint/l_wrist.
    """
    from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder

    bundle: Any = OscBundleBuilder(IMMEDIATELY)
    root = f"/tritrack/person/{body.person}" if body.person > 0 else "/tritrack"
    told = [body.frame, body.captured_s, body.clock_s, body.status]
    bundle.add_content(message(f"{root}/frame", told, "idds"))
    for name, place_m, sure in zip(JOINT_NAMES, body.joints_m, body.confidence, strict=False):
        bundle.add_content(message(f"{root}/joint/{name}", [*place_m, sure], "ffff"))
    for name, i in zip(ANGLE_NAMES, ANGLES_IN_POSE, strict=True) if body.pose else ():
        bundle.add_content(message(f"{root}/angle/{name}", [body.pose[i]], "f"))
    packet: bytes = bundle.build().dgram
    return packet


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
    host, _, port = to.rpartition(":")
    try:
        if not 0 < int(port) < 1 << 16:
            raise ValueError(port)
        found = socket.getaddrinfo(host.strip("[]"), int(port), type=socket.SOCK_DGRAM)
        family, kind, *_, address = found[0]
    except (OSError, ValueError) as error:
        raise BridgeError(f"--to {to} is no address: write it like 127.0.0.1:9000") from error
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
