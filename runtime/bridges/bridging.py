"""A running bridge: bodies of a run in, another protocol out, until the run is over."""

from collections.abc import Callable
from pathlib import Path
from typing import Literal

from rich.console import Console

from common.bus.bus_keys import refuse_missing
from common.bus.messages import Body
from runtime.bridges import vmc
from runtime.bridges.first_person import of_first
from runtime.bridges.lsl import lsl_outlet
from runtime.bridges.osc import osc_packet, osc_sender
from runtime.client import WAIT_S, Subscription, subscribe
from runtime.terminal import say

Protocol = Literal["osc", "vmc", "lsl"]


def bridge(
    protocol: Protocol, endpoint: str, room: str, to: str, console: Console, keys: str = ""
) -> int:
    """Forward every body, by VMC and LSL the first person's alone; returns their number.

    Args:
        protocol: Name of the protocol.
        endpoint: The run's endpoint.
        room: The run's site.
        to: `HOST:PORT` to which OSC and VMC are sent.
        console: Shows what the bridge waits for.
        keys: Folder of a client's keys, where the run has keys.

    Raises:
        BridgeError: When the protocol's library is missing, or `to` is no address.
        KeysError: When a key is missing.
        BusError: When no run answers within a minute.
    """
    if keys:
        refuse_missing(Path(keys), "client")
    bodies = subscribe(endpoint, room, keys=keys)
    waits = f"waiting for a run at {endpoint} (room {room}), at most {WAIT_S:.0f} s"
    if protocol == "lsl":
        push, sent = lsl_outlet(), 0
        say(console, waits)
        for body in of_first(bodies):
            push(body)
            sent += 1
        return sent
    send = osc_sender(to)
    say(console, waits)
    return _by_osc(protocol, bodies, send)


def _by_osc(protocol: Protocol, bodies: Subscription[Body], send: Callable[[bytes], None]) -> int:
    state, sent = vmc.Measured(), 0
    for body in of_first(bodies) if protocol == "vmc" else bodies:
        packet: bytes | None = None
        if protocol == "vmc":
            state, packet = vmc.step(state, body)
        else:
            packet = osc_packet(body)
        if packet is not None:
            send(packet)
            sent += 1
    return sent
