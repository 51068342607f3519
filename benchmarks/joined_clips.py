"""Several clips of one person and one rig as one long clip.

    python benchmarks/joined_clips.py OUT CLIP...

The first clip is taken whole, of the others what follows their empty room. The person may jump
where two meet. The joined clip has its truth and no calibration.
"""

import json
import sys
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np

CAMERAS: Final = ("cam1", "cam2")
BEST: Final = 100
"""Quality of the pictures, in percent: they were compressed before."""


def joined(out: Path, clips: list[Path]) -> None:
    """Write the folder."""
    out.mkdir(parents=True)
    truths = [dict(np.load(clip / "truth.npz")) for clip in clips]
    firsts = [0, *(int(np.argmax(truth["present"])) for truth in truths[1:])]
    for camera in CAMERAS:
        _join_films(out / f"{camera}.avi", [clip / f"{camera}.avi" for clip in clips], firsts)
    parts = [truth["joints3d"][first:] for truth, first in zip(truths, firsts, strict=True)]
    joints_m = np.concatenate(parts)
    np.savez(
        out / "truth.npz",
        joints3d=joints_m,
        joint_names=truths[0]["joint_names"],
        present=np.isfinite(joints_m).all(axis=(1, 2)),
        frames_cam1=np.arange(len(joints_m)),
        frames_cam2=np.arange(len(joints_m)),
    )
    meta = json.loads((clips[0] / "meta.json").read_text())
    kept = {name: meta[name] for name in ("performer", "fps", "measures") if name in meta}
    (out / "meta.json").write_text(json.dumps(kept))


def _join_films(out: Path, films: list[Path], firsts: list[int]) -> None:
    writer: Any = None
    for film, first in zip(films, firsts, strict=True):
        reader = cv2.VideoCapture(str(film))
        for index in range(int(reader.get(cv2.CAP_PROP_FRAME_COUNT))):
            _, picture = reader.read()
            if writer is None:
                size = (picture.shape[1], picture.shape[0])
                fps = reader.get(cv2.CAP_PROP_FPS)
                writer = cv2.VideoWriter(str(out), cv2.VideoWriter.fourcc(*"MJPG"), fps, size)
                writer.set(cv2.VIDEOWRITER_PROP_QUALITY, BEST)
            if index >= first:
                writer.write(picture)
    writer.release()


if __name__ == "__main__":
    joined(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
