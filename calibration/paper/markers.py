"""The aim of a camera, from the line markers in its picture (section 4.1, steps 1-4)."""

import math
from typing import Annotated, Final

import cv2
import msgspec
import numpy as np

from common.body.body import Vector
from common.body.observation import Pixel
from common.rig.rig_file import CalibrationError

Positive = Annotated[float, msgspec.Meta(gt=0)]
PositiveCount = Annotated[int, msgspec.Meta(gt=0)]


ROUNDS: Final = 10
"""Gauss-Newton converges within five for errors below 30 degrees."""


class MarkerView(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One camera's points on its two line markers, pixels."""

    name: str
    focal_px: Positive
    floor_px: tuple[Pixel, ...]
    """Points along the marker on the ground: ML_zg for camera 1, ML_xg for camera 2."""
    wall_px: tuple[Pixel, ...]
    """Points along the marker on the wall opposite: ML_xw for camera 1, ML_zw for camera 2."""


class Markers(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A file of line markers: the centre of the top-left pixel is (0.5, 0.5)."""

    width: PositiveCount
    height: PositiveCount
    cameras: tuple[MarkerView, ...]


class Aim(msgspec.Struct, frozen=True):
    """Angles between a camera's aim and the nominal one, degrees."""

    name: str
    yaw_deg: float
    """Positive: it looks too far to the right."""
    pitch_deg: float
    """Positive: it looks too high."""
    roll_deg: float
    """Positive: it is turned clockwise, as seen from behind it."""
    skew_deg: float
    """Deviation of the two markers from a right angle: a marker or the camera is misplaced."""


def line_markers(view: MarkerView, size: tuple[int, int]) -> Aim:
    """Yaw, pitch and roll of a camera relative to the direction that the markers define.

    The marker on the ground and the lens span the vertical plane that the camera should look along,
    the marker on the wall and the lens the level plane. The result is the rotation that brings both
    planes into the camera's axes with the least distance of the points from them. It is exact for
    any error of aim, but the camera must stand in its place (step (1)).

    Args:
        view: Points of both markers.
        size: Width and height of the picture.

    Raises:
        CalibrationError: When the points of a marker form no line, or one in the wrong direction.

    Source: section 4.1, steps (2)-(4) (P42).
    """
    rays = _rays_of_both(view, size)
    normals = [_normal(view, rays[axis], axis) for axis in (0, 1)]
    right, below, forward = _rotation(rays)
    return Aim(
        view.name,
        yaw_deg=_degrees(forward[0], forward[2]),
        pitch_deg=_degrees(-forward[1], math.hypot(forward[0], forward[2])),
        roll_deg=_degrees(right[1], below[1]),
        skew_deg=math.degrees(math.asin(abs(float(normals[0] @ normals[1])))),
    )


def fitted_lines(view: MarkerView, size: tuple[int, int]) -> Vector:
    """The markers' lines in the picture, by the aim from their points.

    Returns:
        (2, 3): a, b, c of a line a u + b v + c = 0, pixels, for the marker on the ground and that
        on the wall; a^2 + b^2 = 1, so that the left side is a point's distance.

    Raises:
        CalibrationError: When the points of a marker form no line.
    """
    normals = _rotation(_rays_of_both(view, size)).T[:2]
    across_down = normals[:, :2] / view.focal_px
    lines = np.column_stack([across_down, normals[:, 2] - across_down @ np.array(size) / 2])
    straight: Vector = lines / np.linalg.norm(across_down, axis=1, keepdims=True)
    return straight


def _rays_of_both(view: MarkerView, size: tuple[int, int]) -> list[Vector]:
    return [_rays(view, marker, size) for marker in ("floor_px", "wall_px")]


def _rotation(rays: list[Vector]) -> Vector:
    """Rotation from aimed axes to the camera's, (3, 3): column 0 is perpendicular to the first
    rays, column 1 to the others.

    Gauss-Newton on the distances of the points from their planes, from no rotation.
    """
    rotation: Vector = np.eye(3)
    for _ in range(ROUNDS):
        off = np.concatenate([rays[axis] @ rotation[:, axis] for axis in (0, 1)])
        by_turn = [np.cross(rotation[:, axis], rays[axis]) for axis in (0, 1)]
        turn = np.linalg.lstsq(np.concatenate(by_turn), -off)[0]
        rotation = cv2.Rodrigues(turn)[0] @ rotation
    return rotation


def _rays(view: MarkerView, marker: str, size: tuple[int, int]) -> Vector:
    """Rays of a marker's points, (n, 3), camera axes, depth 1."""
    points = np.array(getattr(view, marker), np.float64).reshape(-1, 2)
    if len(points) < 2 or np.ptp(points, axis=0).max() < 1.0:
        raise CalibrationError(f"{marker} of {view.name} is no line: give two points or more")
    return np.column_stack([(points - np.array(size) / 2) / view.focal_px, np.ones(len(points))])


def _normal(view: MarkerView, rays: Vector, axis: int) -> Vector:
    """Normal of the plane of one marker; it should be along `axis` (0 or 1)."""
    normal: Vector = np.linalg.svd(rays)[2][2]
    if abs(normal[axis]) < abs(normal[1 - axis]):
        marker, way = (("floor_px", "up and down"), ("wall_px", "across"))[axis]
        raise CalibrationError(f"{marker} of {view.name} must run {way} in the picture")
    return normal


def _degrees(sine: float, cosine: float) -> float:
    return math.degrees(math.atan2(sine, cosine))
