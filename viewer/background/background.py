"""The background: each pixel's values without a person (section 1; thesis 3.1.2)."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.compiled import compiling
from common.video.pictures import Image
from viewer.background.image_stack import Floats, Overlaid, median, overlaid

SENSOR_NOISE: Final = 2.0
"""Noise of a pixel, grey levels, assumed where a single picture shows the background."""
FLOOR: Final = (1.0, 2.5)
"""Lower bound of the spread of brightness and of colour, grey levels: rounding, and the colour
that compression smears around a person, which no empty frame shows."""
STRIDE: Final = 8
"""Stride of the rows and columns at which a picture's brightness is sampled, pixels."""
LEAST_LIGHT: Final = np.float32(0.01)
"""Lower bound of a frame's light, as a share of the background's: a covered camera, or a dark
room, shows nothing."""
DARK: Final = 0.2
"""Share of the background's light below which a frame shows mostly noise."""
GAIN_SAMPLES: Final = 1500.0
"""Approximate number of grid pixels that determine the light: their median is stable."""
LEFT_HIDDEN: Final = 0.01
"""A person who stays on a spot hides 2 to 20 % of the picture all through a clip, one who roams up
to 0.4 %."""


class Background(NamedTuple):
    """The background, pixel by pixel."""

    centre: Floats
    """(H, W, 3) grey levels."""
    spread: Floats
    """(H, W, 2) standard deviation of brightness and of colour, grey levels."""
    uncertain: NDArray[np.bool_]
    """(H, W) True where the background was never seen and is guessed."""
    low: Floats
    """(H, W, 3) least grey levels that were seen while no person was there (W4)."""
    high: Floats
    """(H, W, 3) greatest values in the frames that the background was learnt from."""
    step: Floats
    """(H, W, 3) largest changes between two successive ones."""

    @property
    def is_estimate(self) -> bool:
        """Whether a part that people hide all through a clip is guessed."""
        return float(self.uncertain.mean()) >= LEFT_HIDDEN


class BackgroundModel(NamedTuple):
    """The values that every pixel of a frame is compared with; compiled passes read it directly."""

    centre: Floats
    """(H, W, 3) grey levels of the background under slowly changing light."""
    weight: Floats
    """(H, W, 2) 1 / spread^2 of brightness and of colour."""
    gain: Floats
    """(3,) brightness of the frame relative to that."""
    body_colours: Floats
    """(SHADES,) from -1, a colour of the background alone, to 1, a colour of the body alone."""


def learn(frames: Sequence[Image]) -> Background:
    """The background from pictures of it.

    Args:
        frames: One or more pictures of one size.

    Raises:
        ValueError: When there is no frame.
    """
    shown = lit(frames)
    return learnt(overlaid_opening(shown), shown)


def lit(frames: Sequence[Image]) -> list[Image]:
    """The lit ones of some pictures: a black one shows nothing, as when a camera starts or is
    covered for a moment."""
    bright = [float(frame[::STRIDE, ::STRIDE].mean()) for frame in frames]
    least = DARK * max(bright, default=0.0)
    return [frame for frame, own in zip(frames, bright, strict=True) if own >= least]


def learnt(empty: Overlaid, frames: Sequence[Image]) -> Background:
    """The background from pictures of it, as a stack.

    The minimum, maximum and largest step that W4 keeps grow with the number of frames. Mean and
    standard deviation replace them here, after the flicker of the light is removed; the deviations
    are pooled over 5x5 pixels, since eight frames alone give poor estimates.

    W4's own statistics are kept too, for silhouettes as printed.

    Args:
        empty: The stack of pictures.
        frames: The pictures themselves.

    Source: Huang & Chung 2004, section 1 (W4); requirement P3.
    """
    spread = spread_of(empty.squares, len(empty.moving))
    return Background(empty.mean, spread, np.zeros(spread.shape[:2], np.bool_), *_range(frames))


def estimated(centre: Floats, spread: Floats, uncertain: NDArray[np.bool_]) -> Background:
    """A background that no empty frame showed: its range is its estimate, plus and minus noise."""
    return Background(centre, spread, uncertain, centre, centre, np.full_like(centre, SENSOR_NOISE))


