"""A calibration by a person, and how good it is."""

from typing import NamedTuple

import msgspec

from calibration.tracks.lateness import Clock
from common.rig.camera import Rig


class CameraQuality(msgspec.Struct, frozen=True):
    """What is known of one camera, and how well (one sigma)."""

    name: str
    focal_px: float
    focal_error_px: float
    position_m: tuple[float, float, float]
    position_error_m: tuple[float, float, float]
    turn_error_deg: tuple[float, float, float]
    """Of yaw, pitch and roll; camera 1 has no yaw, for it says where z is."""


class Quality(msgspec.Struct, frozen=True):
    """How good a calibration by a person is."""

    cameras: tuple[CameraQuality, ...]
    stature_m: float
    """All lengths are right to the share that this is."""
    moments: int
    """In how many both views saw the person."""
    gap_mm: float
    """By how much both views' sight lines of one joint miss each other, half of the time."""
    gap_px: float
    late_frames: tuple[float, ...]
    """By how many frames view 2 is late in each clip."""
    late_error_frames: tuple[float, ...]
    unsure: tuple[str, ...] = ()
    """What is not known well enough to be relied on; empty where all is."""


class PersonCalibration(NamedTuple):
    """Two cameras, by the person who moved before them."""

    rig: Rig
    late_s: tuple[float, ...]
    """How late view 2 is in each clip."""
    clocks: tuple[Clock, ...]
    """Whether that is known."""
    quality: Quality
