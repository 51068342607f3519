"""The empty room: what every pixel shows while nobody is there (section 1; thesis 3.1.2)."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

Frame = NDArray[np.uint8]
"""A picture at the working size: (H, W, 3), blue green red."""
Floats = NDArray[np.float32]

LUMA: Final = np.array([0.114, 0.587, 0.299], np.float32)
"""Shares of blue, green and red in brightness (ITU-R BT.601)."""
SENSOR_NOISE: Final = 2.0
"""Grey levels; taken for granted where one picture alone shows the room."""
FLOOR: Final = (1.0, 2.5)
"""Least spread of brightness and of colour, grey levels: rounding, and the colour that compression
smears around a person, which no empty frame can show."""
GUESSED: Final = 4.0
"""Spread of a pixel whose room was guessed, grey levels."""
CHANGES: Final = 12.0
"""Grey levels of brightness that tell a change from noise while no model stands."""
EDGE_SHARE: Final = 0.45
"""Of an empty opening the outlines of what differs later keep less than this share of their
steepness, otherwise more: 0.05-0.41 and 0.49-2.5 on every third development clip."""
GAIN_SAMPLES: Final = 1500.0
"""About how many pixels, on a grid, are asked for the light: a median of so many is steady."""


class Background(NamedTuple):
    """The empty room, pixel by pixel."""

    centre: Floats
    """(H, W, 3) grey levels."""
    spread: Floats
    """(H, W, 2) standard deviation of brightness and of colour, grey levels."""
    uncertain: NDArray[np.bool_]
    """(H, W) True where the room was never seen and is guessed."""


def learn(frames: Sequence[Frame]) -> Background:
    """The room from pictures of it, empty.

    The minimum, maximum and largest step that W4 keeps grow with the number of frames; their place
    is taken here by mean and standard deviation, after the flicker of the light is taken out, and
    the deviations are pooled over 5x5 pixels, since eight frames alone say little.

    Args:
        frames: One or more pictures of one size.

    Raises:
        ValueError: When there is no frame.

    Source: Huang & Chung 2004, section 1 (W4); requirement P3.
    """
    if not frames:
        raise ValueError("a background needs at least 1 frame, got 0")
    even = _even(frames)
    centre = even.mean(axis=0)
    return Background(centre, _spread(even - centre), np.zeros(centre.shape[:2], np.bool_))


def learn_from_clip(frames: Sequence[Frame]) -> Background:
    """The room from pictures in which somebody is always in view.

    What never changes is room. Inside the hull of what moves, the room is guessed row by row from
    both sides of the hull, and the guess gives way to what frames show there, if any come near it.

    Args:
        frames: Pictures from all over a clip, of one size.

    Raises:
        ValueError: When there is no frame.

    Source: thesis section 3.1.2, without its segmentation of colours; requirement T7.
    """
    if not frames:
        raise ValueError("a background needs at least 1 frame, got 0")
    even = _even(frames)
    centre = np.median(even, axis=0).astype(np.float32)
    away = np.abs((even - centre) @ LUMA)
    held = _held(away)
    guess = _bridge(centre, held)
    near = np.abs((even - guess) @ LUMA) < CHANGES
    shown = near.sum(axis=0)
    mean = (even * near[..., None]).sum(axis=0) / np.maximum(shown, 1)[..., None]
    uncertain = held & (shown == 0)
    room = np.where(held[..., None], np.where(uncertain[..., None], guess, mean), centre)
    calm = np.where((away < CHANGES)[..., None], even - centre, 0.0).astype(np.float32)
    spread = _spread(calm)
    spread[held] = np.median(spread[~held], axis=0) if not held.all() else SENSOR_NOISE
    spread[uncertain] = np.maximum(spread[uncertain], GUESSED)
    return Background(room.astype(np.float32), spread, uncertain)


def is_empty_opening(opening: Sequence[Frame], sample: Sequence[Frame]) -> bool:
    """Whether the opening frames show the room without a person.

    What differs between the opening and a later frame has its outline in the picture that holds
    the person: only in the later one if the opening is empty, in both if somebody stood there.

    Args:
        opening: The first frames of a clip.
        sample: Frames from all over it, of the same size.
    """
    room = np.median(_even(opening), axis=0).astype(np.float32)
    room_luma = room @ LUMA
    room_slope = _slope(room_luma)
    in_room, in_frames = 0.0, 0.0
    for frame in sample:
        shares = (LUMA / light_gain(frame, room))[None]
        luma = cv2.transform(frame.astype(np.float32), shares)
        differs = _large(np.abs(luma - room_luma) > CHANGES)
        outline = cv2.morphologyEx(differs, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)) > 0
        steeper = _slope(luma) - room_slope
        in_frames += float(steeper[outline].clip(min=0).sum())
        in_room -= float(steeper[outline].clip(max=0).sum())
    return in_room <= EDGE_SHARE * in_frames


@njit(cache=True, fastmath=True)
def light_gain(frame: Frame, room: Floats) -> Floats:
    """How much brighter a frame is than the room, per channel, whoever stands in it.

    The median of the ratio over a grid of pixels, then the mean of the ratios around it, so that
    neither a person nor a shadow on less than half of the picture counts.

    Args:
        frame: (H, W, 3).
        room: (H, W, 3) grey levels.

    Returns:
        (3,) factors, 1 where the room is too dark to tell.
    """
    height, width = frame.shape[:2]
    stride = max(1, int(np.sqrt(height * width / GAIN_SAMPLES)))
    bins, unit = 600, 300
    seen = np.zeros((3, bins), np.float32)
    due = np.zeros((3, bins), np.float32)
    for y in range(stride // 2, height, stride):
        for x in range(stride // 2, width, stride):
            for c in range(3):
                given, asked = np.float32(frame[y, x, c]), room[y, x, c]
                at = int(given / max(asked, np.float32(1)) * unit)
                # what became white may be brighter than it shows; what was white already counts
                if asked > 20 and (given < 250 or asked >= 250) and at < bins:
                    seen[c, at] += given
                    due[c, at] += asked
    gain = np.ones(3, np.float32)
    for c in range(3):
        half, middle = due[c].sum() / 2, 0
        if half <= 0:
            continue
        run = due[c, 0]
        while run < half:
            middle += 1
            run += due[c, middle]
        for _ in range(4):
            low, high = max(0, middle - 18), min(bins, middle + 19)
            gain[c] = seen[c, low:high].sum() / due[c, low:high].sum()
            middle = min(int(gain[c] * unit), bins - 1)
    return gain


def _even(frames: Sequence[Frame]) -> Floats:
    """All frames under the light of their median: (n, H, W, 3) grey levels."""
    middle = np.median(np.stack(frames), axis=0).astype(np.float32)
    return np.stack([(frame / light_gain(frame, middle)).astype(np.float32) for frame in frames])


def _spread(deviations: Floats) -> Floats:
    """Standard deviation of brightness and colour, (H, W, 2), from (n, H, W, 3) deviations."""
    count = len(deviations)
    if count == 1:
        return np.full((*deviations.shape[1:3], 2), np.hypot(SENSOR_NOISE, FLOOR), np.float32)
    luma = deviations @ LUMA
    colour = deviations - luma[..., None]
    # colour has two degrees of freedom: the third is brightness
    squares = np.stack([(luma**2).sum(0), (colour**2).sum((0, 3)) / 2], axis=-1) / (count - 1)
    return np.asarray(np.sqrt(cv2.blur(squares, (5, 5)) + np.square(FLOOR)), np.float32)


def _large(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Regions as tall as an arm's stroke, 0.1 of the picture; the counter in a corner is none."""
    closed = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
    _, labels, stats, _ = cv2.connectedComponentsWithStats(closed)
    tall = stats[:, cv2.CC_STAT_HEIGHT] >= 0.1 * mask.shape[0]
    tall[0] = False
    return tall[labels].astype(np.uint8)


