"""Cameras that lie on a side or hang upside down, and what they film of a clip."""

from pathlib import Path
from typing import Final

import cv2
import msgspec
import numpy as np

from common.rig.camera import Camera, Rig, as_matrix, as_row
from common.rig.rig_file import load_rig

LEFT: Final = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Of a camera's axes, where its picture is turned by a quarter counter-clockwise: what was to the
right is above."""


def lying(camera: Camera, size: tuple[int, int], quarters: int) -> Camera:
    """A camera whose picture of this size lies turned by quarters counter-clockwise.

    The pixel (u, v) of a picture w wide goes to (v, w - u).
    """
    (wide, high), (f, g) = size, (camera.K[0][0], camera.K[1][1])
    (u, v), R, t = (camera.K[0][2], camera.K[1][2]), np.array(camera.R), np.array(camera.t)
    for _ in range(quarters):
        (u, v), (f, g), (wide, high) = (v, wide - u), (g, f), (high, wide)
        R, t = LEFT @ R, LEFT @ t
    K = ((f, 0.0, u), (0.0, g, v), (0.0, 0.0, 1.0))
    return Camera(camera.name, K, as_matrix(R), as_row(t), camera.distortion)


def filmed_lying(clip: Path, folder: Path, quarters: tuple[int, int]) -> Path:
    """A clip as cameras film it that lie so, without any loss, with its calibration."""
    folder.mkdir()
    rig = load_rig(clip.parent / "calibration.json")
    size = (rig.width, rig.height)
    for n, each in enumerate(quarters, 1):
        _turned_film(clip / f"cam{n}.avi", folder / f"cam{n}.avi", each)
    cameras = [lying(each, size, turn) for each, turn in zip(rig.cameras, quarters, strict=True)]
    (folder / "calibration.json").write_bytes(msgspec.json.encode(_told(rig, cameras, quarters)))
    return folder


def _told(rig: Rig, cameras: list[Camera], quarters: tuple[int, int]) -> Rig:
    size = (rig.width, rig.height)
    width, height = size[::-1] if quarters[0] % 2 else size
    return msgspec.structs.replace(rig, width=width, height=height, cameras=tuple(cameras))


def _turned_film(source: Path, out: Path, quarters: int) -> None:
    film = cv2.VideoCapture(str(source))
    frames = []
    while (got := film.read())[0]:
        frames.append(np.ascontiguousarray(np.rot90(got[1], quarters)))
    height, width = frames[0].shape[:2]
    written = cv2.VideoWriter(str(out), cv2.VideoWriter.fourcc(*"FFV1"), 15.0, (width, height))
    for frame in frames:
        written.write(frame)
    written.release()
