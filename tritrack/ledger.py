"""The effort ledger: how many inputs a video took, would gain from, and took the thesis (T24)."""

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from animator.inbetween import key_frames
from common.body import JOINT_NAMES, LIMB_ENDS, LIMBS
from common.notes import Notes

JOINTS_BY_HAND: Final = 14
"""Places that earlier methods had the user point at in every key frame (4.3)."""
SURE: Final = 0.7
"""A decision with less confidence than this is worth a look."""
SEEN: Final = 0.3
"""A joint with less confidence than this is hidden: the thesis's "highly occluded"."""
FLAT_DEG: Final = 15.0
"""A segment that leans less out of the picture's plane has no direction that anybody would see."""


class Count(msgspec.Struct, frozen=True):
    """Inputs by what they are about."""

    orientation: int = 0
    depth: int = 0
    joints: int = 0

    @property
    def total(self) -> int:
        """All of them."""
        return self.orientation + self.depth + self.joints


class Printed(NamedTuple):
    """What the thesis prints of one of its videos."""

    video: str
    frames: int
    key_frames: int
    by_hand: int
    inputs: Count


PRINTED: Final = (
    Printed("walking", 82, 17, 17 * JOINTS_BY_HAND + 52, Count(1, 52, 7)),
    Printed("dancing", 200, 33, 33 * JOINTS_BY_HAND + 44, Count(7, 44, 8)),
)
"""Demir 2006, 4.3: 290 -> 60 and 506 -> 59 (M23)."""


class Ledger(msgspec.Struct, frozen=True):
    """One video's effort, in the thesis's own terms."""

    frames: int
    key_frames: int
    given: Count
    """What the notes say: every value counts once however long it holds; "auto" gives none."""
    open: Count
    """What could still improve the result: inputs that would settle all that is not sure."""
    thesis: Count
    """What the thesis's way would take of this video: every orientation, direction and hidden
    joint given by hand."""

    @property
    def by_hand(self) -> int:
        """What the ways before the thesis would take: all joints of key frames, and directions."""
        return self.key_frames * JOINTS_BY_HAND + self.thesis.depth


class Doubts(NamedTuple):
    """What a run decided by itself, and how sure it was; n frames."""

    orientation: Sequence[str]
    """(n,) names of ORIENTATIONS; "": none was needed."""
    orientation_confidence: NDArray[np.float64]
    """(n,)"""
    depth: NDArray[np.float64]
    """(n, 10), LIMBS order: 1 toward the camera, -1 away, 0 in the picture's plane or no pose."""
    depth_confidence: NDArray[np.float64]
    """(n, 10)"""
    joint_confidence: NDArray[np.float64]
    """(n, 15), JOINT_NAMES order; NaN where there is no pose."""


def doubts_of(poses: dict[str, Any]) -> Doubts:
    """The doubts that a run wrote down.

    Args:
        poses: The arrays of `poses.npz`. Beside those of every run, one of a single view has
            `orientation` (n,), `orientation_confidence` (n,) and `depth_confidence` (n, 10) in
            the order of LIMBS; a run without them was sure.
    """
    joints_m = poses["joints_m"]
    n = len(joints_m)
    posed = np.isfinite(joints_m).all(axis=(1, 2))
    return Doubts(
        orientation=[str(name) for name in poses.get("orientation", [""] * n)],
        orientation_confidence=np.where(posed, poses.get("orientation_confidence", 1.0), 1.0),
        depth=depth_of(joints_m),
        depth_confidence=np.broadcast_to(poses.get("depth_confidence", 1.0), (n, len(LIMBS))),
        joint_confidence=np.where(posed[:, None], poses["confidence"], np.nan),
    )


def depth_of(joints_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Which way each segment leans, (n, 10): 1, -1, or 0 below FLAT_DEG; +z is to the camera."""
    along = joints_m[:, LIMB_ENDS[:, 1]] - joints_m[:, LIMB_ENDS[:, 0]]
    lean = along[..., 2] / np.maximum(np.linalg.norm(along, axis=2), 1e-9)
    enough = np.abs(lean) >= np.sin(np.radians(FLAT_DEG))
    signs: NDArray[np.float64] = np.where(enough, np.sign(lean), 0.0)
    return signs


def ledger(doubts: Doubts, notes: Notes) -> Ledger:
    """Count what was given, what could be, and what the thesis's way would take."""
    n = len(doubts.orientation)
    clarity = np.nanmean(
        np.where(np.isfinite(doubts.joint_confidence), doubts.joint_confidence, 0), axis=1
    )
    posed = np.isfinite(doubts.joint_confidence).all(axis=1)
    return Ledger(
        frames=n,
        key_frames=len(key_frames(np.where(posed, clarity, np.nan))),
        given=given_inputs(notes),
        open=open_inputs(doubts),
        thesis=_by_the_thesis(doubts),
    )


def given_inputs(notes: Notes) -> Count:
    """The inputs in the notes: values that are not what held before."""
    count = {"orientation": 0, "depth": 0, "joints": 0}
    holds: dict[str, Any] = {}
    for note in notes.note:
        said: list[tuple[str, str, Any]] = [("orientation", "orientation", note.orientation)]
        said += [("depth", name, way) for name, way in note.depth.items()]
        said += [("joints", f"{name} px", place) for name, place in note.joints_px.items()]
        for kind, name, value in said:
            count[kind] += value not in (None, "auto", holds.get(name))
            holds[name] = value or holds.get(name)
    return Count(**count)


def open_inputs(doubts: Doubts) -> Count:
    """The inputs that would settle every doubt, each held as long as it agrees (T21)."""
    unsure = doubts.depth_confidence < SURE
    hidden = doubts.joint_confidence < SEEN
    return Count(
        orientation=inputs(doubts.orientation, doubts.orientation_confidence < SURE),
        depth=sum(inputs(doubts.depth[:, i], unsure[:, i]) for i in range(len(LIMBS))),
        joints=sum(_stretches(hidden[:, i]) for i in range(len(JOINT_NAMES))),
    )


def inputs(values: Sequence[Any] | NDArray[Any], wanted: NDArray[np.bool_]) -> int:
    """How many sticky inputs say `values` in the frames where that is wanted.

    An input holds on while the values agree with it; frames of no value ("" or 0) agree with
    anything; where a frame disagrees that nobody asked about, the input is given up.
    """
    holds: Any = None
    count = 0
    for value, asked in zip(values, wanted, strict=True):
        if value and value != holds:
            count += bool(asked)
            holds = value if asked else None
    return count


def _stretches(hidden: NDArray[np.bool_]) -> int:
    """How often a joint is hidden: one place each time."""
    return int(np.count_nonzero(np.diff(hidden.astype(int), prepend=0) == 1))


def _by_the_thesis(doubts: Doubts) -> Count:
    everywhere = np.ones(len(doubts.orientation), np.bool_)
    return Count(
        orientation=inputs(doubts.orientation, everywhere),
        depth=sum(inputs(doubts.depth[:, i], everywhere) for i in range(len(LIMBS))),
        joints=open_inputs(doubts).joints,
    )