def _slope(luma: Floats) -> Floats:
    across = cv2.Sobel(luma, cv2.CV_32F, 1, 0)
    down = cv2.Sobel(luma, cv2.CV_32F, 0, 1)
    return cv2.magnitude(across, down)


def _held(away: Floats) -> NDArray[np.bool_]:
    """(H, W) True in the hull of what moves, unless it is plain that the median is the room.

    A person who roams covers any one pixel in few of the frames, and the hull is wide; who stays
    on the spot leaves a hull that is taller than wide.
    """
    moved = (away > CHANGES).mean(axis=0)
    moving = _large(moved > 0)
    corners = cv2.findNonZero(moving)
    if corners is None:
        return np.zeros(moved.shape, np.bool_)
    hull = np.zeros(moved.shape, np.uint8)
    cv2.fillConvexPoly(hull, cv2.convexHull(corners), 1)
    reach = max(1, moved.shape[0] // 60)
    hull = cv2.dilate(hull, np.ones((2 * reach + 1, 2 * reach + 1), np.uint8))
    _, _, width, height = cv2.boundingRect(corners)
    roams = width > 1.5 * height
    return (hull > 0) & ((moved == 0) | (moved > 0.3)) if roams else hull > 0


def _bridge(picture: Floats, held: NDArray[np.bool_]) -> Floats:
    """The picture with the held stretch of every row drawn from its two ends."""
    out = picture.copy()
    columns = np.arange(picture.shape[1])
    for y in np.flatnonzero(held.any(axis=1) & ~held.all(axis=1)):
        known = ~held[y]
        for c in range(3):
            out[y, held[y], c] = np.interp(columns[held[y]], columns[known], picture[y, known, c])
    return out
