"""Detection of a camera that is moved during a run, by its background; the person does not
count."""

from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.rig.turned_camera import shift_of
from common.rig.upright import Shift
from common.video.pictures import Image
from viewer.background.background import Background
from viewer.background.turned_picture import Lens, rays_of, seen_at, turn_between

LOOK_EVERY: Final = 4
"""Frames between two searches: 0.3 s at 15 Hz."""
AGAIN: Final = 2
"""Number of successive searches that must agree: then the camera stands still again."""
CORNERS, FEWEST = 80, 16
"""Number of background marks that are chosen, and the fewest that suffice."""
APART: Final = 0.05
"""Least distance between two marks, heights of the picture."""
PATCH: Final = 13
"""Side of the patch that is compared around a mark, pixels."""
EVEN: Final = 21
"""Side of the local means that are subtracted to remove the light, pixels."""
ALIKE: Final = 0.85
"""Correlation of patches above which a mark has not moved; half of the marks must reach it."""
FOUND: Final = 0.5
"""Least share of the marks in the picture that one turn must explain for the camera to count as
moved."""
CLOSE_PX: Final = 1.5
"""Distance from the predicted place within which a mark counts as found, pixels."""
LEAST_PX: Final = 1.2
"""Shift from which on a camera is reported as moved, pixels: 0.3 degrees of a lens of 44 degrees
at 160 pixels."""


class State(NamedTuple):
    """The first background, and how the camera has turned since."""

    lens: Lens
    first: Background
    even: NDArray[np.uint8]
    """(H, W) its brightness without the light."""
    marks_px: NDArray[np.float32]
    """(n, 2) corners in it: the marks."""
    turn: Vector
    """(3, 3) rotation of the scene since then, in the camera's axes."""
    begun: Vector
    """(3, 3) the same rotation when this background was learnt: the camera may have been turned
    before."""
    waited: int = 0
    """Frames since the last search."""
    found: Vector | None = None
    """The rotation that the last search found, where it differs."""
    looks: int = 0
    """Number of successive searches that found it."""

    @property
    def shift(self) -> Shift | None:
        """Shift of the picture since the start of the run; None: none."""
        turned = self.turn @ self.begun
        if np.array_equal(turned, np.eye(3)):
            return None
        told = shift_of(turned, self.lens.focal_px)
        far = max(abs(told.right_px), abs(told.down_px), abs(np.radians(told.roll_deg)) * 50.0)
        return told if far >= LEAST_PX / 2 else None


def init(background: Background, lens: Lens, begun: Vector | None = None) -> State:
    """The state of a camera that stands still.

    Args:
        background: The learnt background.
        lens: The camera's lens.
        begun: Rotation of the camera before that; None: none.
    """
    even = even_of(np.asarray(np.rint(background.centre), np.uint8))
    near = cv2.dilate(background.uncertain.view(np.uint8), np.ones((PATCH, PATCH), np.uint8))
    known = np.where(near > 0, np.uint8(0), np.uint8(255))
    apart_px = APART * even.shape[0]
    marks = cv2.goodFeaturesToTrack(even, CORNERS, 0.02, apart_px, mask=known, blockSize=5)
    marks_px = np.zeros((0, 2), np.float32) if marks is None else marks[:, 0]
    return State(lens, background, even, marks_px, np.eye(3), np.eye(3) if begun is None else begun)


def step(state: State, frame: Image) -> tuple[State, bool]:
    """Process a frame (H, W, 3); True where the camera's pose changes now."""
    if len(state.marks_px) < FEWEST or state.waited + 1 < LOOK_EVERY:
        return state._replace(waited=state.waited + 1), False
    state = state._replace(waited=0)
    even = even_of(frame)
    if _is_where_it_was(state, even):
        return state._replace(found=None, looks=0), False
    found = _found(state, even)
    if found is None or _apart_px(state, found, state.turn) < LEAST_PX:
        return state._replace(found=None, looks=0), False
    same = state.found is not None and _apart_px(state, found, state.found) < LEAST_PX
    looks = state.looks + 1 if same else 1
    if looks < AGAIN:
        return state._replace(found=found, looks=looks), False
    return state._replace(turn=found, found=None, looks=0), True


def even_of(picture: Image) -> NDArray[np.uint8]:
    """(H, W) brightness about 128, without light that varies slowly over the picture."""
    grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
    return np.asarray(cv2.addWeighted(grey, 1.0, cv2.blur(grey, (EVEN, EVEN)), -1.0, 128.0))