def unknown(picture: Image) -> Background:
    """No background: any pixel of a first picture (H, W, 3) may show the person."""
    centre = picture.astype(np.float32)
    spread = np.full((*picture.shape[:2], 2), FLOOR, np.float32)
    return estimated(centre, spread, np.ones(picture.shape[:2], np.bool_))


def _range(frames: Sequence[Image]) -> tuple[Floats, Floats, Floats]:
    """Least and greatest grey levels of every pixel, and its largest steps, (H, W, 3) each."""
    stack = np.stack(frames).astype(np.float32)
    steps = np.abs(np.diff(stack, axis=0))
    return stack.min(axis=0), stack.max(axis=0), steps.max(axis=0, initial=SENSOR_NOISE)


def overlaid_opening(frames: Sequence[Image]) -> Overlaid:
    """A stack of pictures, normalised to the light of their median.

    Raises:
        ValueError: When there is none.
    """
    if not frames:
        raise ValueError("a background needs at least 1 frame, got 0")
    middle = median(frames)
    lights = np.stack([light_gain(frame, middle) for frame in frames])
    return overlaid(np.stack(frames), lights)


@compiling(fastmath=True)
def light_gain(frame: Image, background: Floats) -> Floats:
    """Light of a frame relative to the background, per channel, with or without a person in it.

    The median of the ratio over a grid of pixels, then the mean of the ratios around it. So a
    person or a shadow on less than half of the picture does not count.

    Args:
        frame: (H, W, 3).
        background: (H, W, 3) grey levels.

    Returns:
        (3,) factors, at least LEAST_LIGHT; 1 where the background is too dark to tell.
    """
    height, width = frame.shape[:2]
    stride = max(1, int(np.sqrt(height * width / GAIN_SAMPLES)))
    bins, unit = 600, 300
    seen = np.zeros((3, bins), np.float32)
    due = np.zeros((3, bins), np.float32)
    for y in range(stride // 2, height, stride):
        for x in range(stride // 2, width, stride):
            for c in range(3):
                given, asked = np.float32(frame[y, x, c]), background[y, x, c]
                at = int(given / max(asked, np.float32(1)) * unit)
                # a saturated pixel may be brighter than it shows; one that was saturated already
                # counts
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
    return np.maximum(gain, LEAST_LIGHT)


def even_light(frames: Sequence[Image]) -> Floats:
    """All frames normalised to the light of their median: (n, H, W, 3) grey levels."""
    middle = median(frames)
    height, width = middle.shape[:2]
    # long rows divide five times as fast as triples do
    rows = [
        frame.reshape(height, -1) / np.tile(light_gain(frame, middle), width) for frame in frames
    ]
    return np.asarray(np.stack(rows).reshape(-1, height, width, 3), np.float32)


def spread_of(squares: Floats, count: int) -> Floats:
    """Standard deviation of brightness and colour, (H, W, 2), from sums of that many squares."""
    if count == 1:
        return np.full(squares.shape, np.hypot(SENSOR_NOISE, FLOOR), np.float32)
    pooled = squares / np.float32(count - 1)
    return np.asarray(np.sqrt(cv2.blur(pooled, (5, 5)) + np.square(FLOOR)), np.float32)


def large_regions(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Regions at least as tall as an arm's stroke, 0.1 of the picture; a counter in a corner is
    smaller."""
    closed = cv2.morphologyEx(mask.view(np.uint8), cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
    contours, tree = cv2.findContours(closed, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    low = [
        contour
        for number, contour in enumerate(contours)
        if tree[0, number, 3] < 0 and cv2.boundingRect(contour)[3] < 0.1 * mask.shape[0]
    ]
    cv2.drawContours(closed, low, -1, 0, cv2.FILLED)
    return np.asarray(closed, np.uint8)


def slopes(luma: Floats) -> Floats:
    """Gradient of the brightness at every pixel, (H, W)."""
    across = cv2.Sobel(luma, cv2.CV_32F, 1, 0)
    down = cv2.Sobel(luma, cv2.CV_32F, 0, 1)
    return cv2.magnitude(across, down)
