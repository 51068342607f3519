"""Silhouettes of synthetic people in two cameras, without light, as training data."""

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from common.raster.similarity import Mask
from common.rig.camera import Camera, Rig, project
from synth.motion.footing import Posed, posed
from synth.motion.motions import MOTION, POSTURES, performance
from synth.person.mesh import Mesh, body_mesh
from synth.person.people import Person, person
from synth.person.skeleton import ANGLES
from synth.picture.mask_flaws import Flaw, flaw, spoilt
from synth.picture.random_rig import random_rig
from synth.picture.raster import cover, skin

FPS: Final = 15.0
PEOPLE: Final = (100_000, 1_000_000)
"""Seeds of training people; test people have lower ones."""
LONGEST: Final = 90
"""Number of instants of one performance that are drawn."""
TURNED_SHARE: Final = 0.25
"""Share of the performances of postures with any heading and turns."""
OTHER_ARMS: Final = 0.3
"""Share of the performances with the arms of another one."""
FAST_SHARE: Final = 0.2
SPEEDS, FAST = (0.7, 1.3), (1.3, 2.3)
ARM_DEG, REST_DEG = (0.0, 3.0, 8.0, 20.0), (0.0, 2.0, 4.0, 6.0)
"""Standard deviations of constant rotations of arms, and of the rest, per performance."""
YAW_DEG: Final = (4.0, 4.0, 15.0)
"""Standard deviation of the whole body's constant yaw, per performance."""
TURNING_DEG: Final = 180.0
"""Range of a turning person's yaw, to either side."""
THICKER, LONGER, LOOSER = 0.06, 0.02, (0.5, 2.0)
"""Further variation of bodies beyond `person`: standard deviations of the factors on thicknesses
and lengths, and the range of the clothes' looseness."""
ROOM_M: Final = 0.6
"""Range of a person's distance from the middle."""
JITTER_PX: Final = 0.25
"""Standard deviation of a silhouette's place, pixels."""
ALONE_SHARE, GAP_SHARE, DROP_SHARE = 0.15, 0.15, 0.03
"""Shares of the performances with one camera alone, throughout or for a while; share of missing
instants."""

ARMS: Final = np.array(["_sh_" in name or "elbow" in name for name in ANGLES])
BENT: Final = [i for i, name in enumerate(ANGLES) if "elbow" in name or "knee" in name]
FEET: Final = [i for i, name in enumerate(ANGLES) if "foot" in name]
ROOT: Final = np.array([name.startswith("root") for name in ANGLES])
LEANS: Final = [
    ANGLES.index(f"{part}_{way}") for part in ("root", "torso") for way in ("pitch", "roll")
]
YAW: Final = ANGLES.index("root_yaw")
FARTHER: Final = {"hip_abd": 2.0, "torso_roll": 1.6, "root_roll": 5.0, "root_pitch": 2.0}
WIDER: Final = np.array([FARTHER.get(name.split("_", name[1] == "_")[-1], 1.0) for name in ANGLES])
"""Factor on the angles of people who lean and lift farther."""


class SilhouetteExample(NamedTuple):
    """One instant."""

    masks: tuple[Mask | None, Mask | None]
    """None where that camera does not see it."""
    joints_m: NDArray[np.float64]
    """(20, 3), order of the skeleton's joints."""
    rig: Rig
    stature_m: float
    since_s: float
    """Time since the instant before."""


class Manner(NamedTuple):
    """Kinds of synthetic performances."""

    free: float
    """Share that are no posture."""
    late: float
    """Share that are joined after their opening."""
    leaning: float
    """Share that lean with the whole body."""
    lean_deg: float
    """Standard deviation of that lean."""
    wider: float
    """Share that lean and lift their legs farther sideways than people do in free motion."""
    slanted: float
    """Share of the rigs that stand anywhere, look down, are rolled."""
    distances_m: tuple[float, float]
    """Range of the cameras' distance."""


ORDINARY: Final = Manner(0.3, 0.4, 0.15, 14.0, 0.0, 0.25, (3.4, 5.6))
AT_LARGE: Final = Manner(0.65, 0.8, 0.3, 20.0, 0.25, 0.4, (2.3, 5.6))
"""Free motion, also close to cameras that stand anywhere."""


def silhouette_examples(seed: int, manner: Manner = ORDINARY) -> Iterator[SilhouetteExample]:
    """The instants of one performance by one person before two cameras; each seed is one
    performance."""
    rng = np.random.default_rng([seed, 77])
    someone = differing(person(int(rng.integers(*PEOPLE))), rng)
    angles = course(someone, manner, rng)
    leash = rng.uniform(-ROOM_M, ROOM_M, 2)
    body = posed(someone.measures, angles, leash, np.tile(leash, (len(angles), 1)))
    mesh, rig = body_mesh(someone), random_rig(rng, manner.slanted, manner.distances_m)
    present = _present(len(angles), rng)
    flaws = (flaw(len(angles), rng), flaw(len(angles), rng))
    since_s = 1.0 / FPS
    for i in range(len(angles)):
        if i and rng.random() < DROP_SHARE:
            since_s += 1.0 / FPS
            continue
        masks = _seen(mesh, body, i, rig, flaws, rng)
        shown = tuple(mask if seen else None for mask, seen in zip(masks, present[i], strict=True))
        first, second = shown
        yield SilhouetteExample(
            (first, second), body.joints_m[i], rig, someone.measures["stature_m"], since_s
        )
        since_s = 1.0 / FPS


