"""The background of a busy clip: what no person hides, and a fill where it is never uncovered
(3.1.2)."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.raster.similarity import Mask
from common.video.pictures import Image
from viewer.background.background import Background, estimated, even_light, spread_of
from viewer.background.image_stack import CHANGES, LUMA, Floats, median, squares
from viewer.background.median_people import occupied

GUESSED: Final = 4.0
"""Spread of a pixel whose background was guessed, grey levels."""
SEGMENT_SCALE: Final = 300.0
SEGMENT_SIGMA: Final = 0.8
LEAST_SEGMENT_PX: Final = 20
"""Felzenszwalb and Huttenlocher's own values for pictures of this size (T7)."""
MOST_HIDDEN: Final = 0.25
"""Largest share of a picture that one standing person hides; several moving people hide more."""
OUTSIDE: Final = 0.5
"""Share of a segment outside the people's places from which on the segment is background."""
AT_EDGE_PX: Final = 8
"""Pixels of a segment on the picture's border, outside the people's places, from which on it is
background."""
INSIDE: Final = 0.3
"""Share of another segment inside the people's places from which on it belongs to the person:
legs that stand still."""
SHOWN: Final = 0.1
"""Share of the frames below which a colour in them may be clothes of the wall's brightness."""
LEAST_SHOWN: Final = 2
"""Fewest frames that show a pixel."""
ALIKE: Final = 2.5
"""Spreads of a segment's colour within which one of its pixels is background too."""


class NoSegments(RuntimeError):
    """The segmentation library is missing: the text names the cure."""


def learn_uncovered(frames: Sequence[Image]) -> Background:
    """The background from pictures in which a person may always be in view.

    What does not change is background, unless a person hides it. A place hides a person in the
    median picture where its changes stay in place, and where the contours of its changes belong to
    the median as much as to the frames. There the median is believed only in segments of one colour
    that reach beyond the place. The rest is interpolated from both sides, and replaced by what
    frames show if enough of them resemble that; otherwise the pixel was never uncovered and is
    flagged.

    Args:
        frames: Pictures from the whole clip, of one size.

    Raises:
        ValueError: When there is no frame.
        NoSegments: When scikit-image is not installed.

    Source: Demir 2006, section 3.1.2 (T7). The print takes everything constant for background,
    including a person who never moves; hidden places are our addition.
    """
    if not frames:
        raise ValueError("a background needs at least 1 frame, got 0")
    even = even_light(frames)
    centre = median(even)
    away = np.abs(even - centre).max(axis=3)
    labels = segments(centre)
    for stays in (True, False):
        held = _held(centre, labels, occupied(even, centre, away, stays))
        background, uncertain = _filled(even, centre, held)
        if uncertain.mean() <= MOST_HIDDEN:
            break
    return estimated_of(even - centre, away, background, held, uncertain)


def learn_around(frames: Sequence[Image], covered: Sequence[NDArray[np.uint8]]) -> Background:
    """The background from pictures in which a person's places are known.

    A pixel takes the frames in which no person is near it; where there are none, it is interpolated
    from both sides.

    Args:
        frames: Pictures from the whole clip, of one size.
        covered: For each (H, W), 1 where a person may be.
    """
    even, hidden = even_light(frames), np.stack(covered) > 0
    shown = np.count_nonzero(~hidden, axis=0)
    centre = _shown_median(even, hidden, shown)
    held = shown < LEAST_SHOWN
    away = np.abs(even - centre).max(axis=3)
    away[hidden] = np.inf
    return estimated_of(even - centre, away, bridged(centre, held), held, held)


