"""Requests to the process that finds rigs, and its answers."""

import struct
from typing import Final

import msgspec
import numpy as np

from calibration.tracks.joint_tracks import JOINTS, JointTrack, Row, Sighting
from common.bus.messages import ViewerNumber
from common.rig.camera import Rig
from common.rig.rig_file import CalibrationError

NUMBERS: Final = 1 + 2 * JOINTS + JOINTS + 2
"""Layout of a row: time, places, confidence, facing and its confidence."""

LENGTH: Final = struct.Struct("<I")
"""Header of an answer: its length."""


class Stand(msgspec.Struct, frozen=True):
    """Both views before a camera was moved, and the rig valid then."""

    rig: Rig
    tracks: tuple[bytes, bytes]
    """Packed rows, with the reported times."""


class Job(msgspec.Struct, frozen=True, tag=True):
    """Both views, and the rig in use."""

    size_px: tuple[int, int]
    stature_m: float
    period_s: float
    tracks: tuple[bytes, bytes]
    """Packed rows."""
    rig: Rig | None = None
    """None: an assumed rig."""
    moved: tuple[ViewerNumber, ...] = ()
    """Moved cameras; the others keep their places in the rig, and so does the world."""
    late_s: float = 0.0
    """Delay of view 2, where known."""
    stood: Stand | None = None
    """Observations from before that."""


class Trusted(msgspec.Struct, frozen=True):
    """The rig's assessment by these observations: see `calibration/gate/rig_trust.py`."""

    apart_mm: float
    odd: tuple[str, ...]


class Solved(msgspec.Struct, frozen=True, tag=True):
    """A rig."""

    rig: Rig
    trust: Trusted
    """Assessment of the rig by the observations that it was found from."""
    before: Trusted | None = None
    """The same for the rig in use; None where none is in use, or too little is seen for it."""
    late_s: float = 0.0
    """Delay of view 2."""
    gap_mm: float = 0.0
    """Median distance between the sight lines of one joint."""
    turn_error_deg: float = 0.0
    """Standard deviation of camera 2's yaw."""


class Unsolved(msgspec.Struct, frozen=True, tag=True):
    """No rig."""

    refusal: str
    """Why there is none."""


Solution = Solved | Unsolved
TOO_LITTLE: Final = Unsolved("too little is seen of anybody")


def packed(row: Row) -> bytes:
    """A row as bytes."""
    time_s, joints_px, confidence, *facing = row
    return np.concatenate([[time_s], joints_px.ravel(), confidence, facing]).tobytes()


def track_of_bytes(told: bytes) -> JointTrack:
    """The track of concatenated rows."""
    table = np.frombuffer(told).reshape(-1, NUMBERS)
    joints_px = table[:, 1 : 1 + 2 * JOINTS].reshape(-1, JOINTS, 2)
    return JointTrack(
        table[:, 0], joints_px, table[:, 1 + 2 * JOINTS : -2], table[:, -2], table[:, -1]
    )


def solved(job: Job) -> Solution:
    """The rig that a job asks for: seconds of work."""
    from calibration.person.person_calibration import calibrated_by_person

    first, second = (track_of_bytes(told) for told in job.tracks)
    sighting = Sighting(first, second, job.size_px)
    if job.moved and job.rig is not None:
        return _placed(job, job.rig, sighting)
    try:
        found = calibrated_by_person((sighting,), job.stature_m)
    except CalibrationError as error:
        return Unsolved(str(error))
    trust = _trusted(found.rig, sighting, job.period_s)
    if trust is None:
        return TOO_LITTLE
    return Solved(
        rig=found.rig,
        late_s=found.late_s[0],
        gap_mm=found.quality.gap_mm,
        turn_error_deg=found.quality.cameras[1].turn_error_deg[0],
        trust=trust,
        before=None if job.rig is None else _trusted(job.rig, sighting, job.period_s),
    )


def _placed(job: Job, rig: Rig, sighting: Sighting) -> Solution:
    """The rig with the moved cameras placed by the person."""
    from calibration.gate.moved_place import Stood, placed

    stood = None
    if job.stood is not None:
        first, second = (track_of_bytes(told) for told in job.stood.tracks)
        stood = Stood(job.stood.rig, Sighting(first, second, job.size_px))
    found = placed(rig, sighting, job.moved, job.late_s, stood)
    trust = None if found is None else _trusted(found.rig, sighting, job.period_s)
    if found is None or trust is None:
        return TOO_LITTLE
    return Solved(
        rig=found.rig,
        late_s=job.late_s,
        gap_mm=found.gap_mm,
        turn_error_deg=found.turn_error_deg,
        trust=trust,
        before=_trusted(rig, sighting, job.period_s),
    )


def _trusted(rig: Rig, sighting: Sighting, period_s: float) -> Trusted | None:
    from calibration.gate.rig_trust import trust_of

    trust = trust_of(rig, sighting, period_s)
    return None if trust is None else Trusted(trust.apart_mm, trust.odd)
