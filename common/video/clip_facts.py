"""What a run knows of its clip."""

from bisect import bisect_right
from collections.abc import Iterable
from typing import Any, Final

import msgspec

from common.body.body import Bdp
from common.bus.messages import ViewerNumber
from common.rig.camera import Rig
from common.rig.upright import Upright, Uprights, swapped
from common.video.pictures import Ending, Source

TOUCH_S: Final = 1e-6
"""By which times that are written as fractions of a second may be off."""


class Act(msgspec.Struct, frozen=True):
    """One performance within a clip that holds several."""

    name: str
    first: int
    """Its first frame; `last` is its last."""
    last: int


class Meta(msgspec.Struct, frozen=True):
    """What a clip's `meta.json` tells; keys that are not listed here are left alone."""

    performer: str = ""
    posture: str = ""
    posture_id: int | None = None
    """-1: what is shown is no posture, whatever `posture` calls it."""
    take: int = 0
    acts: tuple[Act, ...] = ()
    """What is performed when, where a clip holds more than one posture."""
    fps: float | None = None
    capture_s: dict[str, tuple[float, ...]] = {}
    """When each frame of a camera was taken, where frames are missing."""


class ClipView(msgspec.Struct, frozen=True):
    """One camera of a clip."""

    number: ViewerNumber
    source: Source
    source_size: tuple[int, int]
    size: tuple[int, int]
    """Width and height to work at, upright."""
    fps: float
    frames: int
    """How many its file claims; 0 for a camera."""
    capture_s: tuple[float, ...] = ()
    """When each frame of a file was taken, where its rate varies."""
    background: str = ""
    """A picture or video of the empty room; "" where there is none."""
    upright: Upright | None = None
    """How the picture that is worked on comes from the file's; None: it is that, made smaller."""
    picked: tuple[int, ...] = ()
    """Those of its frames that are looked at, where the other view is slower; (): all."""
    late_s: float = 0.0
    """By how much its own times are late: they are set back by it."""
    name: str = ""
    """Of its camera; as in a clip folder, by its number, when empty."""

    def __post_init__(self) -> None:
        """Name it by its number where it has no name of its own."""
        if not self.name:
            msgspec.structs.force_setattr(self, "name", f"cam{self.number}")

    @property
    def quarters(self) -> int:
        """By how many quarter turns clockwise its pictures are turned."""
        return 0 if self.upright is None else self.upright.quarters

    @property
    def filed_size(self) -> tuple[int, int]:
        """Of the file's picture at the working size, as it lies there."""
        return self.size if self.upright is None else (self.upright.width, self.upright.height)

    @property
    def upright_source(self) -> tuple[int, int]:
        """Size of the whole picture, upright and with square pixels."""
        if self.upright is None:
            return self.source_size
        wide, high = self.upright.square_width, self.upright.square_height
        width = round(self.source_size[0] * wide / self.upright.width)
        height = round(self.source_size[1] * high / self.upright.height)
        return swapped((width, height), self.upright.quarters)

    def captured_s(self, index: int) -> float:
        """When a frame of a file was taken, seconds since the clip began.

        Frames beyond the end of `capture_s` follow its last at the frame rate.
        """
        return self._own_s(index) - self.late_s

    def frames_in(self, lasts_s: float) -> int:
        """How many frames are taken from the first on before so long is over: one, at least."""
        until_s, count = self.captured_s(0) + lasts_s - TOUCH_S, 1
        while self.captured_s(count) < until_s:
            count += 1
        return count

    def every(self, every: int) -> int:
        """Every how manieth frame is to be decoded, where every n-th of a clip is looked at."""
        return 1 if self.picked else every

    def next_s(self, index: int, every: int) -> float:
        """When the frame is taken that is looked at after one, at the earliest."""
        if not self.picked:
            return self.captured_s(index + every)
        place = bisect_right(self.picked, index)
        return self.captured_s(self.picked[place] if place < len(self.picked) else self.frames)

    def is_looked_at(self, index: int) -> bool:
        """Whether a frame is, of those that are decoded."""
        if not self.picked:
            return True
        place = bisect_right(self.picked, index)
        return place > 0 and self.picked[place - 1] == index

    def _own_s(self, index: int) -> float:
        """The same by its own times."""
        beyond = index - len(self.capture_s) + 1
        if beyond <= 0:
            return self.capture_s[index]
        return (self.capture_s[-1] + beyond / self.fps) if self.capture_s else index / self.fps


