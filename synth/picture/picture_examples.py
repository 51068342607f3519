"""Pictures of synthetic people with known joints, for networks that look at pictures."""

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Vector
from synth.motion.footing import Posed, posed
from synth.person.mesh import Mesh, body_mesh
from synth.person.people import PATTERNS, Look, Person, person
from synth.person.rings import MATERIAL
from synth.person.skeleton import BONE_INDEX, JOINTS, turned
from synth.person.wardrobe import dressed
from synth.picture.actors import palette
from synth.picture.example_poses import poses_deg
from synth.picture.mask_flaws import flaw, spoilt
from synth.picture.raster import draw, gather, shade, skin
from synth.picture.silhouette_examples import PEOPLE, differing

SIDE_PX: Final = 128
"""Side of a picture: the network's input size."""
FINER: Final = 2
"""Samples across a pixel."""
PICTURES: Final = 16
"""Number of pictures of one person."""
DISTANCE_M, RISE_DEG, ROLL_DEG = (1.6, 7.0), (-12.0, 55.0), 8.0
"""Ranges of the cameras' distance, height above the body's middle, and roll."""
ANYHOW_SHARE: Final = 0.08
"""Share of the pictures with any roll."""
FRAME: Final = (-0.12, 0.3)
"""Range of the logarithm of a picture's side over FRAMED times the body's longer side."""
FRAMED: Final = 1.25
"""Longer side of the body's box over the side of an ideal picture, a viewer's window."""
SMALL_SHARE, SMALL = 0.12, (0.3, 1.2)
"""Share of the pictures with a smaller person, and the logarithm of the factor."""
ASIDE: Final = (0.04, 0.14)
"""Standard deviation of the body's middle from the picture's, in sides; the second value is
rare."""
ASTRAY_SHARE: Final = 0.2
"""Share of the pictures with the second value."""
SEEN_AS: Final = [JOINTS.index(name) for name in JOINT_NAMES]


class PictureExample(NamedTuple):
    """One person in one picture, without a background."""

    body: NDArray[np.uint8]
    """(SIDE_PX, SIDE_PX, 4) blue, green, red, times coverage; coverage."""
    outline: NDArray[np.uint8]
    """(SIDE_PX, SIDE_PX) 1 inside of the silhouette, with the flaws of a segmented one."""
    joints_px: NDArray[np.float32]
    """(15, 2) JOINT_NAMES order; also beyond the picture."""
    facing: NDArray[np.float32]
    """(2,) the front of the trunk in the camera's axes: to the right, towards the camera."""
    stature_px: float
    """Height of the person upright, in pixels at that distance."""


class Shown(NamedTuple):
    """A body to draw, and its ground truth."""

    places_m: NDArray[np.float64]
    """(v, 3) world."""
    rest_m: NDArray[np.float64]
    """(v, 3) at rest, where patterns are defined."""
    faces: NDArray[np.int64]
    """(f, 3) seen from outside anticlockwise."""
    materials: NDArray[np.int64]
    """(f,) indices in MATERIALS."""
    colours: NDArray[np.float64]
    """Colours of MATERIALS, then the shirt's second colour."""
    pattern: tuple[float, float, float]
    joints_m: NDArray[np.float64]
    """(15, 3) JOINT_NAMES order, world."""
    front: Vector
    """(3,) direction of the chest."""
    stature_m: float


class _View(NamedTuple):
    """One picture's camera: rows of its axes in the world, and its place."""

    axes: NDArray[np.float64]
    place_m: Vector


def picture_examples(seed: int) -> Iterator[PictureExample]:
    """The pictures of one person; each seed is one person."""
    rng = np.random.default_rng([seed, 79])
    someone = dressed(differing(person(int(rng.integers(*PEOPLE))), rng), rng)
    mesh, angles = body_mesh(someone), poses_deg(someone, PICTURES, rng)
    body = posed(someone.measures, angles, np.zeros(2), np.zeros((PICTURES, 2)))
    for i in range(PICTURES):
        example = pictured(_moved(someone, mesh, body, i), rng)
        if example is not None:
            yield example


def shirt_pattern(look: Look) -> tuple[float, float, float]:
    """Kind, pitch in metres and material, in the form of `draw`."""
    return (float(PATTERNS.index(look.pattern)), look.pitch_m, float(MATERIAL["shirt"]))


