"""What a run knows about its clip."""

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from typing import Any, Final

import msgspec

from common.body.body import Bdp
from common.bus.messages import ViewerNumber
from common.rig.camera import Rig
from common.rig.upright import Upright, Uprights, swapped
from common.video.pictures import Ending, Source

TOUCH_S: Final = 1e-6
"""Tolerance of times that are written as fractions of a second."""


class Act(msgspec.Struct, frozen=True):
    """One performance within a clip that holds several."""

    name: str
    first: int
    """First frame; `last` is the last one."""
    last: int


class Meta(msgspec.Struct, frozen=True):
    """The content of a clip's `meta.json`; unlisted keys are ignored."""

    performer: str = ""
    posture: str = ""
    posture_id: int | None = None
    """Number of the posture; -1: no posture of the model, whatever `posture` calls it."""
    take: int = 0
    acts: tuple[Act, ...] = ()
    """The performances in a clip that holds several."""
    fps: float | dict[str, float] | None = None
    """Rate of all videos, or of each by camera."""
    capture_s: dict[str, tuple[float, ...]] = {}
    """Capture times of a camera's frames, where frames are missing."""

    def fps_of(self, camera: str) -> float | None:
        """The rate that is told of a camera's video."""
        return self.fps.get(camera) if isinstance(self.fps, dict) else self.fps


class ClipView(msgspec.Struct, frozen=True):
    """One camera of a clip."""

    number: ViewerNumber
    source: Source
    source_size: tuple[int, int]
    size: tuple[int, int]
    """Width and height to work at, upright."""
    fps: float
    frames: int
    """Number of frames that the file claims; 0 for a camera."""
    capture_s: tuple[float, ...] = ()
    """Capture times of a file's frames, where the rate varies."""
    background: str = ""
    """Path of a picture or video of the empty background; "" where there is none."""
    upright: Upright | None = None
    """How the working picture comes from the file's; None: reduced alone."""
    picked: tuple[int, ...] = ()
    """Indices of the frames to process, where the other view is slower; (): all."""
    late_s: float = 0.0
    """Delay of this view: its times are set back by it."""
    name: str = ""
    """Camera name; as in a clip folder, by its number, where empty."""

    def __post_init__(self) -> None:
        """Give the view its number as a name where it has none."""
        if not self.name:
            msgspec.structs.force_setattr(self, "name", f"cam{self.number}")

    @property
    def quarters(self) -> int:
        """Clockwise quarter turns of its pictures."""
        return 0 if self.upright is None else self.upright.quarters

    @property
    def filed_size(self) -> tuple[int, int]:
        """Size of the file's picture at the working size, as stored."""
        return self.size if self.upright is None else (self.upright.width, self.upright.height)

    @property
    def known_frames(self) -> int:
        """Number of frames that the file claims; where it claims none, as one whose recording was
        killed, of those whose time is known."""
        return self.frames or len(self.capture_s)

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
        """Capture time of a file's frame, seconds since the clip began.

        Frames beyond the end of `capture_s` continue at the frame rate.
        """
        return self._own_s(index) - self.late_s

    def frames_in(self, lasts_s: float) -> int:
        """Number of frames within that many seconds from the first on; at least one."""
        until_s, count = self.captured_s(0) + lasts_s - TOUCH_S, 1
        while self.captured_s(count) < until_s:
            count += 1
        return count

    def every(self, every: int) -> int:
        """Decoding stride, where every n-th frame of a clip is processed."""
        return 1 if self.picked else every

    def next_s(self, index: int, every: int) -> float:
        """Earliest time of the next processed frame."""
        if not self.picked:
            return self.captured_s(index + every)
        place = bisect_right(self.picked, index)
        return self.captured_s(
            self.picked[place] if place < len(self.picked) else self.known_frames
        )

    def is_looked_at(self, index: int) -> bool:
        """Whether a decoded frame is processed."""
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
    """Calibration at the working size, one camera per view; None where there is none."""
    meta: Meta
    warnings: tuple[str, ...] = ()
    """Oddities that do not stop a run."""
    body: Bdp | None = None
    """The person's lengths, metres, where an earlier clip measured them."""


def unread(view: ClipView, ending: Ending) -> bool:
    """Whether the end of a video is missing: it was cut off, or is damaged.

    A video that claims too many frames, as where its duration is the sound's or an edit list hides
    some, is complete: FFmpeg reads it without complaint.
    """
    return ending.damaged > 0 and ending.frames < view.frames


def shortfall(view: ClipView, ending: Ending) -> str:
    """A warning about a video that could not be read to its end, or is damaged; "" if neither."""
    if unread(view, ending):
        read = f"{ending.frames} of {view.frames} frames could be read"
        return f"{view.source} was cut off or is damaged: {read}; copy or record it again"
    if ending.damaged:
        where = f"in {ending.damaged} of its {ending.frames} frames"
        return f"{view.source} is damaged {where}, where persons may be missed; copy it again"
    return ""


def unread_facts(endings: Iterable[tuple[ClipView, Ending]]) -> dict[str, Any]:
    """For the summary, the videos whose end is missing: frames read of frames claimed."""
    lost = {
        str(view.source): {"read": ending.frames, "of": view.frames}
        for view, ending in endings
        if unread(view, ending)
    }
    return {"unread": lost} if lost else {}


def set_back(clip: Clip, late_s: Sequence[float]) -> Clip:
    """The clip with the times of each view after the first set back by that much more."""
    first, *others = clip.views
    later = (
        msgspec.structs.replace(view, late_s=view.late_s + more_s)
        for view, more_s in zip(others, late_s, strict=True)
    )
    return msgspec.structs.replace(clip, views=(first, *later))


def clip_summary(clip: Clip) -> dict[str, Any]:
    """Facts of the clip for a run's summary."""
    return {
        "clip": clip.name,
        "cameras": [*camera_names(clip)],
        "performer": clip.meta.performer,
        "posture_meant": clip.meta.posture,
    }


def camera_names(clip: Clip) -> tuple[str, ...]:
    """Names of the rig's cameras in order: two at least, even where one is used."""
    own = {view.number: view.name for view in clip.views}
    return tuple(own.get(number, f"cam{number}") for number in _numbers(clip))


def uprights_of(clip: Clip) -> Uprights:
    """How each viewer's pictures come from its file's, in the order of the rig's cameras."""
    own = {view.number: view.upright for view in clip.views}
    return tuple(own.get(number) for number in _numbers(clip))


def whole_rig(clip: Clip) -> Rig | None:
    """The clip's rig with a camera for each number; an unused number gets another's camera."""
    if clip.rig is None:
        return None
    own = {view.number: camera for view, camera in zip(clip.views, clip.rig.cameras, strict=True)}
    cameras = tuple(own.get(number, clip.rig.cameras[0]) for number in _numbers(clip))
    return msgspec.structs.replace(clip.rig, cameras=cameras)


def _numbers(clip: Clip) -> range:
    """Capture rates of the rig's cameras, up to the last one used."""
    return range(1, max(2, *(view.number for view in clip.views)) + 1)
