"""Our own source of landmarks: a small network that looks at the working picture."""

import math
from operator import attrgetter
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, TILTED_DEG, Vector, lean_deg
from common.body.observation import Landmarks
from common.raster.similarity import Mask
from common.video.pictures import Image
from viewer.landmarks.landmark_looks import SHIPPED
from viewer.landmarks.landmark_network import find
from viewer.landmarks.landmark_window import (
    Places,
    Window,
    planes_of,
    same_place,
    turned_window_of,
    whole,
    window_about,
    window_of,
)
from viewer.landmarks.person_mask import LandmarkResult, PersonMask
from viewer.silhouette.silhouette import Seen

SURE: Final = 0.5
"""Landmarks that are surer than this on average are not looked for elsewhere too."""
LEAST: Final = 0.3
"""Where no silhouette says that a person is there, they must be surer than this on average."""
EMPTY: Final = 0.08
"""Who is not sure, and so probably no person, is no person, silhouette or not: in rooms whose
doors, lights and things move, 0.1 % of silhouettes with a person made up are, and 88 % of those
with no person."""
TURNED: Final = 0.2
"""A person of whom nothing is known, and who is less sure than this on average, is looked at in
windows turned by quarters too: photographs seldom show people upside down."""
QUARTERS_DEG: Final = (90.0, 180.0, 270.0)
COUNTS: Final = 0.15
"""Confidence from which a joint counts for the place of the next window."""
MARGIN: Final = 0.06
"""How far a body reaches beyond its joints, in sides of what holds them."""
SHORT: Final = 0.1
"""A trunk shorter than this, in the longer side of what holds the joints, points to or from the
camera."""
_PELVIS, _NECK = JOINT_NAMES.index("pelvis"), JOINT_NAMES.index("neck")


class LandmarkModel(NamedTuple):
    """How a picture is looked at."""

    network: Path = SHIPPED
    twice: bool = False
    """In the mirror too."""


TWICE: Final = LandmarkModel(twice=True)
"""How single pictures are looked at, of which nothing is known."""


class _Look(NamedTuple):
    mask: Mask | None
    window: Window
    joints_px: Places
    confidence: Vector
    facing: tuple[float, float]
    """Degrees, and how sure."""
    nobody: float
    second_px: Places
    second_confidence: Vector
    person: NDArray[np.float32]
    """(CELLS, CELLS) logits that a cell of the window shows the person."""

    @property
    def surety(self) -> float:
        return float(self.confidence.mean())


SUREST: Final = attrgetter("surety")


def own_landmarks(
    picture: Image,
    seen: Seen,
    before: Landmarks | None,
    eye: LandmarkModel = LandmarkModel(),
    *,
    crowded: bool = False,
) -> LandmarkResult:
    """What the network makes of the person with a silhouette, or of one known from before.

    It looks where the silhouette is, in a window as upright as the trunk was in the frame before.
    Where it is not sure there, or saw a person elsewhere the frame before, it also looks there,
    without the silhouette. A silhouette shows
    what changed: it lacks legs that stay where they are, and so does the window about it. One that
    is a guess is not asked where a person is known: wrong ones mislead the network. A trunk
    that leans in its window is looked at again, upright: photographs taught the network such. Of
    synthetic people who lean by 60 to 180 degrees 60 % of the joints are within a tenth of the
    stature as they are, 74 % looked at again, 80 % once the lean is known, and the facing about the
    trunk is less than 45 degrees off in 97 % of those who are seen from a side. The surest look is
    believed; where that shows no person, but a silhouette, of a door or of light, confidences are
    0.

    Args:
        picture: (H, W, 3) the working picture.
        seen: The silhouette in it.
        before: Of the frame before.
        eye: Which network looks, and how often.
        crowded: Other people are known, and a silhouette elsewhere may be theirs: where the person
            was, a look that shows one counts, however sure the other is.
    """
    known = None if before is None else window_of_joints(before)
    if seen.is_guess and known is not None:
        seen = seen._replace(box=None)
    first = _surest(picture, seen, known, eye, crowded)
    if first is None:
        return LandmarkResult(None)
    best = _set_upright(picture, first, eye)
    if seen.box is None and (best.nobody > 0.5 or best.surety < LEAST):
        return LandmarkResult(None)
    if best.surety < SURE and best.nobody > EMPTY:
        best = best._replace(confidence=np.zeros_like(best.confidence), facing=(0.0, 0.0))
    return LandmarkResult(_told(best), PersonMask(best.person, best.window))


def look_in(picture: Image, window: Window, eye: LandmarkModel = LandmarkModel()) -> LandmarkResult:
    """What the network makes of the person in a window, without a silhouette.

    Args:
        picture: (H, W, 3)
        window: Of the picture.
        eye: Which network looks, and how often.
    """
    best = _set_upright(picture, _look(picture, None, window, eye), eye)
    if best.nobody > 0.5 or best.surety < LEAST:
        return LandmarkResult(None)
    return LandmarkResult(_told(best), PersonMask(best.person, best.window))


def window_of_joints(landmarks: Landmarks) -> Window | None:
    """The window about joints, as upright as the trunk; None where too few are sure."""
    return _about(np.array(landmarks.joints_px), landmarks.confidence)