def _moved(someone: Person, mesh: Mesh, body: Posed, i: int) -> Shown:
    """One of our own people in a pose."""
    places = np.empty_like(mesh.vertices_m)
    skin(mesh.vertices_m, mesh.origins_m, mesh.bones, mesh.shares, body.bones[i], places)
    return Shown(
        places,
        mesh.vertices_m,
        mesh.faces,
        mesh.materials,
        palette(someone.look),
        shirt_pattern(someone.look),
        body.joints_m[i, SEEN_AS],
        body.bones[i, BONE_INDEX["chest"], :, 2],
        someone.measures["stature_m"],
    )


def pictured(shown: Shown, rng: np.random.Generator) -> PictureExample | None:
    """A picture of a body from any direction; None where it is partly behind the camera.

    Args:
        shown: The body.
        rng: Source of camera, frame, light and flaws.
    """
    view = _looking(shown.places_m.mean(axis=0), rng)
    seen = (shown.places_m - view.place_m) @ view.axes.T
    if seen[:, 2].min() < 0.3:
        return None
    flat = seen[:, :2] / seen[:, 2:]
    corner, side = _framed(flat, rng)
    light = rng.normal((0.0, 1.2, 0.0), 1.0)
    shaded, normals = np.empty(len(flat)), np.empty_like(shown.places_m)
    shade(shown.places_m, shown.faces, light / np.linalg.norm(light), normals, shaded)
    drawn = _drawn(shown, (flat - corner) / side * SIDE_PX, seen[:, 2], shaded)
    outline = spoilt((drawn[..., 3] >= 0.5).astype(np.uint8), flaw(1, rng), 0)
    joints = (shown.joints_m - view.place_m) @ view.axes.T
    front = view.axes @ shown.front
    return PictureExample(
        np.rint(np.clip(drawn * [1.0, 1.0, 1.0, 255.0], 0, 255)).astype(np.uint8),
        outline,
        ((joints[:, :2] / joints[:, 2:] - corner) / side * SIDE_PX).astype(np.float32),
        np.array([front[0], -front[2]], np.float32),
        float(shown.stature_m / joints[0, 2] / side * SIDE_PX),
    )


def _looking(middle_m: Vector, rng: np.random.Generator) -> _View:
    """A camera that looks at a body from any direction."""
    rise, away = np.radians(rng.uniform(*RISE_DEG) * rng.random()), rng.uniform(*DISTANCE_M)
    at = rng.uniform(0.0, 2 * np.pi)
    place = middle_m + away * np.array(
        [np.cos(rise) * np.sin(at), np.sin(rise), np.cos(rise) * np.cos(at)]
    )
    ahead = (middle_m - place) / away
    right = np.cross(ahead, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    level = np.stack([right, np.cross(ahead, right), ahead])
    roll = rng.uniform(-180, 180) if rng.random() < ANYHOW_SHARE else rng.normal(0.0, ROLL_DEG)
    return _View(turned("z", np.array([roll]))[0] @ level, place)


def _framed(flat: NDArray[np.float64], rng: np.random.Generator) -> tuple[Vector, float]:
    """Top left corner and side of the picture, in focal lengths."""
    low, high = flat.min(axis=0), flat.max(axis=0)
    larger = rng.uniform(*(SMALL if rng.random() < SMALL_SHARE else FRAME))
    side = float((high - low).max() * FRAMED * np.exp(larger))
    aside = ASIDE[int(rng.random() < ASTRAY_SHARE)] * rng.normal(0.0, 1.0, 2)
    return (low + high) / 2 - side * (0.5 + aside), side


def _drawn(shown: Shown, pixels: Vector, depths: Vector, shaded: Vector) -> NDArray[np.float32]:
    """Colours times coverage, and coverage, (SIDE_PX, SIDE_PX, 4)."""
    fine = SIDE_PX * FINER
    nearest, colours = np.zeros((fine, fine)), np.zeros((fine, fine, 3), np.float32)
    draw(
        pixels * FINER,
        depths,
        shaded,
        shown.rest_m,
        shown.faces,
        shown.materials,
        shown.colours,
        shown.pattern,
        nearest,
        colours,
    )
    body = np.zeros((SIDE_PX, SIDE_PX, 4), np.float32)
    gather(nearest > 0.0, colours, FINER, body, 1.0)
    return body