def _shown_median(even: Floats, hidden: Mask, shown: NDArray[np.int64]) -> Floats:
    """(H, W, 3) the median of the frames that show a pixel; of all frames where none does."""
    centre = median(even)
    some = hidden.any(axis=0) & (shown > 0)
    values = np.where(hidden[:, some][..., None], np.inf, even[:, some])
    ranked = np.sort(values, axis=0)
    lower, upper = (
        np.take_along_axis(ranked, middle[None, :, None], axis=0)[0]
        for middle in ((shown[some] - 1) // 2, shown[some] // 2)
    )
    centre[some] = (lower + upper) / 2
    return centre


def estimated_of(
    off: Floats, away: Floats, background: Floats, held: Mask, uncertain: Mask
) -> Background:
    """A background with the deviation of frames from its centre where no person changes them."""
    calm = np.where((away < CHANGES)[..., None], off, 0.0).astype(np.float32)
    spread = spread_of(squares(calm), len(off))
    if held.any() and not held.all():
        spread[held] = np.median(spread[~held], axis=0)
    spread[uncertain] = np.maximum(spread[uncertain], GUESSED)
    return estimated(background, spread, uncertain)


def _filled(even: Floats, centre: Floats, held: Mask) -> tuple[Floats, Mask]:
    """The background (H, W, 3) with hidden places filled, and where hardly a frame shows them."""
    guess = bridged(centre, held)
    near = np.abs((even - guess) @ LUMA) < CHANGES
    shown = near.sum(axis=0)
    mean = (even * near[..., None]).sum(axis=0) / np.maximum(shown, 1)[..., None]
    uncertain = held & (shown < SHOWN * len(even))
    background = np.where(held[..., None], np.where(uncertain[..., None], guess, mean), centre)
    return background.astype(np.float32), uncertain


def segments(picture: Floats) -> NDArray[np.int64]:
    """Segments of one colour, (H, W) numbers from 0, by Felzenszwalb and Huttenlocher.

    Raises:
        NoSegments: When scikit-image is not installed.
    """
    try:
        from skimage.segmentation import felzenszwalb
    except ImportError as error:
        raise NoSegments(
            "the background of a busy clip needs scikit-image: pip install 'tritrack[single]', or "
            "name an empty picture with cameras.cam1.background, of `tritrack single` with "
            "--background"
        ) from error
    return np.asarray(
        felzenszwalb(
            picture.clip(0, 255) / 255,
            scale=SEGMENT_SCALE,
            sigma=SEGMENT_SIGMA,
            min_size=LEAST_SEGMENT_PX,
            channel_axis=2,
        )
    )


def _held(centre: Floats, labels: NDArray[np.int64], hull: Mask) -> Mask:
    """(H, W) True where the median picture may show a person."""
    inside = np.bincount(labels.ravel(), hull.ravel()) / np.bincount(labels.ravel())
    edge = np.ones_like(hull)
    edge[1:-1, 1:-1] = False
    at_edge = np.bincount(labels[edge & ~hull], minlength=len(inside)) >= AT_EDGE_PX
    reaches_out = at_edge | (inside < 1 - OUTSIDE)
    background = reaches_out[labels] & _alike(centre, labels, ~hull)
    return np.asarray((hull & ~background) | (~reaches_out & (inside > INSIDE))[labels])


def _alike(centre: Floats, labels: NDArray[np.int64], where: Mask) -> Mask:
    """(H, W) True where a pixel has the colour that its segment has in `where`."""
    count = np.maximum(np.bincount(labels.ravel(), where.ravel()), 1)
    off = np.zeros(labels.shape)
    for c in range(3):
        own = centre[..., c].astype(np.float64)
        mean = np.bincount(labels.ravel(), (own * where).ravel()) / count
        square = np.bincount(labels.ravel(), (own**2 * where).ravel()) / count
        spread = np.sqrt(np.maximum(square - mean**2, 0)) * ALIKE + CHANGES
        off = np.maximum(off, np.abs(own - mean[labels]) / spread[labels])
    return np.asarray(off < 1)


def bridged(picture: Floats, held: Mask) -> Floats:
    """The picture with the hidden stretch of every row interpolated from its two ends."""
    out = picture.copy()
    columns = np.arange(picture.shape[1])
    for y in np.flatnonzero(held.any(axis=1) & ~held.all(axis=1)):
        known = ~held[y]
        for c in range(3):
            out[y, held[y], c] = np.interp(columns[held[y]], columns[known], picture[y, known, c])
    return out
