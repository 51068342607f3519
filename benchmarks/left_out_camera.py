"""Four cameras of a gait laboratory: are more of them better, seen from one that was left out?

Run: python benchmarks/left_out_camera.py $TRITRACK_DATA/real/pose2sim_balancing --out DIR
    --landmarks $TRITRACK_DATA/real/landmarks_mediapipe.npz [--size 240x427] [--every 4]
    [--as-calibrated]

Tracks all four, each three and each pair, without plates; a camera that the run of all four turns
back is turned for all of them, but for --as-calibrated; the joints of each are projected into
every camera and compared with another tracker's landmarks there. A table in Markdown gives the
median distance in pixels of a picture that is 1080 wide, by camera: in brackets where the camera
was one of those that were tracked.
"""

import argparse
import json
from itertools import combinations
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from pose2sim import cameras_of
from threadpoolctl import threadpool_limits

from common.body.body import JOINT_NAMES
from common.bus.messages import Body
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.rig.camera import Rig, project
from common.rig.rig_file import load_rig
from runtime.offline.lockstep import Decoders, track_clip
from runtime.store.runs import write_run

NAMES: Final = ("cam01", "cam02", "cam03", "cam04")
SETS: Final = tuple(some for n in (4, 3, 2) for some in combinations(NAMES, n))
WIDE_PX: Final = 1080
SURE: Final = 0.5
"""Visibility from which on a landmark counts."""

Landmarks = dict[str, NDArray[np.float64]]
"""Of each camera (frames, 12, 2) in pixels of the calibration's pictures, NaN where unsure."""


def landmarks_of(path: Path, rig: Rig) -> tuple[list[str], Landmarks]:
    """Names of the joints, and where another tracker shows them."""
    found: Landmarks = {}
    with np.load(path, allow_pickle=False) as given:
        for name in NAMES:
            video = f"pose2sim_balancing/{name}.mp4"
            scale = np.array((rig.width, rig.height)) / given[f"{video}__size"]
            sure = given[video][..., 2:] >= SURE
            found[name] = np.where(sure, given[video][..., :2] * scale, np.nan)
        return given["joint_names"].tolist(), found


def off_px(bodies: list[Body], rig: Rig, names: list[str], shown: Landmarks) -> dict[str, float]:
    """Median distance in each camera, pixels of a picture that is WIDE_PX wide."""
    posed = [body for body in bodies if body.joints_m]
    own = [JOINT_NAMES.index(name) for name in names]
    found = {}
    for camera in rig.cameras:
        places = [project(camera, np.array(body.joints_m))[own] for body in posed]
        due = shown[camera.name][[body.frame for body in posed]]
        apart = np.linalg.norm(np.array(places) - due, axis=-1)
        found[camera.name] = float(np.nanmedian(apart)) * WIDE_PX / rig.width
    return found


def settings_of(some: tuple[str, ...], path: Path, asked: argparse.Namespace) -> Settings:
    """The settings of some cameras, by the calibration at a path."""
    videos = asked.data.resolve()
    return Settings(
        calibration=str(path),
        trust_calibration=asked.as_calibrated,
        size=asked.size,
        every=asked.every,
        cameras={name: CameraSettings(source=str(videos / f"{name}.mp4")) for name in some},
    )


def turn_back(path: Path, odd: dict[str, Any]) -> Rig:
    """The calibration at a path, there too, with a camera as a run's summary has it."""
    told = json.loads(path.read_text())
    for camera in told["cameras"]:
        if camera["name"] == odd["camera"]:
            camera |= {"R": odd["R"], "t": odd["t"]}
    path.write_text(json.dumps(told))
    return load_rig(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--landmarks", type=Path, required=True)
    parser.add_argument("--size", default="240x427")
    parser.add_argument("--every", type=int, default=4, help="of 60 frames a second")
    parser.add_argument("--as-calibrated", action="store_true", help="turn no camera back")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    path = asked.out / "trial.json"
    given = json.loads((asked.data / "cameras.json").read_text())
    path.write_text(json.dumps(cameras_of(given, NAMES[:2])))
    rig = load_rig(path)
    names, shown = landmarks_of(asked.landmarks, rig)
    print(f"| cameras | {' | '.join(NAMES)} | all | tracking |")
    print("|---" * (len(NAMES) + 3) + "|")
    with Decoders() as decoders:
        for some in SETS:
            settings = settings_of(some, path, asked)
            done = track_clip(settings, decoders)
            write_run(asked.out / "+".join(some), done.bodies, settings, done.facts)
            if "odd_camera" in done.facts and some == NAMES:
                rig = turn_back(path, done.facts["odd_camera"])
            found = off_px([*done.bodies], rig, names, shown)
            cells = [f"({px:.1f})" if name in some else f"{px:.1f}" for name, px in found.items()]
            share = np.mean([body.status == "tracking" for body in done.bodies])
            mean = np.mean([*found.values()])
            who = "+".join(name[-1] for name in some)
            print(f"| {who} | {' | '.join(cells)} | {mean:.1f} | {share:.0%} |", flush=True)
            print(*done.facts["warnings"], sep="\n")


if __name__ == "__main__":
    with threadpool_limits(1):
        main()
