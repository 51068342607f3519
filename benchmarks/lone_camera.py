"""How exact a body is that camera 1 of clips with a truth sees alone (T19-T22).

Run from the checkout: .venv/bin/python benchmarks/lone_camera.py CLIPS... [--calibrated]
[--mode default|thesis] [--size 320x240]

In the picture: mean distance of 12 joints over the body's height, %; then inner angles, degrees,
joints after the hips are moved together, mm, and limbs more than 15 degrees out of the picture's
plane whose sign of depth is right.
"""

import argparse
import os
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import cv2
import msgspec
import numpy as np
from camera_loss import signs_of
from rich.console import Console
from threadpoolctl import threadpool_limits

from common.config.config_file import load
from common.method import METHODS
from common.rig.camera import Camera
from common.video.clips import open_clip
from common.video.decoding import Decoder
from lab.accuracy.accuracy import compare, picked, summary
from runtime.live.table import table_of_rows
from runtime.offline.video_tracking import VideoInput, follow_clip
from runtime.overrides import overridden
from runtime.steps.frame_cache import FrameCache
from runtime.store.pose_arrays import poses
from viewer.room.background_source import background_of_film


def row_of(path: Path, camera: Camera, found: dict[str, Any], width: int) -> dict[str, Any]:
    """The figures of one clip that was followed in pictures of a width."""
    with np.load(path / "truth.npz", allow_pickle=False) as file:
        truth = dict(file)
    compared = compare(found, truth)
    told = summary([compared])
    times = width / int(truth["mask_shape"][1])
    at = np.searchsorted(found["frame"], compared.frames)
    seen_px = picked(found["joints_px"][:, 0], found["joint_names"])[at]
    true_px = times * picked(truth["joints2d_cam1"], truth["joint_names"])[compared.rows]
    standing = np.unpackbits(truth["mask_cam1"][compared.rows[0]], axis=1).any(axis=1)
    tall_px = times * np.ptp(np.flatnonzero(standing))
    signs = signs_of(compared.tracked_m, compared.true_m, np.array(camera.R)[2])
    return {
        "name": path.name,
        "in picture %": 100 * np.linalg.norm(seen_px - true_px, axis=2).mean() / tall_px,
        "inner deg": told["angle_deg"]["all"],
        "root mm": told["root_mm"]["mean"],
        "signs": signs.mean() if len(signs) else np.nan,
        "limb-frames": len(signs),
    }


def main() -> None:
    cv2.setNumThreads(1)
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clips", nargs="+", type=Path, help="calibrated clip folders with a truth")
    parser.add_argument("--calibrated", action="store_true", help="use the clips' calibration")
    parser.add_argument("--mode", choices=("default", "thesis"), default="default")
    parser.add_argument("--size", default="320x240", help="of the working picture")
    given = parser.parse_args()
    rows: list[dict[str, Any]] = []
    with Decoder() as decoder:
        for path in given.clips:
            settings = overridden(load(path), given.mode, given.size)
            clip = open_clip(settings, decoder, (1,))
            assert clip.rig is not None, f"{path} has no calibration to hold the truth against"
            camera, width = clip.rig.cameras[0], clip.views[0].size[0]
            clip = clip if given.calibrated else msgspec.structs.replace(clip, rig=None)
            background = background_of_film(clip.views[0], settings.silhouette, FrameCache(decoder))
            film, method = VideoInput(clip, background), METHODS[settings.mode]
            found = poses(follow_clip(film, settings, method, decoder).bodies)
            rows.append(row_of(path, camera, found, width))
    weights = np.array([row["limb-frames"] for row in rows])
    mean = {key: np.nanmean([row[key] for row in rows]) for key in rows[0] if key != "name"}
    mean["signs"] = np.nansum([row["signs"] for row in rows] * weights) / weights.sum()
    Console().print(table_of_rows([*rows, {"name": "all", **mean}]))


if __name__ == "__main__":
    with threadpool_limits(1):
        main()
