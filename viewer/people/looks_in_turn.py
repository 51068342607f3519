"""People who are looked at in turn: between two looks their landmarks are carried on."""

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

import msgspec
import numpy as np

from common.body.body import Floats
from common.body.observation import Landmarks, Pixel
from viewer.landmarks.own_landmarks import COUNTS, SURE
from viewer.landmarks.person_mask import LandmarkResult

CARRIED_S: Final = 0.25
"""Time after a look for which landmarks are carried on, seconds: three frames at 15 Hz."""
KEPT: Final = 0.7
"""Share of its confidence that a joint keeps when it is carried on."""


class LastLook(NamedTuple):
    """The last look at a person."""

    number: int
    """Of the person's track."""
    result: LandmarkResult
    at_s: float
    """Capture time."""
    velocity_px_s: tuple[Pixel, ...]
    """Of each joint, since the look before; 0 after the first."""


def step(
    before: Sequence[LastLook], shown: Mapping[int, LandmarkResult], at_s: float
) -> tuple[LastLook, ...]:
    """The last looks after a frame.

    Args:
        before: After the frame before.
        shown: What is seen of each person, by number, looked at now or carried on.
        at_s: Capture time.
    """
    known = {each.number: each for each in before}
    after = []
    for number, result in shown.items():
        last = known.get(number)
        if not result.carried and result.landmarks is not None:
            after.append(LastLook(number, result, at_s, _velocity(last, result.landmarks, at_s)))
        elif last is not None:
            after.append(last)
    return tuple(after)


def carried(
    looks: Sequence[LastLook], due: int | None, at_s: float, *, rests: bool = False
) -> dict[int, LandmarkResult]:
    """The people who are not looked at now, by number: those who were surely seen a moment ago, but
    for the one whose turn it is.

    Args:
        looks: After the frame before.
        due: The number of the person whose turn it is; None: all are looked at.
        at_s: Capture time.
        rests: There is no time for anyone: that one is not looked at either.
    """
    if not rests and due not in {each.number for each in looks}:
        return {}
    return {
        each.number: _moved(each, at_s - each.at_s)
        for each in looks
        if (rests or each.number != due)
        and each.result.surety >= SURE
        and at_s - each.at_s <= CARRIED_S
    }


def _velocity(last: LastLook | None, now: Landmarks, at_s: float) -> tuple[Pixel, ...]:
    """Velocities of the joints, pixels a second; of those not sure in both looks the median of the
    others."""
    still = ((0.0, 0.0),) * len(now.joints_px)
    if last is None or last.result.landmarks is None or not 0.0 < at_s - last.at_s <= CARRIED_S:
        return still
    before = last.result.landmarks
    sure = np.minimum(before.confidence, now.confidence) > COUNTS
    if not sure.any():
        return still
    velocity = np.subtract(now.joints_px, before.joints_px) / (at_s - last.at_s)
    velocity[~sure] = np.median(velocity[sure], axis=0)
    return tuple((x, y) for x, y in velocity.tolist())


def _moved(last: LastLook, ahead_s: float) -> LandmarkResult:
    """A look, at a later time."""
    shown, mask = last.result.landmarks, last.result.person
    assert shown is not None
    off_px = np.multiply(last.velocity_px_s, ahead_s)
    landmarks = msgspec.structs.replace(
        shown,
        joints_px=_shifted(shown.joints_px, off_px),
        confidence=tuple(KEPT * each for each in shown.confidence),
        facing_confidence=KEPT * shown.facing_confidence,
        second_px=_shifted(shown.second_px, off_px) if shown.second_px else (),
        second_confidence=tuple(KEPT * each for each in shown.second_confidence),
    )
    if mask is not None:
        right, down = (round(each) for each in np.median(off_px, axis=0).tolist())
        window = mask.window
        window = window._replace(left=window.left + right, top=window.top + down)
        mask = mask._replace(window=window)
    return LandmarkResult(landmarks, mask, carried=True)


def _shifted(places_px: Sequence[Pixel], off_px: Floats) -> tuple[Pixel, ...]:
    return tuple((x, y) for x, y in np.add(places_px, off_px).tolist())
