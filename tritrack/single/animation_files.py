"""Files of a tracked video for viewing or animation: curves, background, BVH."""

from importlib.util import find_spec
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from animator.bvh import bvh_text, steady
from animator.even_steps import NoMotion
from animator.inbetween import at, between, kept_within, key_frames
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
"""The written files; each is optional."""
MOST_OFF_M: Final = 0.010
"""How far a joint of `keyframes.bvh` may be from `body.bvh`, metres."""
FLAG: Final = (0, 0, 255)
"""Colour of the hatching over pixels that were never uncovered."""


def write_files(folder: Path, arrays: Arrays, background: Background | None) -> list[str]:
    """Write the angles' curves where matplotlib is installed, the background if any, and the
    animation.

    Files of an earlier run are removed: they could be taken for this run's.

    Args:
        folder: The run's folder.
        arrays: The arrays of its `poses.npz`.
        background: None for a sequence of masks.

    Returns:
        Why there is no animation; "" where there is one.

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
    """The background, with never uncovered pixels hatched."""
    picture = np.clip(np.rint(background.centre), 0, 255).astype(np.uint8)
    rows, columns = np.indices(background.uncertain.shape)
    picture[background.uncertain & ((rows + columns) % 4 < 2)] = FLAG
    return picture


def _animate(folder: Path, arrays: Arrays) -> list[str]:
    """Write the animation and that of the key frames alone; why not, if impossible."""
    try:
        skeleton, motion, steps = steady(all_joints_m(arrays), arrays["time_s"])
    except NoMotion as error:
        return [f"there is no animation: {error}"]
    rows = steps.nearest()
    clarity = np.where(steps.seen, arrays["confidence"][rows].mean(axis=1), np.nan)
    keys = kept_within(skeleton, motion, key_frames(clarity), MOST_OFF_M)
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
            "most": round(1e3 * float(off_m.max()), 2),
        },
    }
    _write(folder / "body.bvh", bvh_text(skeleton, motion, steps.step_s).encode())
    _write(folder / "keyframes.bvh", bvh_text(skeleton, drawn, steps.step_s).encode())
    _write(folder / "keyframes.json", f"{json_text(told)}\n".encode())
    return []


def _write(path: Path, content: bytes) -> None:
    with replacing(path) as new:
        new.write_bytes(content)
