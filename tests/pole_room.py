"""A room with poles and line markers as a known rig shows them, drawn as pictures of two films."""

from pathlib import Path
from typing import Final

import cv2
import numpy as np

from common.body.observation import Pixel
from common.rig.camera import Camera, paper_rig, project

SIZE: Final = (640, 480)
FOCALS_PX: Final = (620.0, 640.0)
DISTANCES_M: Final = (4.2, 3.9)
HEIGHTS_M: Final = (1.0, 1.05)
RIG: Final = paper_rig(SIZE, FOCALS_PX, DISTANCES_M, HEIGHTS_M)
PLACES_M: Final = ((0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, -1.0), (1.0, 1.0))
"""Where poles stand, x and z."""
POLE_M: Final = 2.2
FINE: Final = 16
"""Parts of a pixel that lines are drawn to."""


def tops_px(camera: Camera) -> list[Pixel]:
    """Of the poles, as a camera shows them."""
    return pixels(camera, [(x, POLE_M, z) for x, z in PLACES_M])


def marker_points(number: int) -> dict[str, list[tuple[float, float, float]]]:
    """Points of both markers of camera 1 or 2, three each, world, metres."""
    along, across, height_m = (-1.5, 0.0, 1.0), (-1.2, 0.2, 1.4), HEIGHTS_M[number - 1]
    if number == 1:
        floor = [(0.0, 0.0, z) for z in along]
        return {"floor": floor, "wall": [(x, height_m, -3.0) for x in across]}
    floor = [(-x, 0.0, 0.0) for x in along]
    return {"floor": floor, "wall": [(3.0, height_m, z) for z in across]}


def pixels(camera: Camera, points_m: list[tuple[float, float, float]]) -> list[Pixel]:
    """Where a camera shows points."""
    return [(float(u), float(v)) for u, v in project(camera, np.array(points_m))]


def drawn(camera: Camera, grey: int) -> np.ndarray:
    """The room in a camera's picture, (480, 640, 3): floor, wall, and poles with dark tops."""
    picture = np.full((SIZE[1], SIZE[0], 3), grey, np.uint8)
    far = pixels(camera, [(2.0 * a, 0.0, 2.0 * b) for a in (-1, 1) for b in (-1, 1)])
    picture[round(min(v for _, v in far)) :] = (60, 75, 85)
    for x, z in PLACES_M:
        foot, top = pixels(camera, [(x, 0.0, z), (x, POLE_M, z)])
        cv2.line(picture, fixed(foot), fixed(top), (210, 210, 210), 4, cv2.LINE_AA, 4)
        cv2.circle(picture, fixed(top), 3 * FINE, (40, 40, 200), -1, cv2.LINE_AA, 4)
    return picture


def fixed(at: Pixel) -> tuple[int, int]:
    """A place as OpenCV draws it, in sixteenths of a pixel from the first pixel's centre."""
    return round((at[0] - 0.5) * FINE), round((at[1] - 0.5) * FINE)


def write_films(folder: Path, count: int = 4) -> Path:
    """A clip folder with both films; each frame is a little lighter than that before."""
    folder.mkdir(parents=True, exist_ok=True)
    for camera in RIG.cameras:
        path = str(folder / f"{camera.name}.avi")
        writer = cv2.VideoWriter(path, cv2.VideoWriter.fourcc(*"MJPG"), 15.0, SIZE)
        for n in range(count):
            writer.write(drawn(camera, 100 + 15 * n))
        writer.release()
    return folder
