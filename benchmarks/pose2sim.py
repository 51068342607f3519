"""Four cameras of a gait laboratory, two at a time: is somebody followed whom they film?

Run: python benchmarks/pose2sim.py $TRITRACK_DATA/real/pose2sim_balancing --out DIR

Writes a calibration and a settings file for each pair, tracks it, and prints the share of the
frames that are tracked with S >= 0.6 in both views.
"""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from common import config
from tritrack.offline import Decoders, track_clip
from tritrack.runs import write_run

PAIRS = (("cam01", "cam04"), ("cam03", "cam04"), ("cam02", "cam03"))
Y_UP = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Their world has z up; rows: our axes in theirs."""


def calibration(given: dict[str, Any]) -> dict[str, Any]:
    """Their `cameras.json` as ours: y up; their pixels have their centres at whole numbers."""
    cameras = []
    for camera in given["cameras"]:
        K = np.array(camera["K_video"])
        K[:2, 2] += 0.5
        R = np.array(camera["R_world_to_cam"]) @ Y_UP.T
        cameras.append(
            {
                "name": camera["name"],
                "K": K.tolist(),
                "R": R.tolist(),
                "t": camera["t_world_to_cam_m"],
                "distortion": camera["dist_qca"],
            }
        )
    width, height = given["cameras"][0]["video_size"]
    return {"width": width, "height": height, "fps": 60.0, "cameras": cameras}


SETTINGS = """calibration = "{out}/calibration.json"
size = "{size}"
every = {every}

[camera_1]
source = "{data}/{one}.mp4"
background = "{data}/bg_{one}.png"
calibrated_as = "{one}"

[camera_2]
source = "{data}/{two}.mp4"
background = "{data}/bg_{two}.png"
calibrated_as = "{two}"
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--size", default="240x427")
    parser.add_argument("--every", type=int, default=4, help="of 60 frames a second")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    rig = calibration(json.loads((asked.data / "cameras.json").read_text()))
    (asked.out / "calibration.json").write_text(json.dumps(rig))
    with Decoders() as decoders:
        for one, two in PAIRS:
            path = asked.out / f"{one}_{two}.toml"
            path.write_text(
                SETTINGS.format(
                    out=asked.out,
                    data=asked.data,
                    one=one,
                    two=two,
                    size=asked.size,
                    every=asked.every,
                )
            )
            settings = config.load(path)
            tracked = track_clip(settings, decoders)
            write_run(asked.out / path.stem, tracked.bodies, settings, tracked.facts)
            good = [body.status == "tracking" and min(body.score) >= 0.6 for body in tracked.bodies]
            print(f"{one} and {two}: {np.mean(good):.1%} of {len(good)} frames followed")


if __name__ == "__main__":
    main()
