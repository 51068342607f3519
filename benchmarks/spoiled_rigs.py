"""Calibrations that are spoiled in one way each: which of them the gate believes, and what it says.

    python benchmarks/spoiled_rigs.py CLIP...

CLIP has a calibration, in its folder or beside it. What both views see of it is gathered once, by
a first pass that knows no rig, and held against each rig.
"""

import math
import sys
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final

import msgspec
import numpy as np

from calibration.gate.rig_fault import advice_on, exchanged_rig
from calibration.gate.rig_trust import trust_of
from calibration.tracks.joint_tracks import Sighting
from calibration.tracks.rig_guess import rotation
from common.body.body import Vector
from common.config.part_settings import BodySettings
from common.config.settings import Settings
from common.method import METHODS
from common.rig.camera import Camera, Rig, as_matrix, as_row, centre
from common.video.clips import open_clip
from runtime.offline.lockstep import Decoders
from runtime.offline.rig_from_person import sightings_of
from viewer.landmarks.landmark_sources import outside_sources

Spoiled = Callable[[Camera], Camera]


def turned(deg: float) -> Spoiled:
    """Turned about its own place, to the side."""

    def spoiled(camera: Camera) -> Camera:
        turn = rotation(math.radians(deg), 0.0, 0.0) * [[1], [-1], [-1]]  # of y up to y down
        R = np.array(camera.R) @ turn
        return msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(-R @ centre(camera)))

    return spoiled


def carried(by_m: Vector) -> Spoiled:
    """Said to stand elsewhere in the world."""

    def spoiled(camera: Camera) -> Camera:
        t = -np.array(camera.R) @ (centre(camera) + by_m)
        return msgspec.structs.replace(camera, t=as_row(t))

    return spoiled


def zoomed(share: float) -> Spoiled:
    """With so much longer focal lengths."""
    return lambda camera: msgspec.structs.replace(
        camera, K=as_matrix(np.array(camera.K) * [[1 + share, 1, 1], [1, 1 + share, 1], [1, 1, 1]])
    )


def enlarged(camera: Camera) -> Camera:
    """Of pictures twice as large."""
    return msgspec.structs.replace(camera, K=as_matrix(np.diag([2, 2, 1]) @ np.array(camera.K)))


def of_second(rig: Rig, spoiled: Spoiled) -> Rig:
    """The rig with its second camera spoiled."""
    first, second = rig.cameras
    return msgspec.structs.replace(rig, cameras=(first, spoiled(second)))


def of_both(rig: Rig, spoiled: Spoiled) -> Rig:
    """The rig with both cameras spoiled."""
    return msgspec.structs.replace(rig, cameras=tuple(map(spoiled, rig.cameras)))


RIGS: Final[dict[str, Callable[[Rig], Rig]]] = {
    "right": lambda rig: rig,
    **{
        f"camera 2 turned {deg:+d} deg": partial(of_second, spoiled=turned(deg))
        for deg in (1, -1, 3, -3, 8, -8)
    },
    **{
        f"camera 2 moved {by:g} m along {'xyz'[n]}": partial(
            of_second, spoiled=carried(by * np.eye(3)[n])
        )
        for by in (0.1, 0.3, 1.0)
        for n in range(3)
    },
    **{
        f"focal lengths {share:+.0%}": partial(of_both, spoiled=zoomed(share))
        for share in (0.05, -0.05, 0.2, -0.2)
    },
    "focal length of camera 2 +20%": partial(of_second, spoiled=zoomed(0.2)),
    "exchanged": exchanged_rig,
    "of twice the size": partial(of_both, spoiled=enlarged),
}
LATE_FRAMES: Final = (1, -1, 2, -2, 5, -5)


def looked_at(folder: Path, decoders: Decoders) -> tuple[Rig, Sighting, float]:
    """The rig of a clip, what both views see of it, and the time between its frames."""
    settings = Settings(clip=str(folder), body=BodySettings())
    clip = open_clip(settings, decoders.of[1])
    assert clip.rig is not None
    with outside_sources(settings, clip.views) as sources:
        seen = sightings_of(clip, settings, METHODS["default"], decoders.of, sources).pair(0, 1)
    return clip.rig, seen, clip.every / clip.views[0].fps


def judged(rig: Rig, seen: Sighting, period_s: float) -> str:
    """What is said of a rig; "" where it is believed."""
    trust = trust_of(rig, seen, period_s)
    if trust is None:
        return "too little is seen"
    advice = advice_on(rig, seen, period_s, trust)
    return "" if trust.believed else f"({', '.join(trust.odd)}) {advice.split(':')[0]}"


def main() -> None:
    cases: dict[str, list[str]] = {}
    with Decoders() as decoders:
        for folder in map(Path, sys.argv[1:]):
            rig, seen, period_s = looked_at(folder, decoders)
            for name, spoil in RIGS.items():
                cases.setdefault(name, []).append(judged(spoil(rig), seen, period_s))
            for late in LATE_FRAMES:
                second = seen.second._replace(times_s=seen.second.times_s + late * period_s)
                name = f"view 2 late by {late:+d} frames"
                cases.setdefault(name, []).append(
                    judged(rig, seen._replace(second=second), period_s)
                )
            print(folder.name, cases["right"][-1], flush=True)
    for name, told in cases.items():
        doubted = [each for each in told if each]
        print(f"{name}: {len(doubted)} of {len(told)} not believed")
        for words, times in Counter(doubted).most_common(4):
            print(f"    {times} times: {words}")


if __name__ == "__main__":
    main()
