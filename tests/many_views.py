"""Made-up people before any number of cameras, as the network of landmarks would show them."""

from collections.abc import Sequence

import numpy as np
from wild_rigs import AT, Film, seen_by_all

from calibration.tracks.joint_tracks import Sightings
from common.rig.camera import Rig
from synth.motion.motions import performance
from synth.person.people import person
from synth.picture.random_rig import rig_around


def around(cameras: int, seed: int = 5) -> Rig:
    """Cameras around a person."""
    return rig_around((160, 120), cameras, seed)


def shown(rig: Rig, seed: int, posture: str, late_s: Sequence[float] = ()) -> Sightings:
    """What each camera shows of a motion; what a camera shows bears a time that is late."""
    motion = performance(person(seed), posture, seed)
    joints_m = motion.joints_m[motion.present][:, AT]
    film = Film(joints_m, np.ones(len(joints_m), bool), motion.fps)
    late_s = late_s or (0.0,) * len(rig.cameras)
    return seen_by_all(film, rig, late_s, np.random.default_rng(seed))
