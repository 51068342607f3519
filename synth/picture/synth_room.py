"""A random furnished room in each camera's picture, and the shadows of its lamps."""

import math
from functools import reduce
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.rig.camera import Camera, Rig, centre
from synth.things.furnishing import Cuboid, furniture, moving_things, walls_of, walls_seen
from synth.things.moving_pictures import MOVING
from synth.things.textures import painted

Picture = NDArray[np.float32]

LIGHT_MAP_PX: Final = 128
"""Side of a lamp's picture of the person: 4 cm per pixel, as shadows are soft anyway."""
LIGHT_REACH_M: Final = 2.3
"""Extent of the lamps' pictures around the middle of the room."""
MIDDLE_M: Final = (0.0, 0.9, 0.0)
OVERHEAD_M: Final = 2.3
"""Height above which nothing gets a shadow: the ceiling is behind no person."""
BESIDE_M: Final = 1.0
"""Smallest distance ahead of a lamp at which there is a shadow."""
SELF_SHADE: Final = 0.01
"""Share of the way to the lamp within which a box casts no shadow on a point: the point may lie
on it."""
LAMP_SPREAD_M: Final = 0.25
"""Half the size of the lamp: furniture casts soft shadows too."""
FLOOR_M: Final = 0.02
"""Height up to which the room hides no person: soles lie on the floor."""
SAMPLES: Final = 2
"""Rays per pixel, each way."""


class Lamp(NamedTuple):
    """A pinhole that looks from the lamp at the middle of the room."""

    place_m: Vector
    rotation: NDArray[np.float64]
    """World to lamp; z points at the middle."""
    focal_px: float


class Playing(NamedTuple):
    """A thing on a wall whose picture moves, in one camera's picture."""

    thing: Cuboid
    pixels: NDArray[np.int64]
    """(k,) flat indices of the pixels that it fills."""
    points_m: NDArray[np.float64]
    """(k, 3) what they show of it."""
    light: Vector
    """(k,) brightness there."""


class Room(NamedTuple):
    """An empty room in each camera's picture."""

    pictures: tuple[Picture, ...]
    """(h, w, 3) per camera, 0-255."""
    lamps: tuple[Lamp, ...]
    """The key light, and the ceiling, whose shadow lies under the feet."""
    shadows_px: tuple[tuple[NDArray[np.float32], ...], ...]
    """[camera][lamp]: (h, w, 2) place of a pixel's point in the lamp's picture."""
    nearness: tuple[NDArray[np.float64], ...]
    """(h, w) per camera: inverse depth of the walls and the furniture, 1/m; 0 on the floor."""
    low: Vector
    """(3,) the walls' lower corner, metres; so is the upper one, `high`."""
    high: Vector
    playing: tuple[tuple[Playing, ...], ...]
    """[camera]: what moves."""

    def at(self, camera: int, time_s: float) -> Picture:
        """The room in a camera's picture at a time, (h, w, 3)."""
        if not self.playing[camera]:
            return self.pictures[camera]
        picture = self.pictures[camera].copy()
        for (low, high, look), pixels, points_m, light in self.playing[camera]:
            colours = painted(look, points_m, low, high, time_s) * light[:, None]
            picture.reshape(-1, 3)[pixels] = np.clip(colours, 0, 255)
        return picture


