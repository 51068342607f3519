"""A camera that is turned in the middle of a clip: when that is noticed, and what it costs.

    python benchmarks/bumped_camera.py CLIP... [--turns 2 4 8] [--camera 2] [--at-s 15]

CLIP has a truth and a calibration that is named by --calibration (`benchmarks/joined_clips.py`
makes long ones). From --at-s on the film of a camera is turned about its own place, which is a
homography of its pictures (K R K^-1); what it did not show before repeats its border. Told are, by
lock-step: after how many seconds the camera was named, false names before that, mean error of the
joints before, and in the first seconds and later after it, with the rig as it is and with the rig
mended, and the mean confidence.
"""

import argparse
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from threadpoolctl import threadpool_limits

from common.body.body import JOINT_NAMES
from common.bus.messages import Body
from common.config.settings import Settings
from common.rig.camera import arrays_of
from common.rig.rig_file import load_rig
from runtime.offline.lockstep import Decoders, track_clip

SOON_S: Final = 2.0
"""Asked: by then it is noticed."""
HALF: Final = 0.5
BEST: Final = 100
AXIS: Final = (0.35, 1.0, 0.25)
"""About which it is turned: mostly to the side, a little up, a little rolled."""
JOINTS: Final = [n for n, name in enumerate(JOINT_NAMES) if "_" in name and name != "head_top"]


def bumped(
    clip: Path, out: Path, calibration: Path, camera: int, turn_deg: float, at_s: float
) -> None:
    """A copy of a clip whose camera is turned from a moment on; by 0 it is the clip."""
    shutil.copytree(clip, out)
    shutil.copy(calibration, out / "calibration.json")
    if not turn_deg:
        return
    K = arrays_of(load_rig(calibration).cameras[camera - 1]).K.copy()
    K[:2, 2] -= HALF
    axis = np.array(AXIS) / np.linalg.norm(AXIS)
    turn = cv2.Rodrigues(axis * np.radians(turn_deg))[0]
    shown = K @ turn @ np.linalg.inv(K)
    film = cv2.VideoCapture(str(clip / f"cam{camera}.avi"))
    fps = film.get(cv2.CAP_PROP_FPS)
    size = tuple(int(film.get(p)) for p in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT))
    code = cv2.VideoWriter.fourcc(*"MJPG")
    writer = cv2.VideoWriter(str(out / f"cam{camera}.avi"), code, fps, size)
    writer.set(cv2.VIDEOWRITER_PROP_QUALITY, BEST)
    for index in range(int(film.get(cv2.CAP_PROP_FRAME_COUNT))):
        _, picture = film.read()
        if index >= at_s * fps:
            how = {"flags": cv2.INTER_CUBIC, "borderMode": cv2.BORDER_REPLICATE}
            picture = cv2.warpPerspective(picture, shown, size, **how)
        writer.write(picture)
    writer.release()


def told(bodies: Sequence[Body], truth: Path, camera: int, at_s: float) -> str:
    """What came of a clip."""
    with np.load(truth) as known:
        names, real = known["joint_names"].tolist(), known["joints3d"]
    real = real[:, [names.index(JOINT_NAMES[n]) for n in JOINTS]]
    named = [b.captured_s for b in bodies if camera in b.moved and b.captured_s >= at_s]
    false = sum(bool(b.moved) for b in bodies if b.captured_s < at_s)
    false += sum(bool({*b.moved} - {camera}) for b in bodies if b.captured_s >= at_s)
    parts = [f"named after {named[0] - at_s:.2f} s" if named else "not named", f"false {false}"]
    for word, low, high in (
        ("before", 0.0, at_s),
        ("0-2 s", at_s, at_s + SOON_S),
        ("2-8 s", at_s + SOON_S, at_s + 8.0),
        ("later", at_s + 8.0, np.inf),
    ):
        ours = [b for b in bodies if b.joints_m and low <= b.captured_s < high]
        if not ours:
            continue
        off_m = [
            np.linalg.norm(np.array(b.joints_m)[JOINTS] - real[b.frame], axis=-1) for b in ours
        ]
        sure = np.mean([np.array(b.confidence)[JOINTS].mean() for b in ours])
        parts.append(f"{word} {1e3 * np.nanmean(off_m):.0f} mm ({sure:.2f})")
    return ", ".join(parts)


def main() -> None:
    """Turn, track and tell."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clips", nargs="+", type=Path)
    parser.add_argument("--calibration", type=Path, required=True)
    parser.add_argument("--turns", nargs="+", type=float, default=[0.0, 1.0, 2.0, 4.0, 8.0])
    parser.add_argument("--camera", type=int, default=2, choices=(1, 2))
    parser.add_argument("--at-s", type=float, default=15.0)
    parser.add_argument("--trust", action="store_true", help="the rig is left as it is")
    given = parser.parse_args()
    with Decoders() as decoders, tempfile.TemporaryDirectory() as scratch:
        for clip in given.clips:
            for turn_deg in given.turns:
                out = Path(scratch) / f"{clip.name}_{turn_deg:g}"
                bumped(clip, out, given.calibration, given.camera, turn_deg, given.at_s)
                settings = Settings(clip=str(out), trust_calibration=given.trust)
                done = track_clip(settings, decoders)
                print(
                    f"{clip.name} camera {given.camera} by {turn_deg:g} degrees:",
                    told(done.bodies, out / "truth.npz", given.camera, given.at_s),
                    flush=True,
                )
                for line in done.facts["warnings"]:
                    print("   ", line)
                shutil.rmtree(out)


if __name__ == "__main__":
    with threadpool_limits(1):
        main()
