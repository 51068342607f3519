"""Encoding of messages: the table of topics, and MessagePack."""

from typing import Final, NamedTuple, TypeVar

import msgspec

from common.bus.control_messages import Answer, Cameras, Command, Ended, Pulse
from common.bus.false_messages import MalformedMessage, refuse_false_content
from common.bus.messages import Body, Guide, Message, Picture, Posture, View

MAX_BYTES: Final = 1_000_000
"""Upper bound of a message's size, bytes (a silhouette of 1920x1080 takes 259 kB)."""


class Topic(NamedTuple):
    """The key of a message and its expected rate."""

    key: str
    hz: float
    """Messages a second; 0: not regular."""
    newest_only: bool
    """True where only the newest counts; False where every message does."""


TOPICS: Final[dict[type[Message], Topic]] = {
    View: Topic("tritrack/{room}/viewer/{viewer}/report", 15.0, newest_only=False),
    Guide: Topic("tritrack/{room}/body/guide", 15.0, newest_only=True),
    Body: Topic("tritrack/{room}/body/pose", 15.0, newest_only=False),
    Posture: Topic("tritrack/{room}/posture", 15.0, newest_only=False),
    Picture: Topic("tritrack/{room}/viewer/{viewer}/picture", 15.0, newest_only=True),
    Pulse: Topic("tritrack/{room}/pulse/{process}", 1.0, newest_only=False),
    Cameras: Topic("tritrack/{room}/cameras", 0.0, newest_only=False),
    Ended: Topic("tritrack/{room}/viewer/{viewer}/ended", 0.0, newest_only=False),
    Command: Topic("tritrack/{room}/command", 0.0, newest_only=False),
    Answer: Topic("tritrack/{room}/answer", 0.0, newest_only=False),
}

Said = TypeVar("Said", bound=Message)


def key_of(message: Message, room: str) -> str:
    """The key that a message is published on."""
    fields = {
        name: getattr(message, name) for name in ("viewer", "process") if hasattr(message, name)
    }
    return TOPICS[type(message)].key.format(room=room, **fields)


def pattern_of(kind: type[Message], room: str) -> str:
    """The key expression that matches every message of a kind."""
    return TOPICS[kind].key.format(room=room, viewer="*", process="*")


def encode(message: Message) -> bytes:
    """A message as MessagePack."""
    return msgspec.msgpack.encode(message)


def decode(payload: bytes, kind: type[Said]) -> Said:
    """A message from untrusted bytes, checked.

    Raises:
        MalformedMessage: When they are too long, no MessagePack, of another protocol version, of
            the wrong shape, or hold a number that is not finite.
    """
    refuse_size(len(payload))
    try:
        message = msgspec.msgpack.decode(payload, type=kind)
    except (msgspec.DecodeError, RecursionError, ValueError) as error:
        raise MalformedMessage(f"no {kind.__name__}: {error}") from error
    refuse_false_content(message)
    return message


def refuse_size(size_bytes: int) -> None:
    """Refuse a payload that is too large to be parsed.

    Raises:
        MalformedMessage: When it is too large.
    """
    if size_bytes > MAX_BYTES:
        raise MalformedMessage(f"{size_bytes} bytes, at most {MAX_BYTES} are taken")
