"""The two views that see a person best: what takes silhouettes of two is given these."""

from typing import Final

import numpy as np
from msgspec import structs

from common.body.body import Vector
from common.bus.messages import Report
from common.raster.silhouette_report import centroid_px, unpack
from common.rig.camera import Camera, Rig, ray

Places = tuple[int, int]
"""Of two cameras in the rig, the lower first."""

CUT: Final = 0.5
"""What a view that the person leaves counts beside one that has all of them."""


def best_pair(before: Places, rig: Rig, seen: tuple[Report | None, ...]) -> Places:
    """The pair of an instant.

    Two views stay the pair while both see the whole person. Otherwise it is of those that see
    the person, whole ones before others, whose sight lines are nearest to a right angle.

    Args:
        before: The pair of the instant before.
        rig: V >= 2 cameras without distortion.
        seen: Of each view, as without distortion; None where it has no person.
    """
    shown = [n for n, report in enumerate(seen) if report is not None]
    whole = {n for n in shown if not _is_cut(seen[n])}
    if len(rig.cameras) == 2 or whole.issuperset(before) or not shown:
        return before
    if len(shown) == 1:
        other = next(n for n in (*before, 0) if n != shown[0])
        return min(shown[0], other), max(shown[0], other)
    lines = {n: _sight_line(seen[n], rig.cameras[n]) for n in shown}
    worth = {
        (one, other): _sine(lines[one], lines[other]) * CUT ** len({one, other} - whole)
        for one in shown
        for other in shown
        if one < other
    }
    return max(worth, key=lambda pair: worth[pair])


def _is_cut(report: Report | None) -> bool:
    return report is None or report.cut


def _sight_line(report: Report | None, camera: Camera) -> Vector:
    """Towards the middle of a silhouette, (3,) unit length, world."""
    assert report is not None
    return ray(camera, centroid_px(unpack(report)))


def _sine(one: Vector, other: Vector) -> float:
    return float(np.linalg.norm(np.cross(one, other)))


def rig_of(rig: Rig, pair: Places) -> Rig:
    """The two cameras of a pair."""
    if len(rig.cameras) == 2:
        return rig
    return structs.replace(rig, cameras=tuple(rig.cameras[n] for n in pair))
