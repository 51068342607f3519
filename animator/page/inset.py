"""A camera's picture on the page: its silhouette or picture, and the fitted body's contour."""

import math
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from animator.scene import Figure, half_sizes, limb_colours
from common.body.body import LIMBS, Vector
from common.body.kinematics import limb_frames
from common.body.proportions import body_vector
from common.bus.messages import Picture, View
from common.raster.silhouette_report import mask_of
from common.rig.camera import Camera, project

Image = NDArray[np.uint8]
"""(H, W, 3), red, green, blue."""

NIGHT: Final = np.array([28, 33, 41], np.float32)
"""Colour of the background, where no picture may be shown."""
SEEN: Final = np.array([80, 116, 124], np.float32)
"""Colour of the person in the camera's silhouette."""
TINT: Final = 0.35
"""Opacity of SEEN over a picture: the silhouette is visible, the picture stays readable."""

WIDTH_PX: Final = 320
"""Smallest width of an inset, pixels: at 160x120 a contour would be as thick as an arm."""
END_POINTS: Final = 64
"""Number of points on an end of a limb: the contour is within 3 % of the radius."""
GOLDEN_RAD: Final = math.pi * (3.0 - math.sqrt(5.0))
"""Turn between successive points that distributes them evenly over a ball, radians."""
SHIFT: Final = 4
"""Fractional bits of a pixel in cv2's drawing functions."""
FARTHEST: Final = 2**20
"""Largest coordinate, in those fractions: cv2's numbers would overflow beyond."""


def limb_ends(figure: Figure) -> NDArray[np.float64]:
    """Points on both ends of each limb, (10, 2 * END_POINTS, 3), metres: their hull is the limb.

    A trunk, a head and a leg end in a flat section, an arm in a ball, as in matching.
    """
    turn = np.linspace(0.0, 2.0 * math.pi, END_POINTS, endpoint=False)
    circle = np.stack([np.cos(turn), np.zeros_like(turn), np.sin(turn)], axis=1)
    ends = []
    for limb, frame in zip(LIMBS, limb_frames(body_vector(figure.bdp), figure.pose), strict=True):
        long, height, short = half_sizes(getattr(figure.bdp, limb))
        near = (_ball() if limb.endswith("arm") else circle) * (long, long, short)
        local = np.concatenate([near, near + np.array([0.0, height, 0.0])])
        ends.append(local @ frame[3:].reshape(3, 3).T + frame[:3])
    return np.array(ends)


def limb_contours(camera: Camera, ends_m: NDArray[np.float64]) -> list[Vector]:
    """The contour of each limb in a camera's picture: convex, (k, 2) pixels, in the order of LIMBS.

    A limb that is not wholly in front of the camera has none: (0, 2).
    """
    pixels = project(camera, ends_m.reshape(-1, 3)).reshape(*ends_m.shape[:2], 2)
    return [
        cv2.convexHull(limb.astype(np.float32))[:, 0].astype(np.float64)
        if np.isfinite(limb).all()
        else np.empty((0, 2))
        for limb in pixels
    ]


def inset(report: View, picture: Picture | None) -> Image:
    """The silhouette over the picture, or over NIGHT without one; at least WIDTH_PX wide.

    A picture that cannot be decoded is left out.
    """
    times = math.ceil(WIDTH_PX / report.width)
    size = (report.width * times, report.height * times)
    seen = cv2.resize(mask_of(report).astype(np.float32), size)[:, :, None]
    shown = _decoded(picture, size)
    if shown is None:
        painted = NIGHT + seen * (SEEN - NIGHT)
    else:
        painted = shown + TINT * seen * (SEEN - shown)
    image: Image = painted.astype(np.uint8)
    return image


def draw_contours(image: Image, contours: list[Vector], width_px: int) -> None:
    """Draw limbs into an inset, in the colours of their sides.

    Args:
        image: Changed in place.
        contours: From `limb_contours`.
        width_px: Width of the picture to whose pixels the contours refer.
    """
    times = image.shape[1] / width_px
    for contour, colour in zip(contours, limb_colours(), strict=True):
        corners = np.rint((contour * times - 0.5) * 2**SHIFT)
        if len(corners) and np.abs(corners).max() < FARTHEST:
            cv2.polylines(
                image, [corners.astype(np.int32)], True, colour.tolist(), 1, cv2.LINE_AA, SHIFT
            )


def _ball() -> NDArray[np.float64]:
    """Points spread over the unit ball, (END_POINTS, 3)."""
    height = 1.0 - (2.0 * np.arange(END_POINTS) + 1.0) / END_POINTS
    turn, radius = GOLDEN_RAD * np.arange(END_POINTS), np.sqrt(1.0 - height**2)
    points: NDArray[np.float64] = np.stack(
        [radius * np.cos(turn), height, radius * np.sin(turn)], axis=1
    )
    return points


def _decoded(picture: Picture | None, size: tuple[int, int]) -> NDArray[np.float32] | None:
    if picture is None or not picture.jpeg:
        return None
    decoded = cv2.imdecode(np.frombuffer(picture.jpeg, np.uint8), cv2.IMREAD_COLOR_RGB)
    if decoded is None:
        return None
    fitting: NDArray[np.float32] = cv2.resize(decoded, size).astype(np.float32)
    return fitting
