"""The same person before cameras that are rolled ever farther: how far off the truth, and why.

    python benchmarks/rolled_rigs.py --motion walk_toward free --step 15 --size 320x240

One performance is rendered anew for every roll of both cameras (the second may be rolled the other
way, or not at all), with its exact calibration, and tracked. Errors are means over 12 joints and
all frames with a person; `upright` is the error less that of the rig that is not rolled.
"""

import argparse
import math
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
import numpy as np

from common.bus.messages import ViewerNumber
from common.config.picture_size import size_of
from common.config.settings import Settings
from common.rig.camera import Camera, Rig, as_matrix, as_row
from runtime.offline.lockstep import Decoders, Tracked, track_clip
from runtime.store.pose_arrays import poses
from synth.motion.motions import POSTURES, Motion, performance
from synth.person.people import Person, person
from synth.picture.exposure import default_rig
from synth.write import FPS, Filming, write_clip, write_rig

SCORED: Final = [
    f"{side}_{name}"
    for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
    for side in "lr"
]
SECOND: Final = {"alike": 1.0, "opposite": -1.0, "level": 0.0}
"""How much of camera 1's roll camera 2 has."""


class Found(NamedTuple):
    """How far a clip's poses are from the truth."""

    off_mm: float
    """In the world."""
    off_px: float
    """In the files' pictures, at the working size."""
    posed: float
    """Share of the frames with a person that have a pose."""


def rolled(camera: Camera, deg: float) -> Camera:
    """A camera rolled clockwise where it stands: what it shows turns the other way."""
    cos, sin = math.cos(math.radians(deg)), math.sin(math.radians(deg))
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    R, t = turn @ np.array(camera.R), turn @ np.array(camera.t)
    return msgspec.structs.replace(camera, R=as_matrix(R), t=as_row(t))


def rolled_rig(rig: Rig, rolls_deg: Sequence[float]) -> Rig:
    """A rig whose cameras are rolled, each by its own angle."""
    cameras = tuple(rolled(*each) for each in zip(rig.cameras, rolls_deg, strict=True))
    return msgspec.structs.replace(rig, cameras=cameras)


def filmed(folder: Path, moved: tuple[Person, Motion], rig: Rig) -> Path:
    """The clip of a performance before a rig, with its calibration."""
    clip = folder / "clip"
    write_clip(clip, *moved, Filming(rig, room_seed=5, seed=1), take=1)
    write_rig(clip / "calibration.json", rig)
    return clip


def compared(tracked: Tracked, clip: Path) -> Found:
    """The poses of a clip against its truth."""
    with np.load(clip / "truth.npz", allow_pickle=False) as truth:
        names = [str(name) for name in truth["joint_names"]]
        at = [names.index(name) for name in SCORED]
        present, true_m = truth["present"], truth["joints3d"][:, at]
        true_px = np.stack([truth[f"joints2d_cam{n}"][:, at] for n in (1, 2)], axis=1)
    found = poses(tracked.bodies)
    ours = [list(found["joint_names"]).index(name) for name in SCORED]
    view = tracked.clip.views[0]
    scale = view.filed_size[0] / view.source_size[0]
    off_m = np.linalg.norm(found["joints_m"][:, ours] - true_m, axis=-1)[present]
    seen = [each.number - 1 for each in tracked.clip.views]
    off_px = found["joints_px"][:, :, ours] - scale * true_px
    off_px = np.linalg.norm(off_px[:, seen], axis=-1)[present]
    posed = np.isfinite(off_m).all(axis=1)
    return Found(1e3 * float(np.nanmean(off_m)), float(np.nanmean(off_px)), float(posed.mean()))


def performances(motions: Sequence[str], seed: int) -> dict[str, tuple[Person, Motion]]:
    """Somebody who performs each of these."""
    who = person(seed)
    return {name: (who, performance(who, name, 1, FPS)) for name in motions}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--motion", nargs="+", default=["walk_toward"], choices=POSTURES)
    parser.add_argument("--person", type=int, default=3)
    parser.add_argument("--step", type=float, default=15.0)
    parser.add_argument("--size", default="320x240", help="of the pictures that are filmed")
    parser.add_argument("--work", default="320x240", help="that they are tracked at")
    parser.add_argument("--views", default="12", choices=("12", "1"), help="that are tracked")
    parser.add_argument("--mode", default="default", choices=("default", "paper", "thesis"))
    parser.add_argument("--second", choices=SECOND, default="alike", help="camera 2's roll")
    given = parser.parse_args()
    level = default_rig(*size_of(given.size))
    moved = performances(given.motion, given.person)
    upright: dict[str, Found] = {}
    views: tuple[ViewerNumber, ...] = (1,) if given.views == "1" else (1, 2)
    print("| roll | " + " | ".join(f"{name}: mm, upright, px, posed" for name in moved) + " |")
    print("|---|" + "---|" * len(moved))
    with Decoders() as decoders:
        for deg in np.arange(0.0, 360.0, given.step):
            rig, told = rolled_rig(level, (deg, SECOND[given.second] * deg)), []
            for name, shown in moved.items():
                with tempfile.TemporaryDirectory() as folder:
                    clip = filmed(Path(folder), shown, rig)
                    settings = Settings(clip=str(clip), size=given.work, mode=given.mode)
                    found = compared(track_clip(settings, decoders, views), clip)
                first = upright.setdefault(name, found)
                more = found.off_mm - first.off_mm
                told.append(
                    f"{found.off_mm:.1f}, {more:+.1f}, {found.off_px:.2f}, {found.posed:.0%}"
                )
            print(f"| {deg:.0f} | " + " | ".join(told) + " |", flush=True)


if __name__ == "__main__":
    main()
