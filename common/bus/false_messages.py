"""Refusal of messages that no process would send: lengths, ranges, finite numbers."""

from collections.abc import Iterator
from itertools import chain
from typing import Any, Final

import msgspec

from common.body.body import ANGLE_NAMES, JOINT_NAMES, LIMBS, POSE_NAMES, Bdp, Elliptic, Round
from common.body.extremities import EXTREMITY_NAMES
from common.body.observation import Box, Fit, Landmarks, Measure, Observation, Search
from common.bus.messages import (
    MOST_VIEWS,
    PROTOCOL,
    Agreement,
    Body,
    Guide,
    Lifting,
    Message,
    Performance,
    View,
)
from common.notes.notes import ORIENTATIONS
from common.rig.camera import Camera, Rig
from common.rig.upright import Shift, Upright

MOST: Final = 1e9
"""Upper bound of any number in a message: seconds of thirty years, pixels, frames."""
_CARRIERS: Final = (
    *(Agreement, Observation, Search, Box, Measure, Fit, Landmarks, Lifting, Performance),
    *(Bdp, Elliptic, Round, Rig, Shift, Camera, Upright),
)
"""Structs inside messages whose numbers are checked too."""
_VIEWS: Final = tuple(range(MOST_VIEWS + 1))
_LENGTHS: Final[dict[tuple[type[Message], str], tuple[int, ...]]] = {
    (Guide, "pose"): (0, len(POSE_NAMES)),
    (Body, "pose"): (0, len(POSE_NAMES)),
    (Body, "joints_m"): (0, len(JOINT_NAMES)),
    (Body, "joints_px"): _VIEWS,
    (Body, "angles_raw_deg"): (0, len(ANGLE_NAMES)),
    (Body, "confidence"): (0, len(JOINT_NAMES)),
    (Body, "extremities_m"): (0, len(EXTREMITY_NAMES)),
    (Body, "extremities_px"): _VIEWS,
    (Body, "extremities_confidence"): (0, len(EXTREMITY_NAMES)),
    (Body, "moved"): _VIEWS,
    **{(Body, name): _VIEWS[1:] for name in ("seen", "score", "facing", "made_of")},
    (Guide, "frames"): _VIEWS[1:],
    (Guide, "due"): _VIEWS,
}


class MalformedMessage(ValueError):
    """Bytes that are no valid message; the text says why."""


def refuse_false_content(message: Message) -> None:
    """Refuse what no process of ours would say.

    Raises:
        MalformedMessage: When the protocol is another one, or a field has the wrong length or a
            value that cannot be.
    """
    if message.protocol != PROTOCOL:
        raise MalformedMessage(f"protocol {message.protocol}, this is {PROTOCOL}")
    for name in message.__struct_fields__:
        value = getattr(message, name)
        allowed = _LENGTHS.get((type(message), name))
        if allowed is not None and len(value) not in allowed:
            raise MalformedMessage(f"{name} has {len(value)} entries, not {allowed[-1]}")
        if not _sum_of(value) <= MOST:  # a fast sum; it is NaN or infinite where an entry is
            _refuse_a_large_number(name, value)
    if isinstance(message, View):
        _refuse_a_false_view(message)
    elif isinstance(message, Body):
        _refuse_a_false_body(message)
    elif isinstance(message, Guide):
        _refuse_a_false_guide(message)


def _refuse_a_false_view(view: View) -> None:
    if view.width <= 0 or view.height <= 0:
        raise MalformedMessage(f"a picture of {view.width}x{view.height}")
    if view.upright is not None:
        _refuse_a_false_upright(view.upright, view.width, view.height)
    for seen in view.people:
        if (seen.width, seen.height) != (view.width, view.height):
            raise MalformedMessage(
                f"a silhouette of {seen.width}x{seen.height} in a picture of "
                f"{view.width}x{view.height}"
            )
        _refuse_a_false_observation(seen)


