"""Requests for the camera that contradicts all others, and the answers."""

import msgspec

from calibration.gate.odd_camera import OddCamera
from calibration.tracks.joint_tracks import Sightings, longest_seen
from common.rig.camera import Rig
from integrator.live_rig.rig_job import Unsolved, track_of_bytes

Tracks = tuple[bytes, ...]
"""Packed rows of a person, by view."""


class OddJob(msgspec.Struct, frozen=True, tag=True):
    """All views of everybody, and the rig in use."""

    rig: Rig
    people: tuple[Tracks, ...]


OddAnswer = OddCamera | Unsolved
NONE_ODD = Unsolved("no camera contradicts all others")


def odd_solved(job: OddJob) -> OddAnswer:
    """The odd camera, as a recorded clip's is found: tenths of a second of work."""
    from calibration.gate.odd_camera import odd_camera
    from calibration.tracks.camera_clocks import clocks_of

    size_px = job.rig.width, job.rig.height
    everyone = longest_seen(
        Sightings(tuple(map(track_of_bytes, tracks)), size_px) for tracks in job.people
    )
    if not everyone:
        return NONE_ODD
    return odd_camera(job.rig, everyone, clocks_of(everyone[0])) or NONE_ODD
