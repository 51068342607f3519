"""Films of a printed board by cameras that are known: lenses that bend, blur, noise."""

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from calibration.board.board import Board, black_cells
from common.body.body import Vector
from common.rig.camera import Camera, arrays_of, as_matrix, as_row, project, ray

TEXELS = 40
"""Of a square's side, in the board's picture."""
FINER = 2
"""Rays across a pixel."""
MARGIN = 0.5
"""White paper round the squares, in squares."""


class Pose(NamedTuple):
    """Where a board is: X = turn @ place + middle_m, of places from its middle."""

    turn: Vector
    middle_m: Vector


def board_picture(board: Board) -> NDArray[np.uint8]:
    """Its print with the paper's margin, grey; drawn from the same cells as the PDF."""
    size = [round((side + 2 * MARGIN) * TEXELS) for side in (board.rows, board.columns)]
    picture = np.full(size, 235, np.uint8)
    for left, top, width, height in black_cells(board):
        x, y, right, bottom = (
            round((edge + MARGIN) * TEXELS) for edge in (left, top, left + width, top + height)
        )
        picture[y:bottom, x:right] = 25
    return picture


class Studio:
    """One camera, and what it sees behind the board."""

    def __init__(self, camera: Camera, size: tuple[int, int], seed: int) -> None:
        self.camera, self.size = camera, size
        self.random = np.random.default_rng(seed)
        coarse = self.random.integers(60, 200, (12, 16), np.uint8)
        self.room = cv2.resize(coarse, size, interpolation=cv2.INTER_CUBIC).astype(np.float32)
        self.straight = _straight(camera, size)

    def picture(
        self, board: Board, pose: Pose | None, blur_px: float = 0.6, noise: float = 2.5
    ) -> NDArray[np.uint8]:
        """(height, width, 3) of the room with a board in it, or without."""
        scene = self.room.copy()
        if pose is not None:
            self._lay(scene, board, pose)
        scene = cv2.GaussianBlur(scene, (0, 0), blur_px)
        scene += noise * self.random.standard_normal(scene.shape, np.float32)
        grey = np.clip(np.round(scene), 0, 255).astype(np.uint8)
        return np.asarray(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR))

    def _lay(self, scene: NDArray[np.float32], board: Board, pose: Pose) -> None:
        """Draw a board whose front is seen, by a ray for each part of each pixel that shows it."""
        R, t = arrays_of(self.camera).R, arrays_of(self.camera).t
        turn, middle = R @ pose.turn, R @ pose.middle_m + t
        box = self._box(board, turn, middle)
        if box is None or turn[:, 2] @ middle <= 0:
            return
        left, top, right, bottom = box
        straight = self.straight[top * FINER : bottom * FINER, left * FINER : right * FINER]
        shape, straight = straight.shape, straight.reshape(-1, 2)
        to_board = np.linalg.inv(np.column_stack([turn[:, 0], turn[:, 1], middle]))
        on_board = np.column_stack([straight, np.ones(len(straight))]) @ to_board.T
        places = on_board[:, :2] / on_board[:, 2:] / board.square_m
        corner = np.array([board.columns, board.rows]) / 2 + MARGIN
        texels = (places + corner) * TEXELS - 0.5
        onto = texels.reshape(shape).astype(np.float32)
        printed, onto = _at_scale(board, onto)
        seen = cv2.remap(printed, onto, None, cv2.INTER_LINEAR, None, cv2.BORDER_CONSTANT, 0)
        seen = seen.astype(np.float32)
        seen = cv2.resize(seen, (right - left, bottom - top), interpolation=cv2.INTER_AREA)
        part = scene[top:bottom, left:right]
        part *= 1 - seen[..., 1] / 255
        part += seen[..., 0]

    def _box(self, board: Board, turn: Vector, middle: Vector) -> tuple[int, int, int, int] | None:
        """Left, top, right and bottom of what shows it; None of what the picture does not."""
        half = np.array([board.columns, board.rows]) / 2 + MARGIN
        rim = [(x, y, 0.0) for x in np.linspace(-1, 1, 9) for y in np.linspace(-1, 1, 9)]
        points = np.array(rim) * [*half, 0.0] * board.square_m @ turn.T + middle
        if points[:, 2].min() < 0.1:
            return None
        here = self.camera
        ahead = Camera(here.name, here.K, as_matrix(np.eye(3)), (0.0, 0.0, 0.0), here.distortion)
        pixels = project(ahead, points)
        left, top = np.clip(np.floor(pixels.min(axis=0)) - 2, 0, self.size).astype(int).tolist()
        right, bottom = np.clip(np.ceil(pixels.max(axis=0)) + 2, 0, self.size).astype(int).tolist()
        return (left, top, right, bottom) if right - left > 2 and bottom - top > 2 else None


@lru_cache(maxsize=4)
def _straight(camera: Camera, size: tuple[int, int]) -> NDArray[np.float64]:
    """(FINER h, FINER w, 2) where each part of each pixel looks, 1 m ahead."""
    width, height = size
    rows, columns = np.mgrid[: height * FINER, : width * FINER]
    pixels = (np.stack([columns, rows], axis=-1).reshape(-1, 1, 2) + 0.5) / FINER
    bent, K = np.array(camera.distortion), arrays_of(camera).K
    rounds = (cv2.TERM_CRITERIA_COUNT, 30, 0.0)
    found = cv2.undistortPoints(pixels, K, bent, None, None, None, rounds)
    return np.asarray(found.reshape(height * FINER, width * FINER, 2), np.float64)


