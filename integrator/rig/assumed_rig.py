"""A rig for uncalibrated pictures: the paper's arrangement, scaled by the person."""

from typing import Final

from common.body.observation import Observation
from common.rig.camera import Rig, paper_rig

FOCAL_SHARE: Final = 1.25
"""Focal length over the picture's width: a lens of 44 degrees, common for room cameras."""


def assumed_rig(first: Observation, second: Observation, stature_m: float) -> Rig:
    """Cameras at the distance at which a person of the assumed stature has the observed height.

    Both cameras are level and look at the person, who stands at the origin; the floor is where the
    silhouette ends. All lengths then have the relative error of the stature.

    Args:
        first: A person who stands upright, wholly in view 1.
        second: The same person in view 2, or in the same view where only one shows the whole
            person.
        stature_m: Assumed stature of the person.
    """
    views = []
    for person in (first, second):
        tall_px = person.box.bottom + 1 - person.box.top
        size = (person.width, person.height)
        views.append(_from_a_standing_person(size, person.box.bottom + 1, tall_px, stature_m))
    (focal_1, distance_1, height_1), (focal_2, distance_2, height_2) = views
    return paper_rig(
        (first.width, first.height),
        (focal_1, focal_2),
        (distance_1, distance_2),
        (height_1, height_2),
    )


def _from_a_standing_person(
    size: tuple[int, int], sole_row: float, tall_px: float, stature_m: float
) -> tuple[float, float, float]:
    """Focal length (px), distance of the camera and its height above the floor (m)."""
    focal = FOCAL_SHARE * size[0]
    distance = focal * stature_m / tall_px
    return focal, distance, (sole_row - size[1] / 2) * distance / focal
