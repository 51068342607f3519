"""Our own source of landmarks: a small network that looks at the working picture."""

from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.bus.messages import Landmarks
from common.raster.similarity import Mask
from common.video.decoding import Image
from viewer.landmarks.landmark_looks import SHIPPED
from viewer.landmarks.landmark_network import find
from viewer.landmarks.landmark_window import SIDE, Window, planes_of, whole, window_about, window_of
from viewer.silhouette.silhouette import Seen

SURE: Final = 0.5
"""Landmarks that are surer than this on average are not looked for elsewhere too."""
LEAST: Final = 0.3
"""Where no outline says that somebody is there, they must be surer than this on average."""
EMPTY: Final = 0.08
"""Who is not sure, and so probably nobody, is nobody, outline or not: in rooms whose doors, lights
and things move, 0.1 % of outlines with somebody made up are, and 88 % of those with nobody."""
COUNTS: Final = 0.15
"""Joints that are surer than this tell where the next window is."""
MARGIN: Final = 0.06
"""How far a body reaches beyond its joints, in sides of what holds them."""


class Eye(NamedTuple):
    """How a picture is looked at."""

    network: Path = SHIPPED
    twice: bool = False
    """In the mirror too."""


TWICE: Final = Eye(twice=True)
"""How single pictures are looked at, of which nothing is known."""


class _Look(NamedTuple):
    joints_px: NDArray[np.float64]
    confidence: Vector
    facing: tuple[float, float]
    """Degrees, and how sure."""
    nobody: float
    second_px: NDArray[np.float64]
    second_confidence: Vector

    @property
    def surety(self) -> float:
        return float(self.confidence.mean())


def own_landmarks(
    picture: Image, seen: Seen, before: Landmarks | None, eye: Eye = Eye()
) -> Landmarks | None:
    """What the network makes of a picture; None where it sees nobody.

    It looks where the outline is. Where it is not sure there it also looks, without the outline,
    where it saw somebody the frame before, or in all of the picture, and believes the surest look.
    Where that shows nobody, but an outline, of a door or of light, confidences are 0.

    Args:
        picture: (H, W, 3) the working picture.
        seen: The outline in it.
        before: Of the frame before.
        eye: Which network looks, and how often.
    """
    looks = []
    if seen.box is not None:
        looks.append(_look(picture, seen.mask, window_of(seen.box), eye))
    if not looks or looks[0].surety < SURE:
        known = None if before is None else _about(np.array(before.joints_px), before.confidence)
        if known is None:
            looks.append(_search(picture, eye))
        else:
            looks.append(_look(picture, None, known, eye))
    best = max(looks, key=lambda look: look.surety)
    if seen.box is None and (best.nobody > 0.5 or best.surety < LEAST):
        return None
    if best.surety < SURE and best.nobody > EMPTY:
        best = best._replace(confidence=np.zeros_like(best.confidence), facing=(0.0, 0.0))
    return _told(best)


def found_anywhere(picture: Image) -> tuple[Landmarks, float]:
    """Somebody in a picture (H, W, 3) of which nothing is known, and how probably nobody is."""
    best = _search(picture, TWICE)
    return _told(best), best.nobody


def found_between(
    picture: Image, low_px: Vector, high_px: Vector, margin: float
) -> tuple[Landmarks, float]:
    """Somebody in a picture whose joints lie about between two corners, and how probably nobody is.

    Args:
        picture: (H, W, 3)
        low_px: (2,) likewise `high_px`.
        margin: How far the body reaches beyond them, in their longer distance.
    """
    look = _look(picture, None, _between(low_px, high_px, margin), TWICE)
    return _told(look), look.nobody


def _told(best: _Look) -> Landmarks:
    return Landmarks(
        joints_px=tuple((float(x), float(y)) for x, y in best.joints_px),
        confidence=tuple(best.confidence.tolist()),
        facing_deg=best.facing[0],
        facing_confidence=best.facing[1],
        second_px=tuple((float(x), float(y)) for x, y in best.second_px),
        second_confidence=tuple(best.second_confidence.tolist()),
    )


def _look(picture: Image, mask: Mask | None, window: Window, eye: Eye) -> _Look:
    found = find(planes_of(picture, mask, window), *eye)
    joints_px, second_px = (
        places * (window.side / SIDE) + (window.left, window.top)
        for places in (found.joints, found.second)
    )
    facing = (found.facing_deg, found.facing_confidence)
    second = found.second_confidence
    return _Look(joints_px, found.confidence, facing, found.nobody, second_px, second)


def _search(picture: Image, eye: Eye) -> _Look:
    """Somebody anywhere: first in all of the picture, then closer."""
    far = _look(picture, None, whole(picture.shape), eye)
    window = _about(far.joints_px, tuple(far.confidence))
    return far if window is None else _look(picture, None, window, eye)


def _about(joints_px: NDArray[np.float64], confidence: tuple[float, ...]) -> Window | None:
    """The window about the joints that count; None where they are few."""
    sure = joints_px[np.array(confidence) > COUNTS]
    if len(sure) < len(joints_px) // 2:
        return None
    return _between(sure.min(axis=0), sure.max(axis=0), MARGIN)


def _between(low: Vector, high: Vector, margin: float) -> Window:
    """The window about joints between two corners."""
    beyond = margin * float((high - low).max())
    (left, top), (right, bottom) = low - beyond, high + beyond
    return window_about(left, right, top, bottom)
