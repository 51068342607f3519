"""A calibration by a person, and its quality."""

from typing import NamedTuple

import msgspec

from calibration.tracks.lateness import Clock
from common.rig.camera import Rig


class CameraQuality(msgspec.Struct, frozen=True):
    """One camera's numbers and their standard deviations."""

    name: str
    focal_px: float
    focal_error_px: float
    position_m: tuple[float, float, float]
    position_error_m: tuple[float, float, float]
    turn_error_deg: tuple[float, float, float]
    """Yaw, pitch and roll; camera 1 has no yaw, because it defines z."""


class Quality(msgspec.Struct, frozen=True):
    """Quality of a calibration by a person."""

    cameras: tuple[CameraQuality, ...]
    stature_m: float
    """Stature used, metres: all lengths have its relative error."""
    moments: int
    """Number of moments in which both views saw the person."""
    gap_mm: float
    """Median distance between the two sight lines of one joint."""
    gap_px: float
    late_frames: tuple[float, ...]
    """Delay of view 2 in each clip, frames."""
    late_error_frames: tuple[float, ...]
    unsure: tuple[str, ...] = ()
    """Numbers that are too uncertain to be relied on; empty where there are none."""


class PersonCalibration(NamedTuple):
    """Two cameras, calibrated by the person who moved before them."""

    rig: Rig
    late_s: tuple[float, ...]
    """Delay of view 2 in each clip."""
    clocks: tuple[Clock, ...]
    """Whether each delay is known."""
    quality: Quality