def furnished(seed: int, rig: Rig, moving: bool = False) -> Room:
    """The room of a seed, for the cameras of a rig.

    Args:
        seed: The same seed gives the same room.
        rig: The cameras.
        moving: Whether screens play, and trees sway, on the walls behind the person.
    """
    rng = np.random.default_rng([seed, 1])
    boxes = walls_of(rng, rig)
    walls = walls_seen(boxes[0], len(rig.cameras))
    boxes += furniture(rng, walls)
    if moving:
        boxes += moving_things(np.random.default_rng([seed, 4]), walls)
    key = np.array([rng.uniform(-2.2, 2.2), rng.uniform(2.8, 3.8), rng.uniform(1.6, 3.0)])
    lamps = (_lamp(key), _lamp(np.array([0.05, 5.5, 0.05])))
    pictures, maps, near, playing = [], [], [], []
    for n, camera in enumerate(rig.cameras):
        picture, points, moved = _seen(rig, n, boxes, key, rng)
        pictures.append(picture)
        maps.append(tuple(_shadow_map(lamp, points) for lamp in lamps))
        nearness = 1.0 / (points @ np.array(camera.R)[2] + camera.t[2])
        near.append(np.where(points[..., 1] > FLOOR_M, nearness, 0.0))
        playing.append(moved)
    seen, low, high = (
        (tuple(pictures), lamps, tuple(maps), tuple(near)),
        boxes[0].low,
        boxes[0].high,
    )
    return Room(*seen, low, high, tuple(playing))


def _shadow_map(lamp: Lamp, points_m: NDArray[np.float64]) -> NDArray[np.float32]:
    """Places in the lamp's picture of the points (h, w, 3); outside for high ones."""
    pixels = lamp_pixels(lamp, points_m)
    ahead = (points_m - lamp.place_m) @ lamp.rotation[2]
    pixels[(points_m[..., 1] > OVERHEAD_M) | (ahead < BESIDE_M)] = -LIGHT_MAP_PX
    return pixels.astype(np.float32)


