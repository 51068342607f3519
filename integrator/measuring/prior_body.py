"""The body before its opening posture: as tall as the silhouettes show (T4)."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from common.body.body import Bdp, Vector
from common.body.observation import Observation, Pixel
from common.body.proportions import thesis_bdp
from common.bus.instant import Seen
from common.raster.silhouette_report import unpack
from common.rig.camera import Camera, Rig, project, px_per_m
from integrator.proposal.silhouette_window import ABOVE_M, standing_m
from integrator.rig.body_position import UP_AXIS, place_of, roots_of, triangulate

STATURES_M: Final = (0.8, 2.3)
"""Range of statures, metres; a silhouette outside it is not a whole person."""

USUAL_M: Final = 1.75
"""Stature, metres, of a person whose silhouette shows none."""


def prior(rig: Rig, seen: Seen) -> Bdp:
    """The thesis's proportions at the height that the silhouettes show (T4).

    The smallest height counts: other foreground makes a silhouette larger. The crown of a standing
    person is as high above the floor, wherever their silhouette ends below or beside them. A single
    silhouette is assumed to stand on the floor.
    """
    place = _place(rig, seen)
    heights = [
        height
        for person, camera in zip(seen, rig.cameras, strict=True)
        if person is not None
        and not person.cut
        and np.isfinite(height := _height_m(person, camera, place))
    ]
    low, high = STATURES_M
    people = [person for person in seen if person is not None]
    if len(people) == len(seen) and low <= (crown := _crown_m(rig, people, place)) <= high:
        heights.append(crown)
    return thesis_bdp(min(high, max(low, min(heights))) if heights else USUAL_M)


def _place(rig: Rig, seen: Seen) -> Vector:
    """Place of the body, (3,) world."""
    for person, camera in zip(seen, rig.cameras, strict=True):
        if None in seen and person is not None:
            return standing_m(unpack(person), camera)
    return place_of(rig, roots_of(seen), np.zeros(3), 0)


def _height_m(person: Observation, camera: Camera, place: Vector) -> float:
    """Extent of a silhouette along the upright direction in its picture, metres."""
    along, _ = _upwards(person, camera, place)
    return float((along.max() + 1.0 - along.min()) / px_per_m(camera, place))


def _crown_m(rig: Rig, people: Sequence[Observation], place: Vector) -> float:
    """Height above the floor of the highest point of both silhouettes; inf where they show none.

    A silhouette that touches the border of a picture may go on beyond it.
    """
    tops: list[Pixel] = []
    for person, camera in zip(people, rig.cameras, strict=True):
        along, pixels = _upwards(person, camera, place)
        column, row = pixels[along.argmax()]
        if not (0 < column < person.width - 1 and 0 < row < person.height - 1):
            return np.inf
        tops.append((float(column) + 0.5, float(row) + 0.5))
    found = triangulate((rig.cameras[0], rig.cameras[1]), (tops[0], tops[1]))
    return float(found[1]) if np.isfinite(found).all() else np.inf


def _upwards(person: Observation, camera: Camera, place: Vector) -> tuple[Vector, NDArray[np.intp]]:
    """Height of each pixel of a silhouette in its picture, (n,), and the pixels, (n, 2)."""
    at, above = project(camera, np.stack([place, place + ABOVE_M * UP_AXIS]))
    rows, columns = np.nonzero(unpack(person))
    pixels = np.stack([columns, rows], axis=1)
    return pixels @ (above - at) / np.linalg.norm(above - at), pixels