def _at_scale(
    board: Board, texels: NDArray[np.float32]
) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """The print at the scale at which it is looked at, its share of paper beside it."""
    printed = board_picture(board)
    printed = np.stack([printed, np.full_like(printed, 255)], axis=-1)
    steps = np.linalg.norm(np.diff(texels, axis=1), axis=-1)
    coarse = float(np.median(steps))
    if coarse <= 1:
        return printed, texels
    small_size = (round(printed.shape[1] / coarse), round(printed.shape[0] / coarse))
    small = cv2.resize(printed, small_size, interpolation=cv2.INTER_AREA)
    ratio = np.array([small.shape[1] / printed.shape[1], small.shape[0] / printed.shape[0]])
    return small, ((texels + 0.5) * ratio - 0.5).astype(np.float32)


class FilmedRig(NamedTuple):
    """Cameras, and the poses in which a board is held before them."""

    cameras: tuple[Camera, Camera]
    size: tuple[int, int]
    board: Board
    poses: tuple[Pose, ...]
    """The last ones on the floor."""


def random_rig(seed: int, size: tuple[int, int], board: Board, holds: int = 48) -> FilmedRig:
    """Two cameras 50 to 100 degrees apart, 2.4 m high pictures of the middle, tilted and rolled."""
    random = np.random.default_rng(seed)
    width, height = size
    yaw = np.radians(random.uniform(50, 100))
    cameras = []
    for n, bearing in enumerate((0.0, -yaw)):
        focal_px = width * random.uniform(0.8, 1.25)
        far_m = 2.3 * focal_px / height
        high_m = random.uniform(1.2, 2.0)
        at = np.array([far_m * np.sin(bearing), high_m, far_m * np.cos(bearing)])
        # Camera 1 has no yaw: its own sight says where z is.
        aim = np.array([0.0, random.uniform(0.8, 1.0), 0.0])
        R = looking(at, aim, random.normal(0, 0.03))
        K = (
            (focal_px, 0.0, width / 2 + random.normal(0, 0.008 * width)),
            (0.0, focal_px, height / 2 + random.normal(0, 0.008 * width)),
            (0.0, 0.0, 1.0),
        )
        bent = (random.uniform(-0.25, 0.02), random.uniform(-0.02, 0.08), 0.0, 0.0)
        cameras.append(Camera(f"cam{n + 1}", K, as_matrix(R), as_row(-R @ at), bent))
    first, second = cameras
    poses = held_poses(random, (first, second), size, board.square_m, holds)
    return FilmedRig((first, second), size, board, poses)


def looking(at: Vector, aim: Vector, roll: float) -> Vector:
    """R of a camera at a place that looks at another, rolled by some radians."""
    ahead = (aim - at) / np.linalg.norm(aim - at)
    right = np.cross(ahead, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    level = np.stack([right, np.cross(ahead, right), ahead])
    c, s = np.cos(roll), np.sin(roll)
    rolled: Vector = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ level
    return rolled


def held_poses(
    random: np.random.Generator,
    cameras: tuple[Camera, Camera],
    size: tuple[int, int],
    square_m: float,
    holds: int,
) -> tuple[Pose, ...]:
    """As somebody is told to: near each camera all over its picture, then before both, then laid
    down at three places."""
    poses = []
    centres = [arrays_of(camera).centre for camera in cameras]
    for n in range(holds):
        own = n % 2
        if n < holds // 2:
            camera = cameras[own]
            pixel = [random.uniform(0.12, 0.88) * size[0], random.uniform(0.12, 0.88) * size[1]]
            middle = (
                centres[own]
                + ray(camera, (pixel[0], pixel[1])) * random.uniform(9.0, 16.0) * square_m
            )
            towards, slant = centres[own] - middle, 0.4
        else:
            middle = np.array([0.0, 0.9, 0.0]) + random.uniform(-0.45, 0.45, 3)
            to_each = np.stack(centres) - middle
            towards = (to_each / np.linalg.norm(to_each, axis=1)[:, None]).sum(axis=0)
            slant = 0.2
        towards = towards / np.linalg.norm(towards) + random.normal(0, slant, 3)
        poses.append(Pose(facing(towards, random.normal(0, 0.5)), middle))
    for x, z in ((-0.3, 0.5), (0.3, 0.4), (0.0, 0.2)):
        turned = random.uniform(0, 2 * np.pi)
        poses.append(Pose(facing(np.array([0.0, 1.0, 0.0]), turned), np.array([x, 0.0, z])))
    return tuple(poses)


def facing(towards: Vector, roll: float) -> Vector:
    """Turn of a board that looks some way."""
    into = -towards / np.linalg.norm(towards)
    side = np.cross([0.0, -1.0, 0.0] if abs(into[1]) < 0.9 else [0.0, 0.0, 1.0], into)
    side /= np.linalg.norm(side)
    flat = np.stack([side, np.cross(into, side), into], axis=1)
    c, s = np.cos(roll), np.sin(roll)
    rolled: Vector = flat @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return rolled


def pictures_of(
    rig: FilmedRig, camera: int, seed: int, frames: int, late: int = 0
) -> Iterator[NDArray[np.uint8]]:
    """A film's pictures at 5 a second: each pose is held for some, then the board is gone."""
    studio = Studio(rig.cameras[camera], rig.size, seed)
    for _ in range(late):
        yield studio.picture(rig.board, None)
    for pose in rig.poses:
        for _ in range(frames):
            yield studio.picture(rig.board, pose)
        yield studio.picture(rig.board, None)


def middle_of(board: Board) -> Vector:
    """(3,) metres, in the board's axes."""
    return np.array([board.columns, board.rows, 0.0]) * board.square_m / 2
