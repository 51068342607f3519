"""The renderer: people in a room, in each camera's picture, with exact silhouettes."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.rig.camera import Rig, project
from common.video.pictures import Image
from synth.motion.motions import Motion
from synth.person.people import Person
from synth.picture.actors import Actor, Part, Thing, actor_of, surfaces, thing_of
from synth.picture.exposure import exposures
from synth.picture.raster import cover, draw, expose, gather, shade
from synth.picture.synth_room import LIGHT_MAP_PX, Lamp, Room, furnished, lamp_pixels, lit_from

FINE_PX: Final = 480
"""Number of samples across a picture: smaller pictures average more samples per pixel."""
NOISE: Final = 1.7
"""Standard deviation of the sensor's noise in a dark pixel, grey levels."""
KEY_DARK, FOOT_DARK = 0.2, 0.3
"""Share of the light that the person blocks: from the lamp, and under the feet."""
BLURS_PX: Final = (7, 15)
"""Blur of those two shadows, in pixels of the lamp's picture."""

Coverage = tuple[NDArray[np.float32], NDArray[np.bool_]]
"""Colours times coverage, and coverage, (h, w, 4); the exact mask of each person (people, h, w)."""


class Shot(NamedTuple):
    """One moment in each camera of the rig."""

    frames: tuple[Image, ...]
    """(h, w, 3) per camera: blue, green, red."""
    masks: tuple[NDArray[np.bool_], ...]
    """Per camera True where a person covers half of a pixel or more at the frame's time: (h, w) of
    one person; (people, h, w) of several, what others hide left out."""


class _Scene(NamedTuple):
    """The constant part of a clip."""

    cast: tuple[Actor, ...]
    """People, then things."""
    people: int
    room: Room
    rig: Rig
    scale: int
    solid: bool
    """Whether the room's walls and furniture hide people behind them."""


def render(
    someone: Person, motion: Motion, rig: Rig, room_seed: int, seed: int, moving: bool = False
) -> Iterator[Shot]:
    """The frames of a performance, whose masks are (h, w): one person before the room.

    Args:
        someone: The performer.
        motion: Their motion.
        rig: The cameras; they determine the room's size.
        room_seed: Seed of the room.
        seed: Seed of the differences between takes: noise, exposure.
        moving: Whether screens play, and trees sway, behind the person.
    """
    cast, room = (actor_of(Part(someone, motion)),), room_of(room_seed, rig, moving)
    scene = _Scene(cast, 1, room, rig, _scale(rig), solid=False)
    for frames, masks in _shots(scene, motion.fps, seed):
        yield Shot(frames, tuple(mask[0] for mask in masks))


def render_scene(
    parts: Sequence[Part],
    rig: Rig,
    room_seed: int,
    seed: int,
    things: Sequence[Thing] = (),
    *,
    moving: bool = False,
) -> Iterator[Shot]:
    """The frames of several people in a room: what is nearer hides what is farther.

    Args:
        parts: One or more; their motions have the same frames.
        rig: As for `render`.
        room_seed: As for `render`.
        seed: As for `render`.
        things: What they carry, of the same frames.
        moving: As for `render`.
    """
    cast = (*map(actor_of, parts), *map(thing_of, things))
    scene = _Scene(cast, len(parts), room_of(room_seed, rig, moving), rig, _scale(rig), solid=True)
    return _shots(scene, parts[0].motion.fps, seed)


def _scale(rig: Rig) -> int:
    """Number of samples per pixel, each way."""
    return max(2, round(FINE_PX / rig.width))


def _shots(scene: _Scene, fps: float, seed: int) -> Iterator[Shot]:
    rig, cameras, count = scene.rig, len(scene.rig.cameras), len(scene.cast[0].places)
    gains = exposures(cameras, count, seed, fps)
    rng = np.random.default_rng([seed, 3])
    grain = rng.normal(0.0, NOISE, (rig.height + 61, rig.width + 61, 3)).astype(np.float32)
    for i in range(count):
        corners = rng.integers(0, 61, (cameras, 2))
        bodies, lit = _bodies(scene, i), _light(scene, i)
        noises = [grain[y : y + rig.height, x : x + rig.width] for y, x in corners]
        rooms = [scene.room.at(n, i / fps) for n in range(cameras)]
        frames = [
            _exposed(rooms[n], bodies[n], lit[n], gains[n, i], noises[n]) for n in range(cameras)
        ]
        yield Shot(tuple(frames), tuple(masks for _, masks in bodies))


@lru_cache(maxsize=2)
def room_of(seed: int, rig: Rig, moving: bool = False) -> Room:
    """A performer's takes share a room; furnishing one costs as much as twenty frames."""
    return furnished(seed, rig, moving)


class _Drawing(NamedTuple):
    """A person who is drawn in one frame."""

    number: int
    """Place in the cast, from 1."""
    actor: Actor
    moments: list[NDArray[np.float64]]
    shaded: Vector
    """(v,) brightness of the vertices."""


