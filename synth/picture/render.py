"""The renderer: a performance in a room, in each camera's picture, with exact silhouettes."""

from collections.abc import Iterator
from functools import lru_cache
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.raster.similarity import Mask
from common.rig.camera import Camera, Rig, project
from common.video.pictures import Image
from synth.motion.motions import Motion
from synth.person.mesh import Mesh, body_mesh
from synth.person.people import PATTERNS, Look, Person
from synth.person.rings import MATERIAL, MATERIALS
from synth.picture.exposure import blurred, exposures
from synth.picture.raster import cover, draw, expose, gather, shade, skin
from synth.picture.synth_room import LIGHT_MAP_PX, Lamp, Room, furnished, lamp_pixels, lit_from

FINE_PX: Final = 480
"""Number of samples across a picture: smaller pictures average more samples per pixel."""
SHUTTER: Final = 0.4
"""Open time of the shutter, over the frame period."""
NOISE: Final = 1.7
"""Standard deviation of the sensor's noise in a dark pixel, grey levels."""
KEY_DARK, FOOT_DARK = 0.2, 0.3
"""Share of the light that the person blocks: from the lamp, and under the feet."""
BLURS_PX: Final = (7, 15)
"""Blur of those two shadows, in pixels of the lamp's picture."""

Body = tuple[NDArray[np.float32], Mask]
"""Colours times coverage, and coverage, (h, w, 4); the exact mask (h, w)."""


class Shot(NamedTuple):
    """One moment in each camera of the rig."""

    frames: tuple[Image, ...]
    """(h, w, 3) per camera: blue, green, red."""
    masks: tuple[Mask, ...]
    """(h, w) per camera: True where the person covers half of a pixel or more at the frame's
    time."""


class _Scene(NamedTuple):
    """The constant part of a clip."""

    mesh: Mesh
    palette: NDArray[np.float64]
    pattern: tuple[float, float, float]
    room: Room
    rig: Rig
    scale: int


def render(someone: Person, motion: Motion, rig: Rig, room_seed: int, seed: int) -> Iterator[Shot]:
    """The frames of a performance.

    Args:
        someone: The performer.
        motion: Their motion.
        rig: The cameras; they determine the room's size.
        room_seed: Seed of the room.
        seed: Seed of the differences between takes: noise, exposure.
    """
    scale = max(2, round(FINE_PX / rig.width))
    look = someone.look
    pattern = (float(PATTERNS.index(look.pattern)), look.pitch_m, float(MATERIAL["shirt"]))
    scene = _Scene(body_mesh(someone), palette(look), pattern, room_of(room_seed, rig), rig, scale)
    places = _placed(scene.mesh, motion)
    cameras = len(rig.cameras)
    gains, smeared = exposures(cameras, len(motion.phase), seed, motion.fps), blurred(motion)
    rng = np.random.default_rng([seed, 3])
    grain = rng.normal(0.0, NOISE, (rig.height + 61, rig.width + 61, 3)).astype(np.float32)
    empty = _nobody(rig)
    for i in range(len(motion.phase)):
        corners = rng.integers(0, 61, (cameras, 2))
        if motion.present[i]:
            moments = _moments(places, i, bool(smeared[i]))
            bodies, dark = _bodies(scene, moments), _darkness(scene, places[i])
        else:
            bodies, dark = empty
        views = [
            _exposed(scene, n, bodies[n], dark[n], gains[n, i], _grain_of(grain, corners[n], rig))
            for n in range(cameras)
        ]
        yield Shot(tuple(frame for frame, _ in views), tuple(mask for _, mask in views))


@lru_cache(maxsize=2)
def room_of(seed: int, rig: Rig) -> Room:
    """A performer's takes share a room; furnishing one costs as much as twenty frames."""
    return furnished(seed, rig)


def palette(look: Look) -> NDArray[np.float64]:
    """Colours of MATERIALS, then the shirt's second colour."""
    colours = {
        "skin": look.skin,
        "hair": look.hair_colour,
        "shirt": look.shirt,
        "trousers": look.trousers,
        "shoes": look.shoes,
        "dark": tuple(0.72 * value for value in look.skin),
        "lips": tuple(0.8 * value for value in look.skin),
    }
    rows = [colours[name] for name in MATERIALS] + [look.shirt_second]
    return np.array(rows, dtype=np.float64)


def _placed(mesh: Mesh, motion: Motion) -> NDArray[np.float64]:
    """Vertices of every frame, (n, v, 3), world metres."""
    places = np.empty((len(motion.phase), *mesh.vertices_m.shape))
    for frames, out in zip(motion.bones, places, strict=True):
        skin(mesh.vertices_m, mesh.origins_m, mesh.bones, mesh.shares, frames, out)
    return places


