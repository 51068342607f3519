"""What the loss of one camera costs: error before, during and after it, and signs of depth.

Run from the checkout: .venv/bin/python benchmarks/camera_loss.py CLIPS... [--lost 1|2] [--json]
"""

import argparse
import json
import os
import shutil
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NUMBA_NUM_THREADS", "1")

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from common.body.body import JOINT_NAMES
from common.bus.messages import Body
from common.config.settings import Settings
from common.video.clips import open_clip
from lab.accuracy.accuracy import JOINTS
from runtime.live.table import table_of_rows
from runtime.offline.lockstep import Decoders, track_clip

LOST_S: Final = 1.5
"""How long the camera is away (issue 5, Shows 4)."""
LOST_FROM: Final = 37
"""Half a second into the motion of a development clip, which is left half a second after it."""
OUT_DEG: Final = 15.0
"""How far a limb must be out of the image plane for its sign to count."""
LIMBS: Final = [
    (f"{side}_{upper}", f"{side}_{lower}")
    for side in "lr"
    for upper, lower in (
        ("shoulder", "elbow"),
        ("elbow", "wrist"),
        ("hip", "knee"),
        ("knee", "ankle"),
    )
]
Array = NDArray[np.float64]


class Measured(NamedTuple):
    """What the loss did in one clip."""

    errors_mm: dict[str, Array]
    """(frames, 12) before, during and after; NaN where there is no pose."""
    signs: Array
    """Of the limb-frames that are out of the image plane meanwhile: 1 where the depth is right."""
    gap: int
    """Most frames in a row without a pose, from the loss on."""
    measured_again: bool


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure clip after clip, print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clips", nargs="+", type=Path)
    parser.add_argument("--lost", type=int, choices=(1, 2), default=2, help="Which camera.")
    parser.add_argument("--mode", choices=("default", "paper"), default="default")
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args(arguments)
    found = {}
    with Decoders() as decoders, tempfile.TemporaryDirectory() as room:
        for clip in given.clips:
            holed = with_hole(clip, Path(room) / clip.name, given.lost)
            bodies = track_clip(Settings(clip=str(holed), mode=given.mode), decoders).bodies
            found[clip.name] = measured(bodies, clip, given.lost)
            shutil.rmtree(holed)
    rows = [row_of(name, [one]) for name, one in found.items()]
    rows.append(row_of("all", list(found.values())))
    if given.json:
        sys.stdout.write(json.dumps(rows, indent=1) + "\n")
    else:
        Console(width=120).print(table_of_rows(rows))


def with_hole(clip: Path, folder: Path, lost: int) -> Path:
    """The clip without some frames of one camera, and when the others were taken; lossless."""
    shutil.copytree(clip, folder)
    shutil.copy(clip.parent / "calibration.json", folder)
    video = folder / f"cam{lost}.avi"
    film = film_of(video)
    meta = json.loads((folder / "meta.json").read_text())
    away = range(LOST_FROM, LOST_FROM + round(LOST_S * meta["fps"]))
    kept = [i for i in range(len(film)) if i not in away]
    height, width = film[0].shape[:2]
    writer = cv2.VideoWriter(
        str(video), cv2.VideoWriter.fourcc(*"FFV1"), meta["fps"], (width, height)
    )
    for i in kept:
        writer.write(film[i])
    writer.release()
    meta["capture_s"] = {f"cam{lost}": [i / meta["fps"] for i in kept]}
    (folder / "meta.json").write_text(json.dumps(meta))
    return folder


def film_of(video: Path) -> list[Any]:
    """All frames of a video."""
    capture = cv2.VideoCapture(str(video))
    film: list[Any] = []
    while True:
        came, frame = capture.read()
        if not came:
            return film
        film.append(frame)


def measured(bodies: Sequence[Body], clip: Path, lost: int) -> Measured:
    """Bodies against the clip's truth."""
    meta = json.loads((clip / "meta.json").read_text())
    camera = open_clip(Settings(clip=str(clip)), numbers=(2 if lost == 1 else 1,)).rig
    assert camera is not None
    with np.load(clip / "truth.npz") as truth:
        names = [str(name) for name in truth["joint_names"]]
        real = np.asarray(truth["joints3d"], np.float64)[:, [names.index(j) for j in JOINTS]]
        motion = np.flatnonzero(truth["phase"] == 3)
    guess = np.full((len(real), len(JOINTS), 3), np.nan)
    status = [""] * len(real)
    for body in bodies:
        at = round(body.captured_s * meta["fps"])
        if at < len(guess) and body.joints_m:
            guess[at] = np.array(body.joints_m)[[JOINT_NAMES.index(j) for j in JOINTS]]
            status[at] = body.status
    end = LOST_FROM + round(LOST_S * meta["fps"])
    errors = 1000 * np.linalg.norm(guess - real, axis=2)
    parts = {"before": slice(motion[0], LOST_FROM), "during": slice(LOST_FROM, end)}
    parts["after"] = slice(end, len(real))
    return Measured(
        {name: errors[part] for name, part in parts.items()},
        signs_of(guess[parts["during"]], real[parts["during"]], np.array(camera.cameras[0].R)[2]),
        longest(np.isnan(errors[LOST_FROM:]).any(axis=1)),
        "measuring" in status[LOST_FROM:],
    )


def signs_of(guess: Array, real: Array, forward: Array) -> Array:
    """1 where a limb points to the right side of the image plane, 0 where it does not.

    Args:
        guess: (frames, 12, 3), metres.
        real: The same of the truth.
        forward: The way the remaining camera looks, (3,).
    """
    right = []
    for upper, lower in LIMBS:
        a, b = JOINTS.index(upper), JOINTS.index(lower)
        limb, found = real[:, b] - real[:, a], guess[:, b] - guess[:, a]
        out = np.degrees(np.arcsin(limb @ forward / np.linalg.norm(limb, axis=1)))
        counts = np.abs(out) > OUT_DEG
        right.append((np.sign(found @ forward) == np.sign(out))[counts])
    return np.concatenate(right).astype(np.float64)


def longest(missing: NDArray[np.bool_]) -> int:
    """Length of the longest run of True."""
    best = run = 0
    for one in missing:
        run = run + 1 if one else 0
        best = max(best, run)
    return best


def row_of(name: str, found: Sequence[Measured]) -> dict[str, object]:
    """One line of the table."""
    means = {
        f"{part} mm": round(float(np.nanmean(np.concatenate([f.errors_mm[part] for f in found]))))
        for part in ("before", "during", "after")
    }
    signs = np.concatenate([one.signs for one in found])
    return {
        "name": name,
        **means,
        "limb-frames": len(signs),
        "signs right": float(signs.mean()) if len(signs) else float("nan"),
        "longest gap": max(one.gap for one in found),
        "measured again": any(one.measured_again for one in found),
    }


if __name__ == "__main__":
    main()
