"""The protocols of the bridges: what each makes of a body and of a posture."""

from collections.abc import Callable
from typing import Literal, Protocol

from common.bus.messages import Body, Posture
from runtime.bridges import vmc
from runtime.bridges.lsl import lsl_outlet, marker_outlet, marker_step
from runtime.bridges.osc import BridgeError, osc_packet, osc_sender, posture_packet

Kind = Literal["osc", "vmc", "lsl", "websocket"]


class Sender(Protocol):
    """An open protocol."""

    is_of_one: bool
    """Whether it knows one person alone."""
    address: str
    """Where programs come for what is sent; "" where it goes to them."""

    def send_body(self, body: Body) -> bool:
        """Send a body; False where the protocol has no word for it."""

    def send_posture(self, posture: Posture) -> None:
        """Send a posture; called from another thread than `send_body`."""

    def close(self) -> None:
        """Free what is held."""


class Osc:
    """Open Sound Control to one address."""

    is_of_one, address = False, ""

    def __init__(self, send: Callable[[bytes], None]) -> None:
        """Packets go by `send`."""
        self._send = send

    def send_body(self, body: Body) -> bool:
        """A bundle a body."""
        self._send(osc_packet(body))
        return True

    def send_posture(self, posture: Posture) -> None:
        """A bundle a posture."""
        self._send(posture_packet(posture))

    def close(self) -> None:
        """Nothing is held."""


class Vmc:
    """Virtual Motion Capture to one address."""

    is_of_one, address = True, ""

    def __init__(self, send: Callable[[bytes], None]) -> None:
        """Packets go by `send`."""
        self._send, self._state = send, vmc.Measured()

    def send_body(self, body: Body) -> bool:
        """The turns of its bones; nothing of a body without a pose."""
        self._state, packet = vmc.step(self._state, body)
        if packet is not None:
            self._send(packet)
        return packet is not None

    def send_posture(self, posture: Posture) -> None:
        """A blend value for each posture."""
        self._send(vmc.posture_packet(posture))

    def close(self) -> None:
        """Nothing is held."""


class Lsl:
    """Two streams of the Lab Streaming Layer."""

    is_of_one, address = True, ""

    def __init__(self) -> None:
        """Open both streams."""
        self._push, self._mark, self._doing = lsl_outlet(), marker_outlet(), ""

    def send_body(self, body: Body) -> bool:
        """A sample a body."""
        self._push(body)
        return True

    def send_posture(self, posture: Posture) -> None:
        """A marker where a posture begins or ends."""
        self._doing, markers = marker_step(self._doing, posture)
        for marker in markers:
            self._mark(marker, posture.clock_s)

    def close(self) -> None:
        """The streams end with the process."""


def sender_of(kind: Kind, to: str) -> Sender:
    """The protocol, open.

    Raises:
        BridgeError: When its library is missing, or `to` is no address.
        PageError: When a WebSocket cannot be opened at `to`.
    """
    if kind == "lsl":
        return Lsl()
    if kind == "websocket":
        return _web_socket(to)
    return Osc(osc_sender(to)) if kind == "osc" else Vmc(osc_sender(to))


def _web_socket(to: str) -> Sender:
    """Imported where it is asked for: its library is an extra."""
    try:
        from runtime.bridges.websocket import WebSocket
    except ImportError as error:
        text = f"a WebSocket needs {error.name}: pip install 'tritrack[page]'"
        raise BridgeError(text) from error
    return WebSocket(to)
