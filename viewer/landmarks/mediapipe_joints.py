"""Our 15 joints out of MediaPipe's 33 points, and how far they can be relied on."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.observation import Landmarks
from common.video.pictures import Size
from viewer.landmarks.fifteen_joints import facing_deg, fifteen, fifteen_shares
from viewer.landmarks.keypoint_layouts import body_points, extremity_points

FACES_SO: Final = 0.9
"""Probability that a person faces front or back as shoulders, hips and nose say: right in all 900
frames of two performers facing the cameras and in 91 % of 936 frames of synthetic people that turn
about (docs/measurements.md)."""


def landmarks_of(points: NDArray[np.float32], shown: Size, working: Size) -> Landmarks:
    """Our landmarks of MediaPipe's points.

    Args:
        points: (33, 3): column and row in the picture that it was shown, and visibility.
        shown: Width and height of that picture.
        working: Width and height of the working picture.
    """
    body = body_points(points)
    places = body[:, :2]
    scale = np.divide(working, shown)
    joints, ends = scale * fifteen(places), extremity_points(points)
    return Landmarks(
        joints_px=tuple((float(u), float(v)) for u, v in joints),
        confidence=tuple(fifteen_shares(body[:, 2]).tolist()),
        facing_deg=facing_deg(places),
        facing_confidence=FACES_SO,
        extremities_px=tuple((float(u), float(v)) for u, v in scale * ends[:, :2]),
        extremities_confidence=tuple(ends[:, 2].tolist()),
    )
