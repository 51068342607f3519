"""Clips that are wrong in one way each, made from a good one; shared by tests."""

import json
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np

from common.config.part_settings import CameraSettings
from common.config.settings import Settings

Film = list[np.ndarray]


def copied(clip: Path, folder: Path) -> Path:
    """The clip with its calibration, to spoil."""
    shutil.copytree(clip, folder)
    shutil.copy(clip.parent / "calibration.json", folder)
    return folder


def changed(path: Path) -> None:
    """The last byte of a file is another."""
    path.write_bytes(path.read_bytes()[:-1] + b"?")


def film_of(video: Path) -> Film:
    capture = cv2.VideoCapture(str(video))
    film: Film = []
    while True:
        came, frame = capture.read()
        if not came:
            return film
        film.append(frame)


def write_video(video: Path, film: Sequence[np.ndarray], fps: float = 15.0) -> None:
    height, width = film[0].shape[:2]
    writer = cv2.VideoWriter(str(video), cv2.VideoWriter.fourcc(*"MJPG"), fps, (width, height))
    for frame in film:
        writer.write(frame)
    writer.release()


def write_uneven(video: Path, film: Sequence[np.ndarray], ticks: Sequence[int], hz: int) -> None:
    """A film in MP4, MOV or MKV whose frames are to be shown at whole numbers of ticks."""
    height, width = film[0].shape[:2]
    code, packets = cv2.VideoWriter.fourcc(*"MJPG"), [cv2.VIDEOWRITER_PROP_RAW_VIDEO, 1]
    writer = cv2.VideoWriter(str(video), cv2.CAP_FFMPEG, code, hz, (width, height), packets)
    for frame, tick in zip(film, ticks, strict=True):
        writer.set(cv2.VIDEOWRITER_PROP_PTS, int(tick))
        writer.write(cv2.imencode(".jpg", frame)[1])
    writer.release()


def refilmed(folder: Path, change: Callable[[Film], Film], cameras: Sequence[int] = (1, 2)) -> None:
    for number in cameras:
        video = folder / f"cam{number}.avi"
        write_video(video, change(film_of(video)))


def edit_json(path: Path, change: Callable[[dict[str, Any]], object]) -> None:
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def missing(folder: Path) -> None:
    (folder / "cam1.avi").unlink()
    (folder / "cam2.avi").unlink()


def empty(folder: Path) -> None:
    (folder / "cam2.avi").write_bytes(b"")


def without_head(folder: Path) -> None:
    video = folder / "cam1.avi"
    video.write_bytes(video.read_bytes()[4000:])


def head_alone(folder: Path) -> None:
    video = folder / "cam1.avi"
    video.write_bytes(video.read_bytes()[:150])


def no_video(folder: Path) -> None:
    (folder / "cam1.avi").write_text("once upon a time\n" * 50)


def no_rotation(folder: Path) -> None:
    edit_json(folder / "calibration.json", lambda rig: rig["cameras"][0]["R"][0].reverse())


def wrong_size(folder: Path) -> None:
    edit_json(folder / "calibration.json", lambda rig: rig.update(width=999))


def no_calibration(folder: Path) -> None:
    (folder / "calibration.json").write_text("[1, 2")


def broken_meta(folder: Path) -> None:
    (folder / "meta.json").write_text("{")


REFUSED: dict[str, tuple[Callable[[Path], None], str]] = {
    "missing": (missing, "neither cam1.* nor cam2.*: name the videos so"),
    "empty": (empty, "cam2.avi is empty: copy or record it again"),
    "truncated at the head": (without_head, "cam1.avi is no AVI from its first byte"),
    "only its head": (head_alone, "cam1.avi gives no picture: convert it"),
    "undecodable": (no_video, "cam1.avi gives no picture: convert it"),
    "R not orthonormal": (no_rotation, "R of camera cam1 is no rotation .*calibrate again"),
    "wrong image size": (wrong_size, "is for 999x120 pictures, the clip has 160x120"),
    "calibration that is none": (no_calibration, "calibration.json is no calibration"),
    "broken meta.json": (broken_meta, "cannot read .*meta.json .*mend it"),
}
"""What contradicts itself or cannot be read: how to do it to a clip, and what is said."""


def shorter(folder: Path) -> None:
    refilmed(folder, lambda film: film[:50], cameras=(2,))


def larger(folder: Path) -> None:
    (folder / "calibration.json").unlink()
    refilmed(folder, lambda film: [cv2.resize(frame, (320, 240)) for frame in film], cameras=(2,))


def never_empty(folder: Path) -> None:
    refilmed(folder, lambda film: film[9:])


def no_opening_posture(folder: Path) -> None:
    refilmed(folder, lambda film: film[:9] + film[29:])


def uncalibrated(folder: Path) -> None:
    (folder / "calibration.json").unlink()


def partly_outside(folder: Path, px: int = 70) -> None:
    """Both pictures lack so many columns at their left, and the calibration knows."""

    def shifted(frame: np.ndarray) -> np.ndarray:
        return np.pad(frame[:, px:], ((0, 0), (0, px), (0, 0)), mode="edge")

    def known(rig: dict[str, Any]) -> None:
        for camera in rig["cameras"]:
            camera["K"][0][2] -= px

    refilmed(folder, lambda film: [shifted(frame) for frame in film])
    edit_json(folder / "calibration.json", known)


def damage(video: Path, size: int = 4000) -> Path:
    """So many bytes of it are noise, from three tenths on."""
    content = bytearray(video.read_bytes())
    start = 3 * len(content) // 10
    content[start : start + size] = np.random.default_rng(1).bytes(size)
    video.write_bytes(content)
    return video


def cut_off(folder: Path) -> None:
    video = folder / "cam2.avi"
    video.write_bytes(video.read_bytes()[: video.stat().st_size // 2])


def odd_capture_times(folder: Path) -> None:
    edit_json(
        folder / "meta.json",
        lambda meta: meta.update(capture_s={"cam1": [i / 15 for i in range(60)]}),
    )


WORKED_WITH: dict[str, tuple[Callable[[Path], None], str]] = {
    "other length": (shorter, "differ in length: 69 and 50 frames"),
    "other size": (larger, "differ in size: 160x120 and 320x240"),
    "no empty frames": (never_empty, "cam1.avi does not open with an empty room: the background"),
    "no T-pose": (no_opening_posture, "nobody took the opening posture, .*thesis's proportions"),
    "no calibration": (uncalibrated, "no calibration: the cameras are calibrated by the person"),
    "partly outside": (partly_outside, "viewer 1 saw the person partly outside its picture"),
    "capture times": (odd_capture_times, "60 capture times for camera 1, .* has 69 frames"),
}
"""What can be worked with: how to do it to a clip, and the warning."""


def of_one_view(settings: Settings, view: int) -> Settings:
    """Settings of one camera of a clip, which a folder of two does not mean."""
    camera = CameraSettings(source=f"{settings.clip}/cam{view}.avi")
    return msgspec.structs.replace(settings, clip="", cameras={f"cam{view}": camera})
