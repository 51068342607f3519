"""What the summary of a run tells of cameras that were moved in it."""

from collections.abc import Iterable
from typing import Any

from common.bus.messages import Body


def moved_facts(bodies: Iterable[Body]) -> dict[str, Any]:
    """Which cameras were moved and when, and when the person had confirmed their new place.

    `moved_cameras` is missing where none was; `confirmed_s` is None where nobody confirmed it.
    """
    told: list[dict[str, Any]] = []
    for body in bodies:
        waiting = {each["camera"]: each for each in told if each["confirmed_s"] is None}
        for number in body.moved:
            if number not in waiting:
                told.append({"camera": number, "at_s": body.captured_s, "confirmed_s": None})
        for number, each in waiting.items():
            if number not in body.moved:
                each["confirmed_s"] = body.captured_s
    return {"moved_cameras": told} if told else {}