def _refuse_a_false_observation(seen: Observation) -> None:
    _refuse_a_false_box(seen.box, seen.width, seen.height)
    due = seen.height * ((seen.width + 7) // 8)
    if len(seen.silhouette) != due:
        raise MalformedMessage(f"silhouette has {len(seen.silhouette)} bytes, not {due}")
    if seen.measure is not None and min(seen.measure.height_px, seen.measure.depth_px) <= 0.0:
        raise MalformedMessage("a measured body without height or depth")
    unknown = [
        name for name in (seen.search.angles_deg if seen.search else ()) if name not in ANGLE_NAMES
    ]
    if unknown:
        raise MalformedMessage(f"unknown angle {unknown[0]!r}")
    if seen.stick is not None:
        _refuse_a_false_fit(seen.stick)
    if seen.landmarks is not None:
        _refuse_false_landmarks(seen.landmarks)


def _refuse_a_false_upright(upright: Upright, width: int, height: int) -> None:
    known = upright.quarters in range(4) and min(upright.width, upright.height) > 0
    if not known or upright.size != (width, height):
        raise MalformedMessage(f"{upright} of a picture of {width}x{height}")


def _refuse_a_false_box(box: Box, width: int, height: int) -> None:
    if not (0 <= box.left <= box.right < width and 0 <= box.top <= box.bottom < height):
        raise MalformedMessage(f"{box} in a picture of {width}x{height}")


def _refuse_false_landmarks(landmarks: Landmarks) -> None:
    for name in ("joints_px", "confidence"):
        length = len(getattr(landmarks, name))
        if length != len(JOINT_NAMES):
            raise MalformedMessage(f"{name} has {length} entries, not {len(JOINT_NAMES)}")
    for kind, names in (("extremities", EXTREMITY_NAMES), ("second", JOINT_NAMES)):
        for name in (f"{kind}_px", f"{kind}_confidence"):
            if len(getattr(landmarks, name)) not in (0, len(names)):
                raise MalformedMessage(f"{name} has no {len(names)} entries")
    if len(landmarks.extremities_px) != len(landmarks.extremities_confidence):
        raise MalformedMessage("extremities without their confidence")
    if len(landmarks.second_px) != len(landmarks.second_confidence):
        raise MalformedMessage("second places without their confidence")
    shares = (
        *(*landmarks.confidence, *landmarks.second_confidence),
        *(*landmarks.extremities_confidence, landmarks.facing_confidence),
    )
    if not all(0.0 <= share <= 1.0 for share in shares):
        raise MalformedMessage("landmarks of confidences beyond 0 to 1")
    if not -180.0 <= landmarks.facing_deg <= 180.0:
        raise MalformedMessage(f"landmarks that face {landmarks.facing_deg} degrees")


def _refuse_a_false_guide(guide: Guide) -> None:
    """Fields by camera must have an entry for every camera, or a viewer would not find its own."""
    for name in ("facing", "scale_px_per_m", "root_px", "rest_row_px", "moves"):
        if len(getattr(guide, name)) != len(guide.frames):
            raise MalformedMessage(f"{name} has no {len(guide.frames)} entries")


def _refuse_a_false_body(body: Body) -> None:
    if body.pose and not body.joints_m:
        raise MalformedMessage("a pose without joints_m")
    if any(len(own) != len(JOINT_NAMES) for own in body.joints_px):
        raise MalformedMessage(f"joints_px has no {len(JOINT_NAMES)} joints in a camera")
    if any(len(own) != len(EXTREMITY_NAMES) for own in body.extremities_px):
        raise MalformedMessage(f"extremities_px has no {len(EXTREMITY_NAMES)} places in a camera")
    if body.lifting is not None:
        _refuse_a_false_lifting(body.lifting)


def _refuse_a_false_lifting(lifting: Lifting) -> None:
    for name, allowed in (
        ("depth_confidence", (len(LIMBS),)),
        ("depth_error_deg", (0, len(LIMBS))),
    ):
        length = len(getattr(lifting, name))
        if length not in allowed:
            raise MalformedMessage(f"{name} has {length} entries, not {allowed[-1]}")
    if lifting.orientation not in ORIENTATIONS:
        raise MalformedMessage(f"unknown orientation {lifting.orientation!r}")
    shares = (lifting.orientation_confidence, *lifting.depth_confidence)
    if not all(0.0 <= share <= 1.0 for share in shares):
        raise MalformedMessage("a lifted body of confidences beyond 0 to 1")


def _refuse_a_false_fit(fit: Fit) -> None:
    for name, due in (("joints_px", JOINT_NAMES), ("ratios", LIMBS), ("hidden", LIMBS)):
        if len(getattr(fit, name)) != len(due):
            raise MalformedMessage(f"{name} has {len(getattr(fit, name))} entries, not {len(due)}")
    shares = (*fit.ratios, fit.breadth, fit.score)
    if not all(0.0 <= share <= 1.0 for share in shares) or fit.stature_px <= 0.0:
        raise MalformedMessage("a stick body of shares beyond 0 to 1, or of no stature")


def _sum_of(value: object) -> float:
    """Sum of the absolute values of all numbers in a value."""
    if isinstance(value, tuple):
        return _sum_of_tuple(value)
    if isinstance(value, (float, int)):
        return abs(value)
    if value is None or isinstance(value, (str, bytes)):
        return 0.0
    if isinstance(value, dict):
        return sum(map(_sum_of, value.values()))
    if isinstance(value, _CARRIERS):
        return sum(map(_sum_of, msgspec.structs.astuple(value)))
    return 0.0


def _sum_of_tuple(values: tuple[Any, ...]) -> float:
    if not values:
        return 0.0
    flat = chain.from_iterable(values) if isinstance(values[0], tuple) else values
    try:
        return float(sum(map(abs, flat)))
    except TypeError:  # some entries are not numbers, or hold more
        return sum(map(_sum_of, values))


def _refuse_a_large_number(name: str, value: object) -> None:
    for number in _numbers(value):
        if not abs(number) <= MOST:
            raise MalformedMessage(f"{name} holds {number}, at most {MOST:g} is taken")


def _numbers(value: object) -> Iterator[float]:
    if isinstance(value, int | float):
        yield value
    elif isinstance(value, tuple):
        for item in value:
            yield from _numbers(item)
    elif isinstance(value, dict):
        for item in value.values():
            yield from _numbers(item)
    elif isinstance(value, _CARRIERS):
        for item in msgspec.structs.astuple(value):
            yield from _numbers(item)
