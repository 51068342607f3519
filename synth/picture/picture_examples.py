"""Pictures of synthetic people whose joints are known, for a network that looks at pictures."""

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, Vector
from synth.motion.footing import Posed, posed
from synth.person.mesh import Mesh, body_mesh
from synth.person.people import PATTERNS, Person, person
from synth.person.rings import MATERIAL
from synth.person.skeleton import ANGLES, BONE_INDEX, JOINTS, turned
from synth.person.wardrobe import dressed
from synth.picture.mask_flaws import flaw, spoilt
from synth.picture.raster import draw, gather, shade, skin
from synth.picture.render import palette
from synth.picture.silhouette_examples import AT_LARGE, PEOPLE, course, differing

SIDE_PX: Final = 96
"""Of a picture: as large as the network sees it."""
FINER: Final = 2
"""Samples across a pixel."""
PICTURES: Final = 16
"""Of one person."""
WILD_SHARE: Final = 0.5
"""Of the people: how many hold poses that have nothing to do with each other."""
FALLEN_SHARE: Final = 0.3
"""Of the wild poses: how many lie, crawl or fall."""
WILD_DEG: Final[dict[str, tuple[float, float]]] = {
    "torso_pitch": (-20.0, 75.0),
    "torso_roll": (-25.0, 25.0),
    "torso_yaw": (-40.0, 40.0),
    "head_pitch": (-35.0, 40.0),
    "head_yaw": (-60.0, 60.0),
    "head_roll": (-20.0, 20.0),
    "sh_abd": (-10.0, 165.0),
    "sh_flex": (-55.0, 175.0),
    "sh_twist": (-60.0, 80.0),
    "elbow": (0.0, 145.0),
    "hip_abd": (-5.0, 50.0),
    "hip_flex": (-25.0, 125.0),
    "hip_twist": (-10.0, 35.0),
    "knee": (0.0, 140.0),
    "foot": (0.0, 1.0),
    "root_pitch": (-12.0, 25.0),
    "root_roll": (-12.0, 12.0),
    "root_yaw": (-180.0, 180.0),
}
"""How far the joints of a wild pose go, by their names in ANGLES without the side."""
CALM: Final = 1.3
"""Wild angles gather about what is held at rest: the power of a chance that is at most 1."""
REST_DEG: Final = {"sh_abd": 10.0, "sh_flex": 5.0, "elbow": 15.0, "hip_flex": 3.0, "knee": 5.0}
FALLEN_DEG: Final = (50.0, 110.0)
DISTANCE_M, RISE_DEG, ROLL_DEG = (1.6, 7.0), (-12.0, 55.0), 8.0
"""Range of the cameras, how far above the body's middle they stand, and how they are rolled."""
ANYHOW_SHARE: Final = 0.08
"""Of the pictures: how many are rolled in any way."""
FRAME: Final = (-0.12, 0.3)
"""Logarithm of how much larger a picture is than FRAMED times the body's longer side."""
FRAMED: Final = 1.25
"""The longer side of the body's box in an ideal picture, over it: what a viewer cuts out."""
SMALL_SHARE, SMALL = 0.12, (0.3, 1.2)
"""Of the pictures: how many show the person smaller, and by what logarithm."""
ASIDE: Final = (0.04, 0.14)
"""Standard deviation of the body's middle from the picture's, in sides; seldom the second."""
ASTRAY_SHARE: Final = 0.2
"""Of the pictures: how many are farther off."""
SEEN_AS: Final = [JOINTS.index(name) for name in JOINT_NAMES]


class PictureExample(NamedTuple):
    """One person in one picture, before no background."""

    body: NDArray[np.uint8]
    """(SIDE_PX, SIDE_PX, 4) blue, green, red, times coverage; coverage."""
    outline: NDArray[np.uint8]
    """(SIDE_PX, SIDE_PX) 1 inside of the silhouette, as it is cut out of a film."""
    joints_px: NDArray[np.float32]
    """(15, 2) JOINT_NAMES order; also beyond the picture."""
    facing: NDArray[np.float32]
    """(2,) the front of the trunk in the camera's axes: to the right, towards the camera."""
    stature_px: float
    """Of the person upright, at that distance."""


class _View(NamedTuple):
    """One picture's camera: rows of its axes in the world, and where it stands."""

    axes: NDArray[np.float64]
    place_m: Vector


