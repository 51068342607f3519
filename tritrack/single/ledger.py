"""The effort ledger: numbers of inputs that a video took, would gain from, and took in the
thesis (T24)."""

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from animator.inbetween import key_frames
from animator.take import CONFIDENT, Take, depth_of, hidden_of
from common.body.body import LIMBS
from common.notes.notes import Notes
from common.npz_file import Facts

JOINTS_BY_HAND: Final = 14
"""Places that the user had to click in every key frame with earlier methods (4.3)."""


class Count(msgspec.Struct, frozen=True):
    """Numbers of inputs by subject."""

    orientation: int = 0
    depth: int = 0
    joints: int = 0

    @property
    def total(self) -> int:
        """All of them."""
        return self.orientation + self.depth + self.joints


class Printed(NamedTuple):
    """The thesis's numbers for one of its videos."""

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
    """Inputs in the notes: every value counts once however long it holds; "auto" does not count."""
    open: Count
    """Further inputs that could improve the result: those that would settle all unsure
    decisions."""
    thesis: Count
    """Inputs that the thesis's method would need for this video: every orientation, direction
    and hidden joint by hand."""

    @property
    def by_hand(self) -> int:
        """Inputs that the methods before the thesis would need: all joints of key frames, and
        directions."""
        return self.key_frames * JOINTS_BY_HAND + self.thesis.depth


def ledger(take: Take, notes: Notes) -> Ledger:
    """Count the inputs made, those possible, and those of the thesis's method."""
    clarity = np.where(take.posed, take.confidence.mean(axis=1), np.nan)
    return Ledger(
        frames=len(take.frame),
        key_frames=len(key_frames(clarity)),
        given=given_inputs(notes),
        open=open_inputs(take),
        thesis=_by_the_thesis(take),
    )


def given_inputs(notes: Notes) -> Count:
    """The inputs in the notes: values that change what held before."""
    count = {"orientation": 0, "depth": 0, "joints": 0}
    holds: Facts = {}
    for note in notes.note:
        said: list[tuple[str, str, Any]] = [("orientation", "orientation", note.orientation)]
        said += [("depth", name, way) for name, way in note.depth.items()]
        said += [("joints", f"{name} px", place) for name, place in note.joints_px.items()]
        for kind, name, value in said:
            count[kind] += value not in (None, "auto", holds.get(name))
            holds[name] = value or holds.get(name)
    return Count(**count)


def open_inputs(take: Take) -> Count:
    """The inputs that would settle every doubt, each held as long as it agrees (T21)."""
    asked = take.posed & (take.orientation_confidence < CONFIDENT)
    unsure = take.posed[:, None] & (take.depth_confidence < CONFIDENT)
    hidden = take.posed[:, None] & hidden_of(take.confidence)
    depth = depth_of(take.joints_m)
    return Count(
        orientation=inputs(take.orientation, asked),
        depth=sum(inputs(depth[:, i], unsure[:, i]) for i in range(len(LIMBS))),
        joints=sum(stretches(hidden[:, i]) for i in range(len(LIMBS))),
    )


def inputs(
    values: Sequence[str | float] | NDArray[np.str_ | np.float64], wanted: NDArray[np.bool_]
) -> int:
    """Number of persistent inputs that would set `values` in the frames where that is wanted.

    An input holds while the values agree with it; frames without a value ("" or 0) agree with
    anything; at a frame that disagrees and is not wanted, the input ends.
    """
    holds: str | float | None = None
    count = 0
    for value, asked in zip(values, wanted, strict=True):
        if value and value != holds:
            count += bool(asked)
            holds = value if asked else None
    return count


def stretches(hidden: NDArray[np.bool_]) -> int:
    """How often a joint is hidden: one place each time."""
    return int(np.count_nonzero(np.diff(hidden.astype(int), prepend=0) == 1))


def _by_the_thesis(take: Take) -> Count:
    depth = depth_of(take.joints_m)
    return Count(
        orientation=inputs(np.where(take.posed, take.orientation, ""), take.posed),
        depth=sum(inputs(depth[:, i], take.posed) for i in range(len(LIMBS))),
        joints=open_inputs(take).joints,
    )


def facts_of(made: Ledger) -> Facts:
    """A ledger for a summary: the video's own counts, and the thesis's beside them."""
    return {
        "inputs": msgspec.to_builtins(made.given) | {"all": made.given.total},
        "inputs_that_could_help": msgspec.to_builtins(made.open) | {"all": made.open.total},
        "this_video_by_hand": made.by_hand,
        "this_video_the_thesis_way": made.thesis.total,
        "thesis": {
            each.video: {"frames": each.frames, "by_hand": each.by_hand, "all": each.inputs.total}
            for each in PRINTED
        },
    }


def line_of(facts: Facts) -> str:
    """The ledger in one line."""
    return (
        f"inputs: {facts['inputs']['all']} given, {facts['inputs_that_could_help']['all']} more "
        f"could help (all by hand: {facts['this_video_by_hand']})"
    )
