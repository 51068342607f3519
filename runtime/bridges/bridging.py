"""A running bridge: a run's bodies and postures in, another protocol out, until the run is over."""

import threading
from collections.abc import Iterable
from contextlib import closing, suppress
from pathlib import Path

from rich.console import Console

from common.bus.bus import BusError
from common.bus.bus_keys import refuse_missing
from common.bus.messages import Body, Posture
from runtime.bridges.first_person import of_first
from runtime.bridges.senders import Kind, Sender, sender_of
from runtime.client import WAIT_S, Subscription, subscribe
from runtime.terminal import say

ENDS_S = 2.0
"""Seconds that the last postures of a run may take after its last body."""


def bridge(
    protocol: Kind,
    endpoint: str,
    room: str,
    to: str,
    console: Console,
    keys: str = "",
    wait_s: float = WAIT_S,
) -> int:
    """Forward every body and posture, by VMC and LSL the first person's alone.

    Args:
        protocol: Name of the protocol.
        endpoint: The run's endpoint.
        room: The run's site.
        to: `HOST:PORT` to which OSC and VMC are sent, at which a WebSocket is opened.
        console: Shows what the bridge waits for.
        keys: Folder of a client's keys, where the run has keys.
        wait_s: Longest wait for the run, in seconds.

    Returns:
        The number of bodies sent.

    Raises:
        BridgeError: When the protocol's library is missing, or `to` is no address.
        PageError: When a WebSocket cannot be opened at `to`.
        KeysError: When a key is missing.
        BusError: When no run answers within `wait_s`.
    """
    if keys:
        refuse_missing(Path(keys), "client")
    bodies = subscribe(endpoint, room, wait_s=wait_s, keys=keys)
    postures = subscribe(endpoint, room, kind=Posture, wait_s=wait_s, keys=keys)
    with closing(sender_of(protocol, to)) as sender:
        if sender.address:
            say(console, f"bodies and postures at {sender.address}")
        waits = f"waiting for a run at {endpoint} (room {room}), at most {wait_s:.0f} s"
        say(console, waits)
        return _forward(sender, bodies, postures)


def _forward(sender: Sender, bodies: Iterable[Body], postures: Subscription[Posture]) -> int:
    """Postures go from a thread of their own: they come after the body that they are of.

    It begins with the first body, so that no thread waits for a run as this process ends: Python
    aborts at its end where one returns from Zenoh then.
    """
    person = [0]

    def forward_postures() -> None:
        with suppress(BusError):  # which the bodies' subscription raises too
            for posture in postures:
                if not sender.is_of_one or posture.person == person[0]:
                    sender.send_posture(posture)

    thread = threading.Thread(target=forward_postures, name="postures", daemon=True)
    sent = 0
    for body in of_first(bodies) if sender.is_of_one else bodies:
        if thread.ident is None:
            thread.start()
        person[0] = body.person
        sent += sender.send_body(body)
    if thread.ident is not None:
        thread.join(ENDS_S)
    return sent
