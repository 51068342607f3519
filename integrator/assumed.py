"""A rig for pictures that come without a calibration: the paper's kind, sized by the person."""

from typing import Final

from common.camera import Rig, paper_rig
from common.messages import Report

FOCAL_SHARE: Final = 1.25
"""Focal length over the picture's width: a lens of 44 degrees, common for room cameras."""


def assumed_rig(first: Report, second: Report, stature_m: float) -> Rig:
    """Cameras at the distance at which a person of a stature is as high as seen now.

    Both cameras are level and look at the person, who stands at the origin; the floor is where
    the silhouette ends. Lengths are then right to the share that the stature is wrong.

    Args:
        first: Viewer 1's report of somebody who stands upright, wholly in view.
        second: Viewer 2's; the same report for both where only one view shows the whole person.
        stature_m: What is assumed of the person.
    """
    focals, distances, heights = [], [], []
    for report in (first, second):
        assert report.box is not None
        focal = FOCAL_SHARE * report.width
        distance = focal * stature_m / (report.box.bottom + 1 - report.box.top)
        focals.append(focal)
        distances.append(distance)
        heights.append((report.box.bottom + 1 - report.height / 2) * distance / focal)
    return paper_rig(
        (first.width, first.height),
        (focals[0], focals[1]),
        (distances[0], distances[1]),
        (heights[0], heights[1]),
    )