def _bodies(scene: _Scene, i: int) -> list[Coverage]:
    """For each camera the people's colours with coverage (h, w, 4) and the exact masks."""
    drawings, rig = _drawings(scene, i), scene.rig
    shape, found = (rig.height, rig.width), []
    for n in range(len(rig.cameras)):
        body = np.zeros((*shape, 4), np.float32)
        masks = np.zeros((scene.people, *shape), np.bool_)
        moments = len(drawings[0].moments) if drawings else 0
        for k in range(moments):
            box, whose = _drawn(scene, n, drawings, k, body)
            if k == 0:
                masks[:, *box] = _covered(whose, scene.people, scene.scale)
        found.append((body, masks))
    return found


def _drawings(scene: _Scene, i: int) -> list[_Drawing]:
    """Who is in the room in frame i; one shutter for all."""
    there = [(number, actor) for number, actor in enumerate(scene.cast, 1) if actor.present[i]]
    smeared, light = any(actor.smeared[i] for _, actor in there), lit_from(scene.room.lamps[0])
    found = []
    for number, actor in there:
        moments, shaded = surfaces(actor, i, smeared), np.empty(len(actor.mesh.shares))
        shade(moments[0], actor.mesh.faces, light, np.empty_like(moments[0]), shaded)
        found.append(_Drawing(number, actor, moments, shaded))
    return found


def _drawn(
    scene: _Scene, n: int, drawings: list[_Drawing], k: int, body: NDArray[np.float32]
) -> tuple[tuple[slice, slice], NDArray[np.uint8]]:
    """Add moment k of all people to `body`; returns its box in the picture, and whose each of its
    samples is."""
    camera, scale = scene.rig.cameras[n], scene.scale
    pixels = [project(camera, drawing.moments[k]) for drawing in drawings]
    box = _box(np.concatenate(pixels), scene.rig)
    high, wide = (scale * (side.stop - side.start) for side in box)
    nearest = np.zeros((high, wide))
    if scene.solid:
        nearest[:] = scene.room.nearness[n][box].repeat(scale, axis=0).repeat(scale, axis=1)
    colours, whose = np.empty((high, wide, 3), np.float32), np.zeros((high, wide), np.uint8)
    for drawing, at in zip(drawings, pixels, strict=True):
        behind, mesh, places = nearest.copy(), drawing.actor.mesh, drawing.moments[k]
        draw(
            (at - [box[1].start, box[0].start]) * scale,
            places @ np.array(camera.R)[2] + camera.t[2],
            drawing.shaded,
            mesh.vertices_m,
            mesh.faces,
            mesh.materials,
            drawing.actor.palette,
            drawing.actor.pattern,
            nearest,
            colours,
        )
        whose[nearest != behind] = drawing.number
    gather(whose > 0, colours, scale, body[box], 1.0 / len(drawings[0].moments))
    return box, whose


def _covered(whose: NDArray[np.uint8], people: int, scale: int) -> NDArray[np.bool_]:
    """Whether each person has half of a pixel's samples or more, (people, h, w)."""
    samples = whose.reshape(whose.shape[0] // scale, scale, whose.shape[1] // scale, scale)
    counts = [(samples == number).sum(axis=(1, 3)) for number in range(1, people + 1)]
    return np.asarray(2 * np.stack(counts) >= scale * scale)


def _box(pixels: Vector, rig: Rig) -> tuple[slice, slice]:
    """Rows and columns that hold all pixels, inside the picture; empty where all are NaN."""
    ahead = pixels[np.isfinite(pixels).all(axis=1)]
    if not len(ahead):
        return slice(0, 0), slice(0, 0)
    low = np.clip(ahead.min(axis=0) - 1, 0, [rig.width, rig.height]).astype(int)
    high = np.clip(ahead.max(axis=0) + 2, 0, [rig.width, rig.height]).astype(int)
    return slice(low[1], max(high[1], low[1])), slice(low[0], max(high[0], low[0]))


def _light(scene: _Scene, i: int) -> list[NDArray[np.float32]]:
    """Light that arrives in each pixel of each camera, (h, w), 0 to 1, in frame i."""
    there = [actor for actor in scene.cast if actor.present[i] and _inside(scene, actor, i)]
    if not there:
        return [np.ones((scene.rig.height, scene.rig.width), np.float32)] * len(scene.rig.cameras)
    soft = [
        _lamp_mask(there, i, lamp, blur)
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


def _inside(scene: _Scene, actor: Actor, i: int) -> bool:
    """Whether a person casts shadows: those behind a solid wall do not."""
    middle, room = actor.places[i].mean(axis=0), scene.room
    return not scene.solid or bool((middle >= room.low).all() and (middle <= room.high).all())


def _lamp_mask(there: list[Actor], i: int, lamp: Lamp, blur_px: int) -> NDArray[np.float32]:
    """The people in a lamp's picture, blurred by the lamp's size."""
    mask = np.zeros((LIGHT_MAP_PX, LIGHT_MAP_PX), np.uint8)
    for actor in there:
        cover(lamp_pixels(lamp, actor.places[i]), actor.mesh.faces, mask)
    return cv2.GaussianBlur(mask.astype(np.float32), (blur_px, blur_px), 0)


def _exposed(
    room: NDArray[np.float32],
    body: Coverage,
    lit: NDArray[np.float32],
    gain: float,
    noise: NDArray[np.float32],
) -> Image:
    """A camera's picture."""
    frame = np.empty(room.shape, np.uint8)
    expose(room, lit, body[0], gain, noise, frame)
    return frame
