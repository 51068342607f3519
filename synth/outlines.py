"""Outlines of made-up people in two cameras, without light: what a network is taught on."""

from collections.abc import Iterator
from typing import Final, Literal, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body import Vector
from common.camera import Camera, Rig, as_matrix, as_row, paper_rig, project
from synth.footing import Posed, posed
from synth.mesh import Mesh, body_mesh
from synth.motions import MOTION, POSTURES, performance
from synth.people import Person, person
from synth.raster import cover, skin
from synth.skeleton import ANGLES, turned

FPS: Final = 15.0
PEOPLE: Final = (100_000, 1_000_000)
"""Numbers of those who are taught on; whoever is made up for a test has a lower one."""
LONGEST: Final = 90
"""Instants of one performance that are drawn."""
FREE_SHARE, TURNED_SHARE = 0.3, 0.25
"""Of the performances: how many are no posture; how many postures face anywhere and turn."""
OTHER_ARMS: Final = 0.3
"""Share of the performances with the arms of another one."""
LATE_SHARE: Final = 0.4
"""Share of the performances that are joined after their opening."""
FAST_SHARE: Final = 0.2
SPEEDS, FAST = (0.7, 1.3), (1.3, 2.3)
ARM_DEG, REST_DEG = (0.0, 3.0, 8.0, 20.0), (0.0, 2.0, 4.0, 6.0)
"""Standard deviations that arms, and all else, are turned by; one of them for a performance."""
LEANING_SHARE, LEAN_DEG = 0.15, 14.0
"""Of the performances: how many lean over with the whole body; the standard deviation of that."""
YAW_DEG: Final = (4.0, 4.0, 15.0)
"""The same for the whole body about the vertical."""
TURNING_DEG: Final = 180.0
"""How far somebody who turns goes round, to either side."""
THICKER, LONGER, LOOSER = 0.06, 0.02, (0.5, 2.0)
"""How bodies differ beyond those of `person`: standard deviations of what a thickness and a length
are multiplied by, and the range of what the room in their clothes is."""
WIDTHS_PX: Final = (160, 320)
DISTANCES_M, HEIGHTS_M, FOCALS = (3.4, 5.6), (0.8, 1.4), (1.0, 1.4)
"""Ranges of cameras; focal lengths in widths of the picture at 4.5 m."""
SLANTED_SHARE: Final = 0.25
"""Of the rigs: how many stand anywhere, look down, are rolled."""
APART_DEG, RISE_M, ROLL_DEG = (50.0, 130.0), (0.5, 2.6), 6.0
ROOM_M: Final = 0.6
"""How far from the middle somebody stands."""
JITTER_PX: Final = 0.25
"""Standard deviation of a silhouette's place."""
ALONE_SHARE, GAP_SHARE, DROP_SHARE = 0.15, 0.15, 0.03
"""Of the performances: how many one camera sees alone, or for a while; of the instants: how many
are missing."""
SHADOW_SHARE, THICK_SHARE, THIN_SHARE, ROUND_SHARE = 0.5, 0.3, 0.1, 0.15
"""Of the silhouettes of a camera: how many keep a shadow at the feet, are a pixel too thick or too
thin somewhere, or have their thin parts rounded off."""
HOLE_SHARE: Final = 0.3
"""Of the cameras: in how many pieces of the silhouette are missing for a while."""

ARMS: Final = np.array(["_sh_" in name or "elbow" in name for name in ANGLES])
BENT: Final = [i for i, name in enumerate(ANGLES) if "elbow" in name or "knee" in name]
FEET: Final = [i for i, name in enumerate(ANGLES) if "foot" in name]
ROOT: Final = np.array([name.startswith("root") for name in ANGLES])
LEANS: Final = [
    ANGLES.index(f"{part}_{way}") for part in ("root", "torso") for way in ("pitch", "roll")
]
YAW: Final = ANGLES.index("root_yaw")

Mask = NDArray[np.bool_]


