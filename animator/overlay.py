"""The overlay: picture, silhouette and stick body, and beside them the lifted body from the
side."""

import math
from functools import lru_cache
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from animator.scene import LEFT, RIGHT, TRUNK, UNSURE, Colour
from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS, Vector
from common.video.pictures import Image

SHOWN: Final = (640, 480)
"""Largest size of a picture in the overlay, pixels: more shows no more."""
LEAST_HEIGHT_PX: Final = 360
"""Smallest height, pixels: smaller pictures are enlarged by a whole number, as a stick would
hide an arm at 160x120."""
SIDE_SHARE: Final = 0.7
"""Width of the view from the side over its height: arms reach 0.8 m to the front and back."""
TALL_M: Final = 2.3
"""Height of the space in the view from the side, metres: a raised hand fits."""
BELOW_M: Final = 0.12
"""Part of it below the floor."""
SEEN: Final = (124, 200, 90)
TINT: Final = 0.30
"""Opacity of SEEN over the silhouette."""
PAPER: Final = (248, 247, 246)
INK: Final = (120, 110, 100)

_AT: Final = {name: i for i, name in enumerate(JOINT_NAMES)}


class Stroke(NamedTuple):
    """Width of the stick body's lines."""

    near: int
    far: int
    colour: Colour
    thick: float
    """Half width over the body's height."""


def _colour(name: str) -> Colour:
    return {"l": LEFT, "r": RIGHT}[name[0]] if name[1] == "_" else TRUNK


_THICK: Final = {"torso": 0.05, "head": 0.045, "arm": 0.018, "leg": 0.026}
STROKES: Final = (
    *(
        Stroke(int(near), int(far), _colour(limb), _THICK[limb.rpartition("_")[2]])
        for limb, (near, far) in zip(LIMBS, LIMB_ENDS, strict=True)
    ),
    Stroke(_AT["l_shoulder"], _AT["r_shoulder"], TRUNK, 0.02),
    Stroke(_AT["l_hip"], _AT["r_hip"], TRUNK, 0.03),
)
"""The lines: limbs in the order of LIMBS, then the lines across shoulders and hips."""