class Clip(msgspec.Struct, frozen=True):
    """The views of one room."""

    name: str
    views: tuple[ClipView, ...]
    every: int
    rig: Rig | None
    """Calibration at the working size, one camera a view; None where there is none."""
    meta: Meta
    warnings: tuple[str, ...] = ()
    """What is odd but does not stop a run."""
    body: Bdp | None = None
    """The person's lengths, metres, where they were measured before."""


def unread(view: ClipView, ending: Ending) -> bool:
    """Whether the end of a video is lost: it was cut off, or is damaged.

    One that claims too many frames, as its duration is the sound's or an edit list hides some of
    them, is whole: FFmpeg reads it without complaint.
    """
    return ending.damaged > 0 and ending.frames < view.frames


def shortfall(view: ClipView, ending: Ending) -> str:
    """What to say of a video that could not be read to its end, or is damaged; "" if neither."""
    if unread(view, ending):
        read = f"{ending.frames} of {view.frames} frames could be read"
        return f"{view.source} was cut off or is damaged: {read}; copy or record it again"
    if ending.damaged:
        where = f"in {ending.damaged} of its {ending.frames} frames"
        return f"{view.source} is damaged {where}, where persons may be missed; copy it again"
    return ""


def unread_facts(endings: Iterable[tuple[ClipView, Ending]]) -> dict[str, Any]:
    """Of the videos whose end is lost, for the summary: how many frames were read of how many."""
    lost = {
        str(view.source): {"read": ending.frames, "of": view.frames}
        for view, ending in endings
        if unread(view, ending)
    }
    return {"unread": lost} if lost else {}


def set_back(clip: Clip, late_s: float) -> Clip:
    """The clip with the times of its second view set back by so much more."""
    first, second = clip.views
    second = msgspec.structs.replace(second, late_s=second.late_s + late_s)
    return msgspec.structs.replace(clip, views=(first, second))


def clip_summary(clip: Clip) -> dict[str, Any]:
    """Of what a run is, for its summary, as the clip says itself."""
    return {
        "clip": clip.name,
        "cameras": [*camera_names(clip)],
        "performer": clip.meta.performer,
        "posture_meant": clip.meta.posture,
    }


def camera_names(clip: Clip) -> tuple[str, ...]:
    """Names of the rig's cameras in their order: two at least, also where one is looked at."""
    own = {view.number: view.name for view in clip.views}
    return tuple(own.get(number, f"cam{number}") for number in _numbers(clip))


def uprights_of(clip: Clip) -> Uprights:
    """How each viewer's pictures come from its file's, in the order of the rig's cameras."""
    own = {view.number: view.upright for view in clip.views}
    return tuple(own.get(number) for number in _numbers(clip))


def whole_rig(clip: Clip) -> Rig | None:
    """The clip's rig with a camera for each number; one that is not looked at gets another's."""
    if clip.rig is None:
        return None
    own = {view.number: camera for view, camera in zip(clip.views, clip.rig.cameras, strict=True)}
    cameras = tuple(own.get(number, clip.rig.cameras[0]) for number in _numbers(clip))
    return msgspec.structs.replace(clip.rig, cameras=cameras)


def _numbers(clip: Clip) -> range:
    """Of the rig's cameras, up to the last that is looked at."""
    return range(1, max(2, *(view.number for view in clip.views)) + 1)