def lamp_pixels(lamp: Lamp, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places of points (..., 3) in a lamp's picture; outside of it for those beside the lamp."""
    seen = (points_m - lamp.place_m) @ lamp.rotation.T
    pixels: NDArray[np.float64] = seen[..., :2] / np.maximum(seen[..., 2:], 0.1) * lamp.focal_px
    return pixels + LIGHT_MAP_PX / 2


def _lamp(place: Vector) -> Lamp:
    ahead = np.array(MIDDLE_M) - place
    distance = float(np.linalg.norm(ahead))
    z = ahead / distance
    x = np.cross(z, [0.3, 0.1, 1.0])
    x /= np.linalg.norm(x)
    focal = LIGHT_MAP_PX / 2 * distance / LIGHT_REACH_M
    return Lamp(place, np.stack([x, np.cross(z, x), z]), focal)


def _seen(
    rig: Rig, n: int, boxes: list[Cuboid], key: Vector, rng: np.random.Generator
) -> tuple[Picture, NDArray[np.float64], tuple[Playing, ...]]:
    """The picture (h, w, 3), the room's point in each pixel (h, w, 3), and what moves."""
    camera, size = rig.cameras[n], (rig.height * SAMPLES, rig.width * SAMPLES)
    rays = _rays(camera, size)
    origin = centre(camera)
    reach = _leaving(origin, rays, boxes[0])
    which = np.zeros(len(rays), np.int64)
    for i, box in enumerate(boxes[1:], 1):
        near = _entering(origin, rays, box)
        nearer = near < reach
        reach[nearer], which[nearer] = near[nearer], i
    points = origin + reach[:, None] * rays
    colours = np.empty((len(rays), 3))
    for i, box in enumerate(boxes):
        here = which == i
        colours[here] = painted(box.finish, points[here], box.low, box.high)
    light = _light(points, boxes, key, rng)
    colours *= light[:, None]
    shape = (rig.width, rig.height)
    picture = cv2.resize(
        colours.reshape(*size, 3).astype(np.float32), shape, interpolation=cv2.INTER_AREA
    )
    centres = points.reshape(*size, 3)[SAMPLES // 2 :: SAMPLES, SAMPLES // 2 :: SAMPLES]
    seen = _by_pixel(np.column_stack([points, light]), size)
    filled = _by_pixel(which[:, None].astype(float), size)[..., 0]
    playing = [
        _playing(box, (filled == i).all(axis=1), seen)
        for i, box in enumerate(boxes)
        if box.finish.kind in MOVING
    ]
    return np.clip(picture, 0, 255), centres, tuple(playing)


def _by_pixel(values: NDArray[np.float64], size: tuple[int, int]) -> NDArray[np.float64]:
    """Values of samples (h w, k) as those of each pixel: (pixels, SAMPLES^2, k)."""
    high, wide = size[0] // SAMPLES, size[1] // SAMPLES
    cut = values.reshape(high, SAMPLES, wide, SAMPLES, -1).swapaxes(1, 2)
    return cut.reshape(high * wide, SAMPLES * SAMPLES, -1)


def _playing(box: Cuboid, filled: NDArray[np.bool_], seen: NDArray[np.float64]) -> Playing:
    """The pixels that a box fills, by their samples' points and light, (pixels, samples, 4)."""
    pixels = np.flatnonzero(filled)
    mean = seen[pixels].mean(axis=1)
    return Playing(box, pixels, mean[:, :3], mean[:, 3])


def _rays(camera: Camera, size: tuple[int, int]) -> NDArray[np.float64]:
    """Directions in the world of all samples, (h w, 3), row by row."""
    rows, columns = np.mgrid[0 : size[0], 0 : size[1]]
    pixels = (np.stack([columns, rows], axis=-1).reshape(-1, 1, 2) + 0.5) / SAMPLES
    lens = np.array(camera.distortion or (0.0,) * 5)
    plane = cv2.undistortPoints(pixels, np.array(camera.K), lens)[:, 0]
    seen: NDArray[np.float64] = np.concatenate([plane, np.ones((len(plane), 1))], axis=1)
    return seen @ np.array(camera.R)


def _leaving(origin: Vector, rays: NDArray[np.float64], box: Cuboid) -> Vector:
    """Distance along each ray to the room's walls."""
    with np.errstate(divide="ignore"):
        ends = np.maximum((box.low - origin) / rays, (box.high - origin) / rays)
    found: Vector = reduce(np.minimum, ends.T)
    return found


def _entering(
    origins: Vector, rays: NDArray[np.float64], box: Cuboid, least: float = 0.0
) -> Vector:
    """Distance along each ray to a box; infinite where it misses.

    Args:
        origins: Starts of the rays: one place (3,), or one each (n, 3).
        rays: (n, 3).
        box: The box.
        least: Smallest distance of a hit: a point on a box does not shade itself.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        to_low, to_high = (box.low - origins) / rays, (box.high - origins) / rays
    near = reduce(np.maximum, np.minimum(to_low, to_high).T)  # along rows of three numpy is slow
    far = reduce(np.minimum, np.maximum(to_low, to_high).T)
    found: Vector = np.where((near < far) & (near > least), near, np.inf)
    return found


def _light(
    points: NDArray[np.float64], boxes: list[Cuboid], key: Vector, rng: np.random.Generator
) -> Vector:
    """Brightness of the points: lamp with the furniture's shadows, and dark corners."""
    away = np.linalg.norm(points - key, axis=1)
    lamp = 1.0 / (1.0 + (away / 6.0) ** 2)
    shaded = np.zeros(len(points))
    for _ in range(2):
        place = key + rng.uniform(-LAMP_SPREAD_M, LAMP_SPREAD_M, 3)
        towards = place - points
        hit = np.zeros(len(points), bool)
        for box in boxes[1:]:
            hit |= _entering(points, towards, box, SELF_SHADE) < 1.0
        shaded += 0.5 * hit
    walls = np.minimum(points - boxes[0].low, boxes[0].high - points)
    corner = np.prod(1.0 - 0.22 * np.exp(-np.sort(walls, axis=1)[:, 1:2] / 0.18), axis=1)
    found: Vector = (0.45 + 0.75 * lamp * (1.0 - 0.45 * shaded)) * corner
    return found


def lit_from(lamp: Lamp) -> Vector:
    """Direction from the middle of the room to a lamp, unit length."""
    towards = lamp.place_m - np.array(MIDDLE_M)
    found: Vector = towards / math.sqrt(float(towards @ towards))
    return found