def overlay(
    picture: Image,
    silhouette: NDArray[np.bool_] | None,
    joints_px: Vector,
    joints_m: Vector,
    confidence: Vector,
    caption: str = "",
) -> Image:
    """One frame of the overlay video; frames of one picture size have one size.

    Args:
        picture: The video's frame.
        silhouette: Of any size, scaled to the picture; None: not shown.
        joints_px: (15, 2) in the picture's own pixels, NaN where there is no pose.
        joints_m: (15, 3): x to the right of the picture, y up from the floor, z to the camera.
        confidence: (15,): less sure joints are paler.
        caption: Text beside the picture.
    """
    times = math.ceil(LEAST_HEIGHT_PX / picture.shape[0])
    # encoders require even numbers of rows and columns
    size = (picture.shape[1] * times // 2 * 2, picture.shape[0] * times // 2 * 2)
    left = cv2.resize(picture, None, fx=times, fy=times, interpolation=cv2.INTER_LINEAR)
    left = np.ascontiguousarray(left[: size[1], : size[0]])
    if silhouette is not None:
        _tint(left, silhouette)
    draw_stick(left, joints_px * times, confidence)
    both: Image = np.hstack([left, side_view(joints_m, confidence, size[1], caption)])
    return both


def draw_stick(image: Image, joints_px: Vector, confidence: Vector) -> None:
    """Draw the stick body into an image, (15, 2) in its pixels; nothing without a pose."""
    if not np.isfinite(joints_px).all():
        return
    unit = max(1, round(image.shape[0] / 240))
    for stroke in STROKES:
        near, far = _corner(joints_px[stroke.near]), _corner(joints_px[stroke.far])
        cv2.line(image, near, far, (255, 255, 255), 3 * unit, cv2.LINE_AA)
        cv2.line(image, near, far, _paint(stroke, confidence), 2 * unit, cv2.LINE_AA)
    for i, name in enumerate(JOINT_NAMES):
        colour = LEFT if name[0] == "l" else RIGHT if name[0] == "r" else TRUNK
        cv2.circle(image, _corner(joints_px[i]), 2 * unit, (255, 255, 255), -1, cv2.LINE_AA)
        cv2.circle(image, _corner(joints_px[i]), 2 * unit, colour[::-1], unit, cv2.LINE_AA)


def side_view(joints_m: Vector, confidence: Vector, height_px: int, caption: str = "") -> Image:
    """The body seen from the right of the camera, which is at the left of this view."""
    view = _stage(height_px).copy()
    cv2.putText(view, caption, (8, 36), cv2.FONT_HERSHEY_SIMPLEX, 0.45, INK, 1, cv2.LINE_AA)
    height_px, width_px = view.shape[:2]
    px = height_px / TALL_M
    if np.isfinite(joints_m).all():
        across_m = joints_m[:, 2] - joints_m[_AT["pelvis"], 2]
        flat = np.stack(
            [width_px / 2 - px * across_m, _floor_px(height_px) - px * _above_floor_m(joints_m)],
            axis=1,
        )
        tall_px = px * max(0.5, float(np.ptp(joints_m[:, 1])))
        nearest_last = sorted(STROKES, key=lambda s: joints_m[[s.near, s.far], 0].sum())
        for stroke in nearest_last:
            near, far = _corner(flat[stroke.near]), _corner(flat[stroke.far])
            thick = max(2, round(2 * stroke.thick * tall_px))
            cv2.line(view, near, far, PAPER, thick + 3, cv2.LINE_AA)
            cv2.line(view, near, far, _paint(stroke, confidence), thick, cv2.LINE_AA)
    return view


@lru_cache(maxsize=4)
def _stage(height_px: int) -> Image:
    """The view from the side without a person."""
    width_px = 2 * round(SIDE_SHARE * height_px / 2)
    view: Image = np.full((height_px, width_px, 3), PAPER, np.uint8)
    floor_px = _floor_px(height_px)
    cv2.line(view, (0, floor_px), (width_px, floor_px), (205, 200, 195), 1, cv2.LINE_AA)
    _camera(view, floor_px)
    said, font = "from the side", cv2.FONT_HERSHEY_SIMPLEX
    cv2.putText(view, said, (8, 18), font, 0.45, INK, 1, cv2.LINE_AA)
    return view


def _floor_px(height_px: int) -> int:
    return round(height_px * (1 - BELOW_M / TALL_M))


def _above_floor_m(joints_m: Vector) -> Vector:
    """Heights (15,); of a body that would leave the view, as before a tilted camera, relative to
    its lowest joint."""
    up_m: Vector = joints_m[:, 1]
    shown = up_m.min() >= -BELOW_M and up_m.max() <= TALL_M - BELOW_M
    return up_m if shown else up_m - up_m.min()


def _camera(view: Image, floor_px: int) -> None:
    """Draw the camera: at the left, at chest height."""
    at = floor_px - round(1.2 * view.shape[0] / TALL_M)
    cv2.rectangle(view, (4, at - 7), (18, at + 7), INK, -1)
    lens = np.array([[18, at], [27, at - 7], [27, at + 7]], np.int32)
    cv2.fillPoly(view, [lens], INK, cv2.LINE_AA)


def _tint(image: Image, silhouette: NDArray[np.bool_]) -> None:
    """Tint the silhouette and draw its contour, in place."""
    size = (image.shape[1], image.shape[0])
    mask = cv2.resize(silhouette.view(np.uint8), size, interpolation=cv2.INTER_NEAREST)
    x, y, width, height = cv2.boundingRect(mask)
    part = image[y : y + height, x : x + width]
    if part.size:
        tinted = cv2.addWeighted(part, 1 - TINT, np.full_like(part, SEEN), TINT, 0)
        cv2.copyTo(tinted, mask[y : y + height, x : x + width], part)
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(image, contours, -1, SEEN, 1, cv2.LINE_AA)


def _paint(stroke: Stroke, confidence: Vector) -> tuple[int, ...]:
    """A line's colour in OpenCV's order, paler the less sure its far end is."""
    strength = float(np.clip(np.nan_to_num(confidence[stroke.far]), 0.0, 1.0))
    return tuple(
        round(pale + strength * (full - pale))
        for full, pale in zip(stroke.colour[::-1], UNSURE[::-1], strict=True)
    )


def _corner(place: Vector) -> tuple[int, int]:
    """A place for OpenCV, whose pixel centres are whole numbers; places far outside stay
    outside."""
    x, y = np.clip(np.rint(place - 0.5), -10_000, 10_000)
    return int(x), int(y)
