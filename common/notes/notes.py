"""The user's inputs to a video from one camera: orientation, depth, hidden joints."""

import itertools
import math
from typing import Final, Literal, get_args

import msgspec

from common.body.body import JOINT_NAMES, LIMBS

Orientation = Literal[
    "left", "right", "backward_left", "backward_right", "forward_left", "forward_right"
]
"""Which way a person faces: left and right as in the picture, forward to the camera (T22)."""
Depth = Literal["toward", "away"]
"""Whether a segment's far end is nearer to the camera than its near end, or farther (T21). The
far end is the one away from the trunk; of the trunk itself, the neck."""
Auto = Literal["auto"]
"""Value that gives a decision back to the program."""
JointPixel = tuple[float, float]
"""Column and row in the video's own pixels; the centre of the top-left one is (0.5, 0.5)."""

ORIENTATIONS: Final[tuple[Orientation, ...]] = get_args(Orientation)
WAYS: Final[tuple[Depth, ...]] = get_args(Depth)

MOST_PX: Final = 1e5
"""Upper bound of a column or row, pixels."""


class Note(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """The user's input at one frame; it holds until a later note changes it."""

    frame: int
    """Index of the frame in the video."""
    orientation: Orientation | Auto | None = None
    depth: dict[str, Depth | Auto] = {}
    """By segment: a name of LIMBS."""
    joints_px: dict[str, JointPixel | Auto] = {}
    """By joint: a name of JOINT_NAMES."""

    def __post_init__(self) -> None:
        """Refuse what no video can have."""
        if self.frame < 0:
            raise ValueError(f"frame must not be negative, got {self.frame}")
        for key, known in (("depth", LIMBS), ("joints_px", JOINT_NAMES)):
            unknown = [name for name in getattr(self, key) if name not in known]
            if unknown:
                raise ValueError(f"{key} knows no {unknown[0]}")
        for name, place in self.joints_px.items():
            if place != "auto" and not all(_in_a_picture(value) for value in place):
                raise ValueError(f"joints_px has {name} at no place of a picture: {place}")


class Notes(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """All the user's inputs to a video, in the order of frames."""

    video: str = ""
    """Name of the video file; "": the one beside the notes."""
    note: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        """Sort the notes; refuse two for one frame."""
        ordered = tuple(sorted(self.note, key=lambda note: note.frame))
        for before, after in itertools.pairwise(ordered):
            if before.frame == after.frame:
                raise ValueError(f"note: two of frame {after.frame}: join them")
        msgspec.structs.force_setattr(self, "note", ordered)


class Held(msgspec.Struct, frozen=True):
    """The user's inputs that hold at one frame; the program decides what is missing."""

    orientation: Orientation | None = None
    depth: dict[str, Depth] = {}
    joints_px: dict[str, JointPixel] = {}


def held(notes: Notes, frame: int) -> Held:
    """The inputs that hold at a frame: of each entry the newest that is not later (T21)."""
    orientation: Orientation | Auto | None = None
    depth: dict[str, Depth | Auto] = {}
    joints_px: dict[str, JointPixel | Auto] = {}
    for note in notes.note:
        if note.frame <= frame:
            orientation = note.orientation or orientation
            depth = {**depth, **note.depth}
            joints_px = {**joints_px, **note.joints_px}
    return Held(
        None if orientation == "auto" else orientation,
        {name: way for name, way in depth.items() if way != "auto"},
        {name: place for name, place in joints_px.items() if place != "auto"},
    )


def noted(notes: Notes, new: Note) -> Notes:
    """The notes with one more input; entries without effect are left out."""
    others = [note for note in notes.note if note.frame != new.frame]
    old = next((note for note in notes.note if note.frame == new.frame), Note(new.frame))
    joined = Note(
        new.frame,
        new.orientation or old.orientation,
        {**old.depth, **new.depth},
        {**old.joints_px, **new.joints_px},
    )
    return _tidied(Notes(notes.video, (*others, joined)))


def placed_once(notes: Notes, frame: int, joint: str, place: JointPixel) -> Notes:
    """The notes with a joint placed in one frame alone: the next frame has the input from
    before."""
    before: JointPixel | Auto = held(notes, frame + 1).joints_px.get(joint, "auto")
    first = noted(notes, Note(frame, joints_px={joint: place}))
    return noted(first, Note(frame + 1, joints_px={joint: before}))


def _tidied(notes: Notes) -> Notes:
    """The notes without entries that repeat what holds already."""
    kept: list[Note] = []
    for note in notes.note:
        before = held(Notes(note=tuple(kept)), note.frame)
        fresh = Note(
            note.frame,
            note.orientation if note.orientation != (before.orientation or "auto") else None,
            {k: v for k, v in note.depth.items() if v != before.depth.get(k, "auto")},
            {k: v for k, v in note.joints_px.items() if v != before.joints_px.get(k, "auto")},
        )
        if fresh != Note(note.frame):
            kept.append(fresh)
    return Notes(notes.video, tuple(kept))


def _in_a_picture(value: float) -> bool:
    return math.isfinite(value) and abs(value) <= MOST_PX
