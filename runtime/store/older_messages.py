"""Messages and file headers of version 0.2, converted to this version."""

from typing import Any, Final, TypeVar

import msgspec

from common.bus.false_messages import MalformedMessage
from common.bus.message_codec import decode
from common.bus.messages import PROTOCOL, Body, Message, View
from common.config.renamed_settings import in_new_words

OLDER: Final = (10, 11)
"""Protocols of 0.2 and its last development versions."""
SEEN_BY: Final = {"both": (True, True), "1": (True, False), "2": (False, True)}
"""0.2's words for the two cameras that show the person."""

OF_THE_PERSON: Final = (
    *("silhouette", "box", "area_px", "cut", "landmarks", "vote", "upper_body_px"),
    *("thresholds_px", "measure", "refusal", "fit"),
)
"""Fields of a Report that belong to an Observation."""
OF_THE_SEARCH: Final = ("root_px", "angles_deg", "squatting", "score", "matches")
"""Those that belong to a Search."""

Kind = TypeVar("Kind", bound=Message)
Head = TypeVar("Head")


def read_message(payload: bytes, kind: type[Kind]) -> Kind:
    """A message from a file of this version or of 0.2.

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
    """The header of a file, from plain values, with settings renamed to this version.

    Raises:
        ValidationError: When it is none.
        SettingsError: When its settings name one camera twice.
    """
    if isinstance(told, dict):
        told = {**told, "settings": in_new_words(told.get("settings"))}
    return msgspec.convert(told, kind)


def seen_by(views: str) -> tuple[bool, bool]:
    """Which of two cameras show the person, from 0.2's word."""
    return SEEN_BY.get(views, (False, False))


def _in_this_form(payload: bytes, kind: type[Message]) -> bytes | None:
    """The bytes of a 0.2 message in this version's form; None: another version's."""
    try:
        told = msgspec.msgpack.decode(payload)
    except msgspec.DecodeError:
        return None
    if not isinstance(told, dict) or told.get("protocol") not in OLDER:
        return None
    told["protocol"] = PROTOCOL
    if kind is Body:
        told = _body_of(told)
    if kind is View:
        told = _view_of(told)
    return msgspec.msgpack.encode(told)


def _body_of(body: dict[str, Any]) -> dict[str, Any]:
    """A Body, which did not hold view by view who shows the person."""
    agreement = body.get("agreement")
    if isinstance(agreement, dict):  # the first of protocol 10 lacked the motions' agreement
        agreement = {"motion_mm": 0.0, **agreement}
    return {**body, "seen": seen_by(str(body.get("views"))), "agreement": agreement}


def _view_of(report: dict[str, Any]) -> dict[str, Any]:
    """A Report, with at most one person, whose fields were its own."""
    view = {name: value for name, value in report.items() if name not in OF_THE_PERSON}
    view = {name: value for name, value in view.items() if name not in OF_THE_SEARCH}
    return {**view, "people": [_person_of(report)] if report.get("box") else []}


def _person_of(report: dict[str, Any]) -> dict[str, Any]:
    """Its person; the search's results are a struct of their own now, and `fit` is `stick`."""
    own = {*OF_THE_PERSON, "width", "height"} & report.keys()
    person = {name: report[name] for name in own} | {"stick": report.get("fit")}
    person.pop("fit", None)
    if report.get("root_px") is not None:
        person["search"] = {name: report.get(name) for name in OF_THE_SEARCH}
    return person