def differing(someone: Person, rng: np.random.Generator) -> Person:
    """The same person with other proportions and nearly the same stature."""
    measures = {
        name: value
        * (1.0 + rng.normal() * (THICKER if "half" in name or "radius" in name else LONGER))
        for name, value in someone.measures.items()
    }
    measures["stature_m"] = someone.measures["stature_m"]
    look, slack = someone.look, rng.uniform(*LOOSER, 2)
    look = look._replace(
        loose_top_m=look.loose_top_m * slack[0], loose_legs_m=look.loose_legs_m * slack[1]
    )
    return someone._replace(measures=measures, look=look)


def course(someone: Person, manner: Manner, rng: np.random.Generator) -> NDArray[np.float64]:
    """(n, 27) angles of a performance with more variation."""
    chance = rng.random()
    name = "free" if chance < manner.free else POSTURES[int(rng.integers(len(POSTURES)))]
    speed = rng.uniform(*(FAST if rng.random() < FAST_SHARE else SPEEDS))
    motion = performance(someone, name, int(rng.integers(1_000_000)), FPS / speed)
    angles = motion.angles_deg[motion.present].copy()
    opening = int((motion.phase[motion.present] < MOTION).sum())
    if rng.random() < OTHER_ARMS:
        angles[opening:, ARMS] = _others_arms(someone, speed, len(angles) - opening, rng)
    t = np.arange(len(angles)) / FPS
    if manner.wider and rng.random() < manner.wider:
        angles[opening:] *= WIDER
    angles += _swaying(t, manner, rng)
    angles[:, BENT] = np.abs(angles[:, BENT])
    if name != "free":
        angles[:, YAW] += _yaw(t, chance < manner.free + TURNED_SHARE, rng)
    start = int(rng.integers(len(angles) // 2)) if rng.random() < manner.late else 0
    return angles[start : start + LONGEST]


def _others_arms(
    someone: Person, speed: float, n: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """(n, arms) angles of another movement, forwards and backwards."""
    name = POSTURES[int(rng.integers(len(POSTURES)))]
    other = performance(someone, name, int(rng.integers(1_000_000)), FPS / speed)
    theirs = other.angles_deg[other.present][:, ARMS]
    at = (np.arange(n) + int(rng.integers(len(theirs)))) % (2 * len(theirs) - 2)
    return np.asarray(theirs[np.minimum(at, 2 * len(theirs) - 2 - at)])


def _swaying(t: Vector, manner: Manner, rng: np.random.Generator) -> NDArray[np.float64]:
    """(n, 27) to add: each joint gets an offset and a drift."""
    spread = np.where(ARMS, rng.choice(ARM_DEG), rng.choice(REST_DEG))
    spread[ROOT], spread[FEET], spread[YAW] = np.minimum(spread[ROOT], REST_DEG[2]), 0.0, 0.0
    if rng.random() < manner.leaning:
        spread[LEANS] = manner.lean_deg
    held, size = rng.normal(0.0, 0.7, (2, len(ANGLES)))
    waves = np.sin(2 * np.pi * (np.outer(t, rng.uniform(0.2, 1.5, len(ANGLES))) + rng.random()))
    return np.asarray(spread * (held + size * waves))


def _yaw(t: Vector, turning: bool, rng: np.random.Generator) -> Vector:
    """Yaw, degrees."""
    if not turning:
        waves = np.sin(2 * np.pi * (t * rng.uniform(0.1, 0.6) + rng.random()))
        return np.asarray(rng.choice(YAW_DEG) * (rng.normal() + 0.4 * rng.normal() * waves))
    starts = rng.uniform(-180.0, 180.0) if rng.random() < 0.5 else 0.0
    begin, lasts = rng.uniform(0.0, t[-1]), rng.uniform(0.5, 3.0)
    way = np.clip((t - begin) / lasts, 0.0, 1.0)
    return np.asarray(starts + rng.uniform(-TURNING_DEG, TURNING_DEG) * way * way * (3 - 2 * way))


def _present(n: int, rng: np.random.Generator) -> NDArray[np.bool_]:
    """(n, 2) which cameras see each instant; at least one does."""
    present, chance = np.ones((n, 2), np.bool_), rng.random()
    which = int(rng.integers(2))
    if chance < ALONE_SHARE:
        present[:, which] = False
    elif chance < ALONE_SHARE + GAP_SHARE:
        start = int(rng.integers(n))
        present[start : start + int(rng.integers(5, 40)), which] = False
    return present


def _seen(
    mesh: Mesh,
    body: Posed,
    i: int,
    rig: Rig,
    flaws: tuple[Flaw, Flaw],
    rng: np.random.Generator,
) -> list[Mask]:
    """Both silhouettes of an instant, with the flaws of segmented ones."""
    masks = []
    for camera, wrong in zip(rig.cameras, flaws, strict=True):
        jitter_px = rng.normal(0.0, JITTER_PX, 2)
        mask = exact_mask(mesh, body.bones[i], camera, (rig.width, rig.height), jitter_px)
        masks.append(spoilt(mask, wrong, i).astype(bool))
    return masks


def exact_mask(
    mesh: Mesh,
    bones: NDArray[np.float64],
    camera: Camera,
    size: tuple[int, int],
    jitter_px: Vector | float = 0.0,
) -> NDArray[np.uint8]:
    """The exact silhouette of a body, (H, W), 1 inside.

    Args:
        mesh: At rest.
        bones: Their frames, (bones, 3, 4).
        camera: The camera.
        size: (width, height) of the picture.
        jitter_px: Displacement of the silhouette, (2,).
    """
    places = np.empty_like(mesh.vertices_m)
    skin(mesh.vertices_m, mesh.origins_m, mesh.bones, mesh.shares, bones, places)
    mask = np.zeros((size[1], size[0]), np.uint8)
    cover(project(camera, places) + jitter_px, mesh.faces, mask)
    return mask