def _is_where_it_was(state: State, even: NDArray[np.uint8]) -> bool:
    """Whether most marks are found at the camera's assumed pose."""
    expected = seen_at(state.lens, state.turn, state.marks_px)
    inside = _inside(expected, even.shape, PATCH // 2 + 1)
    if inside.sum() < FEWEST:
        return True
    alike = _alike(state.even, state.marks_px[inside], even, expected[inside])
    return float(np.median(alike)) >= ALIKE


def _found(state: State, even: NDArray[np.uint8]) -> Vector | None:
    """The rotation by which most marks are found again; None where there is none."""
    window = cv2.createHanningWindow(even.shape[::-1], cv2.CV_32F)
    one, other = (each.astype(np.float32) - 128.0 for each in (state.even, even))
    coarse, _ = cv2.phaseCorrelate(one, other, window)
    starts = [
        state.marks_px + np.array(way, np.float32)
        for way in (coarse, _middle_shift(state.even, even))
    ]
    starts.append(seen_at(state.lens, state.turn, state.marks_px).astype(np.float32))
    best: tuple[float, Vector | None] = (FOUND, None)
    for start in starts:
        share, turn = _turn_from(state, even, start)
        if share >= best[0]:
            best = (share, turn)
    return best[1]


def _middle_shift(first: NDArray[np.uint8], now: NDArray[np.uint8]) -> tuple[float, float]:
    """Place in another picture of one picture's middle, from its place there."""
    high, wide = (side // 5 for side in first.shape)
    middle = first[high : first.shape[0] - high, wide : first.shape[1] - wide]
    scores = cv2.matchTemplate(now, np.ascontiguousarray(middle), cv2.TM_CCOEFF_NORMED)
    x, y = cv2.minMaxLoc(scores)[3]
    return float(x - wide), float(y - high)


def _turn_from(
    state: State, even: NDArray[np.uint8], start_px: NDArray[np.float32]
) -> tuple[float, Vector]:
    """The share of the visible marks that one rotation explains, and that rotation."""
    now, status, _ = cv2.calcOpticalFlowPyrLK(
        state.even,
        even,
        state.marks_px,
        start_px.copy(),
        winSize=(15, 15),
        maxLevel=2,
        flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )
    kept = (status[:, 0] > 0) & _inside(now, even.shape, 1)
    if kept.sum() < FEWEST // 2:
        return 0.0, state.turn
    rays = (rays_of(state.lens, state.marks_px[kept]), rays_of(state.lens, now[kept]))
    turn = turn_between(*rays, CLOSE_PX / float(state.lens.focal_px[0]))
    due = seen_at(state.lens, turn, state.marks_px)
    close = kept & (np.linalg.norm(due - now, axis=1) < CLOSE_PX)
    shown = _inside(due, even.shape, PATCH // 2)
    return float(close.sum() / max(shown.sum(), FEWEST)), turn


def _apart_px(state: State, one: Vector, other: Vector) -> float:
    """Typical distance of the marks under two rotations."""
    places = [seen_at(state.lens, turn, state.marks_px) for turn in (one, other)]
    return float(np.median(np.linalg.norm(places[0] - places[1], axis=1)))


def _inside(
    places_px: NDArray[np.float64], shape: tuple[int, ...], margin: int
) -> NDArray[np.bool_]:
    high, wide = shape[:2]
    limit = (wide - margin, high - margin)
    return np.asarray(((places_px >= margin) & (places_px < limit)).all(axis=1))


def _alike(
    first: NDArray[np.uint8],
    at_px: NDArray[np.float32],
    now: NDArray[np.uint8],
    there_px: NDArray[np.float64],
) -> Vector:
    """(n,) correlation of patches around places in two pictures."""
    patches = []
    for picture, places in ((first, at_px), (now, there_px)):
        reach = np.arange(PATCH) - PATCH // 2
        columns = np.rint(places[:, 0]).astype(int)[:, None, None] + reach
        rows = np.rint(places[:, 1]).astype(int)[:, None, None] + reach[:, None]
        high, wide = picture.shape
        seen = picture[np.clip(rows, 0, high - 1), np.clip(columns, 0, wide - 1)].astype(np.float32)
        patches.append(seen.reshape(len(places), -1) - seen.mean(axis=(1, 2))[:, None])
    one, other = patches
    size = np.sqrt((one**2).sum(axis=1) * (other**2).sum(axis=1))
    return np.asarray((one * other).sum(axis=1) / np.maximum(size, 1.0), float)