def found_anywhere(picture: Image, eye: LandmarkModel = TWICE) -> tuple[Landmarks, float]:
    """A person in a picture (H, W, 3) of which nothing is known, and how probably no person is."""
    best = _set_upright(picture, _any_way_up(picture, _anywhere(picture, eye), eye), eye)
    return _told(best), best.nobody


def found_between(
    picture: Image, corners_px: Places, margin: float, eye: LandmarkModel = TWICE
) -> tuple[Landmarks, float]:
    """A person in a picture whose joints lie about between two corners, and how probably no person
    is.

    Args:
        picture: (H, W, 3)
        corners_px: (2, 2)
        margin: How far the body reaches beyond them, in their longer distance.
        eye: Which network looks, and how often.
    """
    look = _look(picture, None, window_about(corners_px, margin=margin), eye)
    best = _set_upright(picture, _any_way_up(picture, look, eye), eye)
    return _told(best), best.nobody


def _told(best: _Look) -> Landmarks:
    return Landmarks(
        joints_px=tuple((float(x), float(y)) for x, y in best.joints_px),
        confidence=tuple(best.confidence.tolist()),
        facing_deg=best.facing[0],
        facing_confidence=best.facing[1],
        second_px=tuple((float(x), float(y)) for x, y in best.second_px),
        second_confidence=tuple(best.second_confidence.tolist()),
    )


def _surest(
    picture: Image, seen: Seen, known: Window | None, eye: LandmarkModel, crowded: bool
) -> _Look | None:
    """The surest look, the first of them where that is sure; None where there is no window.

    Args:
        picture: (H, W, 3)
        seen: The silhouette in it.
        known: About where a person was the frame before.
        eye: How it is looked at.
        crowded: As in `own_landmarks`.
    """
    looks = []
    turn_deg = 0.0 if known is None else known.turn_deg
    if seen.box is not None:
        window = turned_window_of(seen.mask, turn_deg) if turn_deg else window_of(seen.box)
        looks.append(_look(picture, seen.mask, window, eye))
    is_elsewhere = known is not None and bool(looks) and not same_place(looks[0].window, known)
    if known is not None and (not looks or looks[0].surety < SURE or is_elsewhere):
        looks.append(_look(picture, None, known, eye))
        if crowded and is_elsewhere and looks[-1].surety >= LEAST:
            return looks[-1]
    best = max(looks, key=SUREST, default=None)
    if best is None or seen.box is None or not turn_deg or best.surety >= SURE:
        return best
    return max(best, _look(picture, seen.mask, window_of(seen.box), eye), key=SUREST)


def _anywhere(picture: Image, eye: LandmarkModel) -> _Look:
    """A person anywhere: first in all of the picture, then closer."""
    found = _look(picture, None, whole(picture.shape), eye)
    window = _about(found.joints_px, tuple(found.confidence))
    return found if window is None else _look(picture, None, window, eye)


def _any_way_up(picture: Image, look: _Look, eye: LandmarkModel) -> _Look:
    """A look, or where that is unsure the surest of it and of those in turned windows."""
    if look.surety >= TURNED:
        return look
    turns_deg = (look.window.turn_deg + quarter_deg for quarter_deg in QUARTERS_DEG)
    windows = (look.window._replace(turn_deg=turn_deg) for turn_deg in turns_deg)
    return max(look, *(_look(picture, look.mask, each, eye) for each in windows), key=SUREST)


def _set_upright(picture: Image, look: _Look, eye: LandmarkModel) -> _Look:
    """A look, or a surer one in a window that is turned as the trunk leans there."""
    window = _about(look.joints_px, tuple(look.confidence))
    if window is None or not _is_turned(window.turn_deg - look.window.turn_deg):
        return look
    if look.mask is not None:
        window = turned_window_of(look.mask, window.turn_deg)
    return max(look, _look(picture, look.mask, window, eye), key=SUREST)


def _look(picture: Image, mask: Mask | None, window: Window, eye: LandmarkModel) -> _Look:
    found = find(planes_of(picture, mask, window), *eye)
    joints_px, second_px = map(window.in_picture, (found.joints, found.second))
    facing, second = (found.facing_deg, found.facing_confidence), found.second_confidence
    sure, nobody = found.confidence, found.nobody
    return _Look(mask, window, joints_px, sure, facing, nobody, second_px, second, found.mask)


def _about(joints_px: Places, confidence: tuple[float, ...]) -> Window | None:
    """The window about the joints that count, as upright as the trunk; None where they are few."""
    counts = np.array(confidence) > COUNTS
    if counts.sum() < len(joints_px) // 2:
        return None
    sure = joints_px[counts]
    turn_deg = _turn_deg(joints_px, sure) if counts[_PELVIS] and counts[_NECK] else 0.0
    return window_about(sure, turn_deg, MARGIN)


def _turn_deg(joints_px: Places, sure: Places) -> float:
    """How far a trunk leans, clockwise; 0 where it is little, or not known.

    Args:
        joints_px: (15, 2)
        sure: (n, 2) those that count.
    """
    across, down = (joints_px[_NECK] - joints_px[_PELVIS]).tolist()
    if math.hypot(across, down) < SHORT * float((sure.max(axis=0) - sure.min(axis=0)).max()):
        return 0.0
    return lean_deg(across, down)


def _is_turned(turn_deg: float) -> bool:
    """Whether a turn, of whatever full circles, is by more than an upright trunk leans."""
    return math.cos(math.radians(turn_deg)) < math.cos(math.radians(TILTED_DEG))
