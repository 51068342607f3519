"""The input of a viewer's step."""

import msgspec

from common.body.observation import Landmarks
from common.rig.upright import Upright
from common.video.pictures import Image


class CapturedFrame(msgspec.Struct, frozen=True):
    """One picture and when it was taken."""

    index: int
    """Index of the frame in the video, also where only every n-th frame is used."""
    captured_s: float
    """Seconds since the clip began, or by the room's clock for a camera."""
    clock_s: float
    """The same moment by the room's clock; offline the same as `captured_s`."""
    picture: Image
    """(height, width, 3), BGR, at the working size."""
    next_s: float | None = None
    """Earliest `captured_s` of the next frame; None for a camera, which cannot know it."""
    landmarks: tuple[Landmarks, ...] = ()
    """Landmarks of every person that an outside source detects, in pixels of `picture`."""
    upright: Upright | None = None
    """How `picture` comes from the file's; None: reduced alone."""
    hurried: bool = False
    """Whether the frame comes late, so that only the silhouette is computed, and of several people
    one is looked at."""