def _moments(places: NDArray[np.float64], i: int, smeared: bool) -> list[NDArray[np.float64]]:
    """The surface at the frame's time, then before and after it while the shutter is open."""
    if not smeared:
        return [places[i]]
    before, after = places[max(i - 1, 0)], places[min(i + 1, len(places) - 1)]
    frame = (after - before) / 2
    return [places[i] + SHUTTER * share * frame for share in (0.0, -0.4, -0.2, 0.2, 0.4)]


def _bodies(scene: _Scene, moments: list[NDArray[np.float64]]) -> list[Body]:
    """For each camera the person's colours with coverage (h, w, 4) and the exact mask."""
    mesh, light = scene.mesh, lit_from(scene.room.lamps[0])
    shaded = np.empty(len(mesh.shares))
    shade(moments[0], mesh.faces, light, np.empty_like(moments[0]), shaded)
    found = []
    for camera in scene.rig.cameras:
        body = np.zeros((scene.rig.height, scene.rig.width, 4), np.float32)
        mask = np.zeros((scene.rig.height, scene.rig.width), bool)
        for k, places in enumerate(moments):
            own, box = _drawn(scene, camera, places, shaded, body, 1.0 / len(moments))
            if k == 0:
                mask[box] = own >= 0.5
        found.append((body, mask))
    return found


def _drawn(
    scene: _Scene,
    camera: Camera,
    places: NDArray[np.float64],
    shaded: Vector,
    body: NDArray[np.float32],
    weight: float,
) -> tuple[NDArray[np.float32], tuple[slice, slice]]:
    """Add one drawing to `body`; returns its coverage, and its box in the picture."""
    mesh, scale = scene.mesh, scene.scale
    pixels = project(camera, places)
    depths = places @ np.array(camera.R)[2] + camera.t[2]
    box = _box(pixels, scene.rig)
    high, wide = (side.stop - side.start for side in box)
    nearest = np.zeros((high * scale, wide * scale))
    colours = np.empty((high * scale, wide * scale, 3), np.float32)
    fine = (pixels - [box[1].start, box[0].start]) * scale
    draw(
        fine,
        depths,
        shaded,
        mesh.vertices_m,
        mesh.faces,
        mesh.materials,
        scene.palette,
        scene.pattern,
        nearest,
        colours,
    )
    own = np.empty((high, wide), np.float32)
    gather(nearest, colours, scale, body[box], weight, own)
    return own, box


def _box(pixels: Vector, rig: Rig) -> tuple[slice, slice]:
    """Rows and columns that hold all pixels, inside the picture."""
    low = np.clip(np.nanmin(pixels, axis=0) - 1, 0, [rig.width, rig.height]).astype(int)
    high = np.clip(np.nanmax(pixels, axis=0) + 2, 0, [rig.width, rig.height]).astype(int)
    return slice(low[1], max(high[1], low[1])), slice(low[0], max(high[0], low[0]))


def _darkness(scene: _Scene, places: NDArray[np.float64]) -> list[NDArray[np.float32]]:
    """Light that arrives in each pixel of each camera, (h, w), 0 to 1."""
    soft = [
        _lamp_mask(scene.mesh, lamp, places, blur)
        for lamp, blur in zip(scene.room.lamps, BLURS_PX, strict=True)
    ]
    found = []
    for maps in scene.room.shadows_px:
        key, foot = (
            cv2.remap(mask, at, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
            for mask, at in zip(soft, maps, strict=True)
        )
        found.append((1.0 - KEY_DARK * key) * (1.0 - FOOT_DARK * foot))
    return found


def _lamp_mask(
    mesh: Mesh, lamp: Lamp, places: NDArray[np.float64], blur_px: int
) -> NDArray[np.float32]:
    """The person in a lamp's picture, blurred by the lamp's size."""
    mask = np.zeros((LIGHT_MAP_PX, LIGHT_MAP_PX), np.uint8)
    cover(lamp_pixels(lamp, places), mesh.faces, mask)
    return cv2.GaussianBlur(mask.astype(np.float32), (blur_px, blur_px), 0)


def _nobody(rig: Rig) -> tuple[list[Body], list[NDArray[np.float32]]]:
    """Values for body and shadow while the room is empty."""
    shape = (rig.height, rig.width)
    body = np.zeros((*shape, 4), np.float32), np.zeros(shape, bool)
    cameras = len(rig.cameras)
    return [body] * cameras, [np.ones(shape, np.float32)] * cameras


def _grain_of(
    grain: NDArray[np.float32], corner: NDArray[np.int64], rig: Rig
) -> NDArray[np.float32]:
    """A picture's noise: the same grain, shifted."""
    return grain[corner[0] : corner[0] + rig.height, corner[1] : corner[1] + rig.width]


def _exposed(
    scene: _Scene,
    n: int,
    body: Body,
    lit: NDArray[np.float32],
    gain: float,
    noise: NDArray[np.float32],
) -> tuple[Image, Mask]:
    """The picture of camera n and its mask."""
    frame = np.empty((scene.rig.height, scene.rig.width, 3), np.uint8)
    expose(scene.room.pictures[n], lit, body[0], gain, noise, frame)
    return frame, body[1]