class Outline(NamedTuple):
    """One instant."""

    masks: tuple[Mask | None, Mask | None]
    """None where that camera does not see it."""
    joints_m: NDArray[np.float64]
    """(20, 3), order of the skeleton's joints."""
    rig: Rig
    stature_m: float
    since_s: float
    """Time since the instant before."""


class Flaw(NamedTuple):
    """How the silhouettes of one camera are wrong, all through a performance."""

    kind: Literal["thick", "thin", "round", "none"]
    kernel: tuple[int, int]
    shadow: tuple[float, float, float, float] | None
    """The blot at the feet: where between them, how low, how wide, how high, in heights."""
    holes: NDArray[np.bool_]
    """(n,) whether a piece is missing."""
    hole: tuple[float, float, float, float]
    """Its place (right, down) and half sizes, as shares of the silhouette's box."""


def outlines(seed: int) -> Iterator[Outline]:
    """The instants of one performance by one person before two cameras; a seed is a performance."""
    rng = np.random.default_rng([seed, 77])
    someone = _differing(person(int(rng.integers(*PEOPLE))), rng)
    angles = _angles(someone, rng)
    leash = rng.uniform(-ROOM_M, ROOM_M, 2)
    body = posed(someone.measures, angles, leash, np.tile(leash, (len(angles), 1)))
    mesh, rig = body_mesh(someone), _rig(rng)
    present = _present(len(angles), rng)
    flaws = (_flaw(len(angles), rng), _flaw(len(angles), rng))
    since_s = 1.0 / FPS
    for i in range(len(angles)):
        if i and rng.random() < DROP_SHARE:
            since_s += 1.0 / FPS
            continue
        masks = _seen(mesh, body, i, rig, flaws, rng)
        shown = tuple(mask if seen else None for mask, seen in zip(masks, present[i], strict=True))
        first, second = shown
        yield Outline(
            (first, second), body.joints_m[i], rig, someone.measures["stature_m"], since_s
        )
        since_s = 1.0 / FPS


def _differing(someone: Person, rng: np.random.Generator) -> Person:
    """The same person with other proportions; the stature stays about the same."""
    measures = {
        name: value
        * (1.0 + rng.normal() * (THICKER if "half" in name or "radius" in name else LONGER))
        for name, value in someone.measures.items()
    }
    measures["stature_m"] = someone.measures["stature_m"]
    look, room = someone.look, rng.uniform(*LOOSER, 2)
    look = look._replace(
        loose_top_m=look.loose_top_m * room[0], loose_legs_m=look.loose_legs_m * room[1]
    )
    return someone._replace(measures=measures, look=look)


