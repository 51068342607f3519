"""The outlines of a clip of one camera, before anything is made of them (thesis 3.1.3)."""

from collections import deque
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.bus.messages import Box
from common.config import SilhouetteSettings
from common.raster.bounds import box_of, is_cut
from common.raster.similarity import Mask
from common.video.clip_facts import Clip
from common.video.clip_sources import ClipError
from common.video.frame_cache import Reader
from viewer.background.background_source import Scene
from viewer.background.image_stack import LUMA
from viewer.background.stabilization import aligned as laid
from viewer.background.stabilization import alignment_of as place_of
from viewer.background.stabilization import unaligned as back
from viewer.capture import recorded
from viewer.silhouette import silhouette, target_selection
from viewer.silhouette.cast_shadow import without_cast
from viewer.silhouette.silhouette import patched

MOST_FRAMES: Final = 50_000
"""Outlines are kept until the standing height is known, some 10 kB each."""
MOST_COVERED: Final = 0.5
"""Share of the picture that no person covers in most frames; a camera that moves does."""
SURELY_SOMEBODY: Final = 0.5
"""Share of the tallest box so far below which a region may be a shadow: the next frame's is then
looked for everywhere."""
STANDS: Final = 0.75
"""Share of the tallest box above which somebody stands, near the floor with the feet alone."""


class Outline(NamedTuple):
    """The silhouette of one frame."""

    frame: int
    captured_s: float
    bits: NDArray[np.uint8]
    """Packed rows."""
    somebody: bool
    cut: bool

    def mask(self, width: int) -> Mask:
        """(H, W) True inside the person."""
        return np.unpackbits(self.bits, axis=1, count=width).astype(np.bool_)


def outline_of(frame: int, captured_s: float, mask: Mask, cut: bool) -> Outline:
    """A silhouette, packed."""
    return Outline(frame, captured_s, np.packbits(mask, axis=1), bool(mask.any()), cut)


def outlines_of(
    clip: Clip,
    scene: Scene,
    settings: SilhouetteSettings,
    decoder: Reader,
) -> list[Outline]:
    """The silhouette of every frame of a clip's first view, in the frame's own pixels.

    Args:
        clip: One view.
        scene: Without the person.
        settings: Of the silhouettes.
        decoder: Reads the clip.

    Raises:
        ClipError: When the clip is too long, or its camera moves.
        DecoderDied: When the video broke the decoder.
    """
    view = clip.views[0]
    state = silhouette.init(scene.room, settings)
    coming = deque(scene.patches)
    others = target_selection.init(
        scene.room.uncertain.shape, things_move=any(patch.frame for patch in scene.patches)
    )
    near: tuple[float, float] | None = None
    found: list[Outline] = []
    tallest = 0
    for frame in recorded(view, clip.every, decoder):
        if len(found) >= MOST_FRAMES:
            raise ClipError(f"{view.source} has more than {MOST_FRAMES} frames: track parts of it")
        picture, place = frame.picture, None
        if scene.anchor is not None:
            place = place_of(scene.anchor, np.asarray(picture @ LUMA, np.float32))
            picture = laid(picture, place)
        while coming and coming[0].frame <= frame.index:
            state = patched(state, coming.popleft())
        state, seen = silhouette.step(state, picture, near)
        others, body, state = target_selection.step(
            others, picture, seen.mask, state, clip.every / view.fps
        )
        box = box_of(body)
        tall = 0 if box is None else box.bottom + 1 - box.top
        tallest = max(tallest, tall)
        near = _middle(box) if tall > SURELY_SOMEBODY * tallest else None
        mask = body
        if tall > STANDS * tallest:
            mask = without_cast(mask, picture, state.room)
        cut = is_cut(box_of(mask), mask.shape)
        if place is not None:
            mask = back(mask, place)
        found.append(outline_of(frame.index, frame.captured_s, mask, cut))
    _refuse_a_moving_camera(found, view.size, str(view.source))
    return found


def _middle(box: Box | None) -> tuple[float, float] | None:
    if box is None:
        return None
    return (box.left + box.right + 1) / 2, (box.top + box.bottom + 1) / 2


def _refuse_a_moving_camera(
    outlines: Sequence[Outline], size: tuple[int, int], source: str
) -> None:
    areas = [int(np.bitwise_count(o.bits).sum()) for o in outlines if o.somebody]
    if areas and np.median(areas) > MOST_COVERED * size[0] * size[1]:
        raise ClipError(
            f"{source}: most of the picture changes, so its camera moves or its light does: only "
            "videos of a camera that stands still can be tracked"
        )
