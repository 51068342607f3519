"""The files of a followed video that are looked at or animated: curves, background, BVH."""

from importlib.util import find_spec
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from animator.bvh import bvh_text, steady
from animator.even_steps import NoMotion
from animator.inbetween import at, between, key_frames
from animator.skeleton.bones import joints_of
from common.atomic_file import replacing
from common.body.body import JOINT_NAMES
from common.npz_file import Arrays
from runtime.store.joint_arrays import all_joints_m
from runtime.store.runs import unwritable
from runtime.terminal import json_text
from tritrack.single.angle_plot import angle_plot
from viewer.background.background import Background

NAMES: Final = (
    *("angles.png", "background.png"),
    *("body.bvh", "keyframes.bvh", "keyframes.json"),
)
"""What is written where there is something to write."""
FLAG: Final = (0, 0, 255)
"""Pixels that were never uncovered are hatched in this colour."""


def write_files(folder: Path, arrays: Arrays, background: Background | None) -> list[str]:
    """Write the angles' curves where matplotlib is, the background if any, and the animation.

    None of an earlier run stays: who opens the folder would take it for this one's.

    Args:
        folder: Of the run.
        arrays: Of its `poses.npz`.
        background: None of a sequence of masks.

    Returns:
        What stood in the way of an animation.

    Raises:
        RunError: When a file cannot be written.
    """
    try:
        for name in NAMES:
            (folder / name).unlink(missing_ok=True)
        if find_spec("matplotlib") is not None:
            _write(folder / "angles.png", angle_plot(arrays))
        if background is not None:
            _write(folder / "background.png", cv2.imencode(".png", marked(background))[1].tobytes())
        return _animate(folder, arrays)
    except OSError as error:
        raise unwritable(folder, error) from error


def marked(background: Background) -> NDArray[np.uint8]:
    """The background, what was never uncovered hatched."""
    picture = np.clip(np.rint(background.centre), 0, 255).astype(np.uint8)
    rows, columns = np.indices(background.uncertain.shape)
    picture[background.uncertain & ((rows + columns) % 4 < 2)] = FLAG
    return picture


def _animate(folder: Path, arrays: Arrays) -> list[str]:
    """Write the animation and that of the key frames alone; what stood in the way."""
    try:
        skeleton, motion, steps = steady(all_joints_m(arrays), arrays["time_s"])
    except NoMotion as error:
        return [f"there is no animation: {error}"]
    rows = steps.nearest()
    clarity = np.where(steps.seen, arrays["confidence"][rows].mean(axis=1), np.nan)
    keys = key_frames(clarity)
    drawn = between(keys, at(motion, keys), np.arange(steps.frames))
    off_m = np.linalg.norm(joints_of(skeleton, drawn) - joints_of(skeleton, motion), axis=2)
    off_m = off_m[:, : len(JOINT_NAMES)]
    told = {
        "frames": arrays["frame"][rows[keys]].tolist(),
        "of": steps.frames,
        "keyframes.bvh": "interpolated between these frames; body.bvh has every frame",
        "interpolated": steps.frames - len(keys),
        "off_body_bvh_mm": {
            "median": round(1e3 * float(np.median(off_m)), 2),
            "p95": round(1e3 * float(np.percentile(off_m, 95)), 2),
        },
    }
    _write(folder / "body.bvh", bvh_text(skeleton, motion, steps.step_s).encode())
    _write(folder / "keyframes.bvh", bvh_text(skeleton, drawn, steps.step_s).encode())
    _write(folder / "keyframes.json", f"{json_text(told)}\n".encode())
    return []


def _write(path: Path, content: bytes) -> None:
    with replacing(path) as new:
        new.write_bytes(content)
