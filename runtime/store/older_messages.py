"""Messages and heads of files that 0.2 wrote, in the form of this version."""

from typing import Any, Final, TypeVar

import msgspec

from common.bus.message_codec import MalformedMessage, decode
from common.bus.messages import PROTOCOL, Body, Message
from common.config.renamed_settings import in_new_words

OLDER: Final = 11
"""The protocol of 0.2."""
SEEN_BY: Final = {"both": (True, True), "1": (True, False), "2": (False, True)}
"""What 0.2 told of two cameras in one word."""

Kind = TypeVar("Kind", bound=Message)
Head = TypeVar("Head")


def read_message(payload: bytes, kind: type[Kind]) -> Kind:
    """A message of a file, of this version or of 0.2.

    Raises:
        MalformedMessage: When it is neither.
    """
    try:
        return decode(payload, kind)
    except MalformedMessage:
        older = _in_this_form(payload, kind)
        if older is None:
            raise
        return decode(older, kind)


def read_head(told: Any, kind: type[Head]) -> Head:
    """What a file begins with, from plain values, with the settings in the words of now.

    Raises:
        ValidationError: When it is none.
        SettingsError: When its settings name one camera twice.
    """
    if isinstance(told, dict):
        told = {**told, "settings": in_new_words(told.get("settings"))}
    return msgspec.convert(told, kind)


def seen_by(views: str) -> tuple[bool, bool]:
    """Which of two cameras show the person, by the word of 0.2."""
    return SEEN_BY.get(views, (False, False))


def _in_this_form(payload: bytes, kind: type[Message]) -> bytes | None:
    """The bytes of a message of 0.2 as this version writes them; None: it is of another."""
    try:
        told = msgspec.msgpack.decode(payload)
    except msgspec.DecodeError:
        return None
    if not isinstance(told, dict) or told.get("protocol") != OLDER:
        return None
    told["protocol"] = PROTOCOL
    if kind is Body:
        told["seen"] = seen_by(str(told.get("views")))
    return msgspec.msgpack.encode(told)
