"""Who is followed among what a silhouette holds: other people, scraps and things are left out."""

from typing import Final, NamedTuple

import cv2
import numpy as np

from common.compiled import KERNEL
from common.raster.similarity import Mask
from viewer.background.background import light_gain
from viewer.background.image_stack import CHANGES, Bytes, Floats, Frame
from viewer.silhouette import silhouette
from viewer.silhouette.colour_model import familiar
from viewer.silhouette.difference import light_of, shade_of
from viewer.silhouette.regions import boxes_of, same_body

SCRAP: Final = 0.03
"""A region apart of less than this share of the silhouette is a reflection or noise."""
OWN: Final = 0.3
"""A region apart that was the body's to this share just before is a part of it."""
AT_REST_S: Final = 1.0
"""What shows the same for so long may be a thing that the person moved, if it has such a colour."""
ROOMS: Final = np.float32(-0.5)
"""From -1, only the room has a colour, to 1, only the body has it: things at rest have such. At
-0.3 silhouettes of r01 and r04 lose 0.008 of their IoU to it, at -0.6 0.0025."""
RECALLED_S: Final = 15.0
"""For how long colours are remembered: things are soon taken for body, and would be for good."""


class State(NamedTuple):
    """What one frame hands to the next."""

    things_move: bool
    """Whether what is at rest may be a thing; bodies rest too, and have some of its colours."""
    body: Mask
    """(H, W) whom the frame showed."""
    grey: Bytes
    """(H, W) what every pixel showed when it last changed."""
    at_rest_s: Floats
    """(H, W) since when."""
    colours: Floats | None = None
    """Counts of the colours of room and body, slowly changing; None: nobody came."""


def init(size: tuple[int, int], things_move: bool) -> State:
    """Nobody was there; (H, W) is the size of the pictures."""
    nothing = np.zeros(size, np.uint8)
    return State(things_move, nothing.view(np.bool_), nothing, np.zeros(size, np.float32))


def step(
    state: State, picture: Frame, mask: Mask, seen: silhouette.State, dt_s: float
) -> tuple[State, Mask, silhouette.State]:
    """The silhouette without what is not the body followed, and what was learnt of the room.

    Args:
        state: From `init` or the step before.
        picture: (H, W, 3).
        mask: (H, W) what differs from the room in it; it may have several regions.
        seen: State of the silhouettes after that picture.
        dt_s: Seconds since the picture before.
    """
    if state.things_move:
        state, mask, seen = _things_apart(state, picture, mask, seen, dt_s)
    mask = without_others(mask, state.body)
    return state._replace(body=mask), mask, seen


def _things_apart(
    state: State, picture: Frame, mask: Mask, seen: silhouette.State, dt_s: float
) -> tuple[State, Mask, silhouette.State]:
    """The same, but for others than who is followed."""
    grey, at_rest_s = state.grey.copy(), state.at_rest_s.copy()
    _rest(grey, at_rest_s, cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.float32(dt_s))
    colours = state.colours
    if mask.any():
        colours = _remembered(colours, seen.colours, min(1.0, dt_s / RECALLED_S))
        mask, room = _without_things(mask, at_rest_s, picture, seen.room, colours)
        seen = seen._replace(room=room)
    return state._replace(grey=grey, at_rest_s=at_rest_s, colours=colours), mask, seen


def without_others(mask: Mask, before: Mask) -> Mask:
    """The silhouette without regions that are somebody else's.

    Args:
        mask: (H, W) of this frame; it may have several regions.
        before: (H, W) of the frame before, as this returned it; empty if nobody was there.
    """
    left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
    around = np.s_[top : top + height, left : left + width]
    count, labels, stats, _ = cv2.connectedComponentsWithStatsWithAlgorithm(
        mask[around].view(np.uint8), 8, cv2.CV_32S, cv2.CCL_GRANA
    )
    if count <= 2:
        return mask
    areas = stats[:, cv2.CC_STAT_AREA].astype(np.float64)
    areas[0] = 0.0
    shared = np.bincount(labels[before[around]], minlength=count).astype(np.float64)
    shared[0] = 0.0
    best = int(np.argmax(shared if shared.any() else areas))
    own = shared >= OWN * areas if shared.any() else np.ones(count, np.bool_)
    own |= same_body(boxes_of(stats), best, len(mask))  # a part may have been missed for a frame
    own &= areas >= SCRAP * areas.sum()
    own[best], own[0] = True, False
    found = np.zeros_like(mask)
    found[around] = own[labels]
    return found


def _remembered(before: Floats | None, now: Floats, share: float) -> Floats:
    return now if before is None else before + np.float32(share) * (now - before)


def _without_things(
    mask: Mask, at_rest_s: Floats, picture: Frame, room: Floats, colours: Floats
) -> tuple[Mask, Floats]:
    """The silhouette without what is at rest and has the room's colours, and the room with that:
    things that were moved."""
    kept, gain = mask.view(np.uint8).copy(), light_gain(picture, room)
    if not _taken(kept, at_rest_s, picture, familiar(colours), gain):
        return mask, room
    things = mask & (kept == 0)
    room = room.copy()
    room[things] = picture[things] / gain
    return cv2.medianBlur(kept, 3) > 0, room


@KERNEL
def _rest(grey: Bytes, at_rest_s: Floats, now: Bytes, dt_s: np.float32) -> None:
    """Go on with what a picture shows, and for how long, in place."""
    for y in range(now.shape[0]):
        for x in range(now.shape[1]):
            if abs(np.int32(now[y, x]) - np.int32(grey[y, x])) > CHANGES:
                grey[y, x], at_rest_s[y, x] = now[y, x], 0.0
            else:
                at_rest_s[y, x] += dt_s


@KERNEL
def _taken(mask: Bytes, at_rest_s: Floats, picture: Frame, known: Floats, gain: Floats) -> int:
    """Take what is at rest and has the room's colours out of a mask, in place; how many pixels."""
    count, light = 0, light_of(gain)
    for y in range(mask.shape[0]):
        given = picture[y]
        for x in range(mask.shape[1]):
            still = mask[y, x] and at_rest_s[y, x] >= AT_REST_S
            if still and known[shade_of(given, light, x)] < ROOMS:
                mask[y, x] = 0
                count += 1
    return count