def _angles(someone: Person, rng: np.random.Generator) -> NDArray[np.float64]:
    """(n, 27) of a performance, made more various."""
    chance = rng.random()
    name = "free" if chance < FREE_SHARE else POSTURES[int(rng.integers(len(POSTURES)))]
    speed = rng.uniform(*(FAST if rng.random() < FAST_SHARE else SPEEDS))
    motion = performance(someone, name, int(rng.integers(1_000_000)), FPS / speed)
    angles = motion.angles_deg[motion.present].copy()
    opening = int((motion.phase[motion.present] < MOTION).sum())
    if rng.random() < OTHER_ARMS:
        angles[opening:, ARMS] = _others_arms(someone, speed, len(angles) - opening, rng)
    t = np.arange(len(angles)) / FPS
    angles += _swaying(t, rng)
    angles[:, BENT] = np.abs(angles[:, BENT])
    if name != "free":
        angles[:, YAW] += _yaw(t, chance < FREE_SHARE + TURNED_SHARE, rng)
    start = int(rng.integers(len(angles) // 2)) if rng.random() < LATE_SHARE else 0
    return angles[start : start + LONGEST]


def _others_arms(
    someone: Person, speed: float, n: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """(n, arms) angles of another movement, to and fro."""
    name = POSTURES[int(rng.integers(len(POSTURES)))]
    other = performance(someone, name, int(rng.integers(1_000_000)), FPS / speed)
    theirs = other.angles_deg[other.present][:, ARMS]
    at = (np.arange(n) + int(rng.integers(len(theirs)))) % (2 * len(theirs) - 2)
    return np.asarray(theirs[np.minimum(at, 2 * len(theirs) - 2 - at)])


def _swaying(t: Vector, rng: np.random.Generator) -> NDArray[np.float64]:
    """(n, 27) to add: each joint is held otherwise, and wanders."""
    spread = np.where(ARMS, rng.choice(ARM_DEG), rng.choice(REST_DEG))
    spread[ROOT], spread[FEET], spread[YAW] = np.minimum(spread[ROOT], REST_DEG[2]), 0.0, 0.0
    if rng.random() < LEANING_SHARE:
        spread[LEANS] = LEAN_DEG
    held, size = rng.normal(0.0, 0.7, (2, len(ANGLES)))
    waves = np.sin(2 * np.pi * (np.outer(t, rng.uniform(0.2, 1.5, len(ANGLES))) + rng.random()))
    return np.asarray(spread * (held + size * waves))


def _yaw(t: Vector, turning: bool, rng: np.random.Generator) -> Vector:
    """Degrees about the vertical."""
    if not turning:
        waves = np.sin(2 * np.pi * (t * rng.uniform(0.1, 0.6) + rng.random()))
        return np.asarray(rng.choice(YAW_DEG) * (rng.normal() + 0.4 * rng.normal() * waves))
    starts = rng.uniform(-180.0, 180.0) if rng.random() < 0.5 else 0.0
    begin, lasts = rng.uniform(0.0, t[-1]), rng.uniform(0.5, 3.0)
    way = np.clip((t - begin) / lasts, 0.0, 1.0)
    return np.asarray(starts + rng.uniform(-TURNING_DEG, TURNING_DEG) * way * way * (3 - 2 * way))


def _rig(rng: np.random.Generator) -> Rig:
    width = int(rng.choice(WIDTHS_PX))
    size = (width, width * 3 // 4)
    far, high = rng.uniform(*DISTANCES_M, 2), rng.uniform(*HEIGHTS_M, 2)
    focal = width * rng.uniform(*FOCALS) * far / 4.5
    if rng.random() >= SLANTED_SHARE:
        return paper_rig(size, (focal[0], focal[1]), (far[0], far[1]), (high[0], high[1]))
    apart = rng.uniform(*APART_DEG) * rng.choice([1.0, 1.0, -1.0])
    rises = rng.uniform(*RISE_M, 2)
    return Rig(
        *size,
        tuple(_slanted(n, size, far[n], rises[n], focal[n], -apart * n, rng) for n in (0, 1)),
    )


def _slanted(
    n: int,
    size: tuple[int, int],
    far_m: float,
    high_m: float,
    focal_px: float,
    at_deg: float,
    rng: np.random.Generator,
) -> Camera:
    """A camera somewhere on the circle that looks at the middle of a body, rolled a little."""
    way = np.radians(at_deg)
    place = np.array([far_m * np.sin(way), high_m, far_m * np.cos(way)])
    forward = np.array([0.0, rng.uniform(0.8, 1.1), 0.0]) - place
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    level = np.stack([right, np.cross(forward, right), forward])
    R = turned("z", np.array([rng.normal(0.0, ROLL_DEG)]))[0] @ level
    K = ((focal_px, 0.0, size[0] / 2), (0.0, focal_px, size[1] / 2), (0.0, 0.0, 1.0))
    return Camera(f"cam{n + 1}", K, as_matrix(R), as_row(-R @ place))


def _present(n: int, rng: np.random.Generator) -> NDArray[np.bool_]:
    """(n, 2) which cameras see each instant; always one."""
    present, chance = np.ones((n, 2), np.bool_), rng.random()
    which = int(rng.integers(2))
    if chance < ALONE_SHARE:
        present[:, which] = False
    elif chance < ALONE_SHARE + GAP_SHARE:
        start = int(rng.integers(n))
        present[start : start + int(rng.integers(5, 40)), which] = False
    return present


def _flaw(n: int, rng: np.random.Generator) -> Flaw:
    shares = (THICK_SHARE, THIN_SHARE, ROUND_SHARE)
    at = int(np.searchsorted(np.cumsum(shares), rng.random()))
    kinds: tuple[Literal["thick", "thin", "round", "none"], ...]
    kinds = ("thick", "thin", "round", "none")
    shadow = None
    if rng.random() < SHADOW_SHARE:
        shadow = (rng.random(), *rng.uniform((0.0, 0.03, 0.005), (0.02, 0.14, 0.02)))
    holes = np.zeros(n, np.bool_)
    if rng.random() < HOLE_SHARE:
        start = int(rng.integers(n))
        holes[start : start + int(rng.integers(2, 12))] = True
    hole = (rng.random(), rng.random(), *rng.uniform(0.02, 0.08, 2))
    return Flaw(kinds[at], (int(rng.integers(1, 3)), int(rng.integers(1, 3))), shadow, holes, hole)


def _seen(
    mesh: Mesh,
    body: Posed,
    i: int,
    rig: Rig,
    flaws: tuple[Flaw, Flaw],
    rng: np.random.Generator,
) -> list[Mask]:
    """Both silhouettes of an instant, as they are cut out of a film."""
    masks = []
    for camera, flaw in zip(rig.cameras, flaws, strict=True):
        jitter_px = rng.normal(0.0, JITTER_PX, 2)
        mask = cast(mesh, body.bones[i], camera, (rig.width, rig.height), jitter_px)
        masks.append(_spoilt(mask, flaw, i).astype(bool))
    return masks


def cast(
    mesh: Mesh,
    bones: NDArray[np.float64],
    camera: Camera,
    size: tuple[int, int],
    jitter_px: Vector | float = 0.0,
) -> NDArray[np.uint8]:
    """The exact silhouette of a body, (H, W), 1 inside.

    Args:
        mesh: At rest.
        bones: Where they are, (bones, 3, 4).
        camera: Who looks.
        size: (width, height) of the picture.
        jitter_px: How far beside its place it is seen, (2,).
    """
    places = np.empty_like(mesh.vertices_m)
    skin(mesh.vertices_m, mesh.origins_m, mesh.bones, mesh.shares, bones, places)
    mask = np.zeros((size[1], size[0]), np.uint8)
    cover(project(camera, places) + jitter_px, mesh.faces, mask)
    return mask


def _spoilt(mask: NDArray[np.uint8], flaw: Flaw, i: int) -> NDArray[np.uint8]:
    """A silhouette as one that was cut out of a film: with a shadow, too thick, too thin."""
    if not mask.any():
        return mask
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    tall, wide = int(rows[-1] - rows[0]), int(columns[-1] - columns[0])
    if flaw.shadow is not None:
        share, low, across, high = flaw.shadow
        feet = np.flatnonzero(mask[rows[-1] - tall // 40])
        at = (
            (int(feet[int(share * (len(feet) - 1))]), int(rows[-1] - low * tall))
            if len(feet)
            else (0, 0)
        )
        size = (int(across * tall), int(high * tall))
        mask = np.asarray(cv2.ellipse(mask.copy(), at, size, 0, 0, 360, 1, -1), np.uint8)
    if flaw.holes[i]:
        right, down, half_wide, half_tall = flaw.hole
        at = (int(columns[0] + right * wide), int(rows[0] + down * tall))
        size = (int(half_wide * tall), int(half_tall * tall))
        mask = np.asarray(cv2.ellipse(mask.copy(), at, size, 0, 0, 360, 0, -1), np.uint8)
    kernel = np.ones(flaw.kernel, np.uint8)
    if flaw.kind == "thick":
        return np.asarray(cv2.dilate(mask, kernel), np.uint8)
    if flaw.kind == "thin":
        return np.asarray(cv2.erode(mask, kernel), np.uint8)
    if flaw.kind == "round":
        return np.asarray(cv2.medianBlur(mask, 3), np.uint8)
    return mask
