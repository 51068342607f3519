"""Runs of two made-up videos: each picture tells its camera and its number by its grey."""

from pathlib import Path

import cv2
import msgspec
import numpy as np

from common.body.body import ANGLES_IN_POSE, Vector
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import Body, Status
from common.config.part_settings import CameraSettings
from common.config.settings import Settings
from common.npz_file import Facts
from runtime.store.runs import write_run

HZ = 10.0
SIZE = (160, 120)
BODY = body_vector(thesis_bdp(1.7))
TRUST: Facts = {
    "believed": True,
    **{"apart_mm": 21.4, "apart_px": 2.1, "late_frames": 0.1, "soles_mm": -8.0},
    **{"stature_m": 1.71, "facing_deg": 3.0, "motion_mm": 12.0, "moments": 40},
    "odd": [],
    "advice": "",
}


def grey_of(camera: int, frame: int) -> int:
    """The grey of a picture: even tens by camera 1, odd ones by camera 2."""
    return 20 * frame + 10 * camera


def video(path: Path, camera: int, count: int) -> None:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), HZ, SIZE)
    for n in range(count):
        writer.write(np.full((SIZE[1], SIZE[0], 3), grey_of(camera, n), np.uint8))
    writer.release()


def body(
    frame: int, pose: Vector | None, status: Status = "tracking", sure: float = 0.9, person: int = 0
) -> Body:
    """A body in a pose; None: none, though a person is seen."""
    whole: Facts = {
        "frame": frame,
        "captured_s": frame / HZ,
        "clock_s": frame / HZ,
        "person": person,
    }
    seen = status != "empty"
    if pose is None:
        return Body(**whole, status=status, views="both" if seen else "none", seen=(seen, seen))
    return Body(
        **whole,
        status=status,
        views="both",
        seen=(True, True),
        score=(0.8, 0.7),
        joints_m=tuple((x, y, z) for x, y, z in joints(BODY, pose).tolist()),
        joints_px=(tuple((40.0 + n, 60.0) for n in range(15)),) * 2,
        pose=tuple(pose.tolist()),
        angles_raw_deg=tuple(pose[list(ANGLES_IN_POSE)].tolist()),
        confidence=(sure,) * 15,
    )


def written(folder: Path, bodies: list[Body], late_s: float = 0.0, **facts: object) -> Path:
    """A run of these bodies, beside its two videos of ten pictures each."""
    clip = folder / "clip"
    clip.mkdir(parents=True, exist_ok=True)
    cameras = {}
    for camera in (1, 2):
        path = clip / f"cam{camera}.avi"
        video(path, camera, 10)
        cameras[f"cam{camera}"] = CameraSettings(source=str(path))
    clock = {"state": "found", "applied_s": late_s, "may_be_s": [], "may_be_on_time": True}
    told = {"cameras": ["cam1", "cam2"], "scale_source": "calibrated", "trust": TRUST}
    settings = msgspec.structs.replace(Settings(size="160x120"), cameras=cameras)
    write_run(folder / "run", bodies, settings, {**told, "clock": clock, "warnings": [], **facts})
    return folder / "run"