def picture_examples(seed: int) -> Iterator[PictureExample]:
    """The pictures of one person; a seed is a person."""
    rng = np.random.default_rng([seed, 79])
    someone = dressed(differing(person(int(rng.integers(*PEOPLE))), rng), rng)
    mesh, body = body_mesh(someone), _poses(someone, rng)
    for i in range(PICTURES):
        shown = _example(someone, mesh, body, i, rng)
        if shown is not None:
            yield shown


def _poses(someone: Person, rng: np.random.Generator) -> Posed:
    """PICTURES poses."""
    if rng.random() < WILD_SHARE:
        angles = _wild(rng)
    else:
        moved = course(someone, AT_LARGE, rng)
        angles = moved[rng.integers(len(moved), size=PICTURES)]
        angles[:, ANGLES.index("root_yaw")] += rng.uniform(-180.0, 180.0)
    return posed(someone.measures, angles, np.zeros(2), np.zeros((PICTURES, 2)))


def _wild(rng: np.random.Generator) -> NDArray[np.float64]:
    """(PICTURES, 27) angles of poses without order."""
    columns = []
    for name in ANGLES:
        low, high = WILD_DEG[name[2:] if name[1] == "_" else name]
        rest = REST_DEG.get(name[2:], 0.5 * (low + high) if name[1] == "_" else 0.0)
        reach = rng.uniform(low, high, PICTURES)
        if name != "root_yaw":
            reach = rest + (reach - rest) * rng.random(PICTURES) ** CALM
        columns.append(reach)
    angles = np.stack(columns, axis=1)
    fallen = rng.random(PICTURES) < FALLEN_SHARE
    for name in ("root_pitch", "root_roll"):
        lying = rng.uniform(*FALLEN_DEG, PICTURES) * rng.choice([-1.0, 0.0, 1.0], PICTURES)
        angles[fallen, ANGLES.index(name)] += lying[fallen]
    return angles


def _example(
    someone: Person, mesh: Mesh, body: Posed, i: int, rng: np.random.Generator
) -> PictureExample | None:
    """One picture; None where the body is partly behind the camera."""
    places = np.empty_like(mesh.vertices_m)
    skin(mesh.vertices_m, mesh.origins_m, mesh.bones, mesh.shares, body.bones[i], places)
    view = _looking(places.mean(axis=0), rng)
    seen = (places - view.place_m) @ view.axes.T
    if seen[:, 2].min() < 0.3:
        return None
    flat = seen[:, :2] / seen[:, 2:]
    corner, side = _framed(flat, rng)
    light = rng.normal((0.0, 1.2, 0.0), 1.0)
    shaded = np.empty(len(places))
    shade(places, mesh.faces, light / np.linalg.norm(light), np.empty_like(places), shaded)
    drawn = _drawn(someone, mesh, (flat - corner) / side * SIDE_PX, seen[:, 2], shaded)
    outline = spoilt((drawn[..., 3] >= 0.5).astype(np.uint8), flaw(1, rng), 0)
    joints = (body.joints_m[i, SEEN_AS] - view.place_m) @ view.axes.T
    front = view.axes @ body.bones[i, BONE_INDEX["chest"], :, 2]
    return PictureExample(
        np.rint(np.clip(drawn * [1.0, 1.0, 1.0, 255.0], 0, 255)).astype(np.uint8),
        outline,
        ((joints[:, :2] / joints[:, 2:] - corner) / side * SIDE_PX).astype(np.float32),
        np.array([front[0], -front[2]], np.float32),
        float(someone.measures["stature_m"] / joints[0, 2] / side * SIDE_PX),
    )


def _looking(middle_m: Vector, rng: np.random.Generator) -> _View:
    """A camera that looks at a body from anywhere."""
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


def _drawn(
    someone: Person, mesh: Mesh, pixels: Vector, depths: Vector, shaded: Vector
) -> NDArray[np.float32]:
    """Colours times coverage, and coverage, (SIDE_PX, SIDE_PX, 4)."""
    look = someone.look
    pattern = (float(PATTERNS.index(look.pattern)), look.pitch_m, float(MATERIAL["shirt"]))
    fine = SIDE_PX * FINER
    nearest, colours = np.zeros((fine, fine)), np.zeros((fine, fine, 3), np.float32)
    draw(
        pixels * FINER,
        depths,
        shaded,
        mesh.vertices_m,
        mesh.faces,
        mesh.materials,
        palette(look),
        pattern,
        nearest,
        colours,
    )
    body = np.zeros((SIDE_PX, SIDE_PX, 4), np.float32)
    gather(nearest, colours, FINER, body, 1.0, np.empty((SIDE_PX, SIDE_PX), np.float32))
    return body
