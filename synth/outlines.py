"""Outlines of made-up people in two cameras, without light: what a network is taught on."""

from collections.abc import Iterator
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.camera import Rig, paper_rig, project
from synth.footing import Posed, posed
from synth.mesh import Mesh, body_mesh
from synth.motions import POSTURES, TPOSE, Motion, performance
from synth.people import Person, person
from synth.raster import cover, skin
from synth.skeleton import ANGLES, JOINTS

FPS: Final = 6.0
"""Instants a second of a performance that are used: nearer ones teach nothing new."""
FREE_SHARE: Final = 0.25
"""Of the performances, how many are no posture."""
OTHER_ARMS: Final = 0.35
"""Share of the performances with the arms of another one."""
ARM_DEG, REST_DEG = (0.0, 3.0, 8.0, 20.0), (0.0, 2.0, 4.0, 6.0)
"""Standard deviations that arms, and all else, are turned by; one of them for a performance."""
YAW_DEG: Final = (4.0, 4.0, 15.0)
"""The same for the whole body about the vertical."""
OPENING_LEFT_OUT: Final = 0.5
"""Share of the T-pose's frames that are left out: all performances begin with it."""
WIDTHS_PX: Final = (160, 320)
DISTANCES_M, HEIGHTS_M, FOCALS = (3.8, 5.5), (0.8, 1.4), (1.1, 1.35)
"""Ranges of cameras; focal lengths in widths of the picture at 4.5 m."""
ROOM_M: Final = 0.5
"""How far from the middle somebody stands."""
JITTER_PX: Final = 0.25
"""Standard deviation of a silhouette's place."""
SHADOW_SHARE, THICK_SHARE, THIN_SHARE, ROUND_SHARE = 0.5, 0.3, 0.1, 0.15
"""Of the silhouettes: how many keep a shadow at the feet, are a pixel too thick or too thin
somewhere, or have their thin parts rounded off."""

ARMS: Final = np.array(["_sh_" in name or "elbow" in name for name in ANGLES])
BENT: Final = [i for i, name in enumerate(ANGLES) if "elbow" in name or "knee" in name]
FEET: Final = [i for i, name in enumerate(ANGLES) if "foot" in name]
ROOT: Final = np.array([name.startswith("root") for name in ANGLES])
YAW: Final = ANGLES.index("root_yaw")


class Outline(NamedTuple):
    """One instant."""

    masks: tuple[NDArray[np.bool_], NDArray[np.bool_]]
    joints_m: NDArray[np.float64]
    """(20, 3), order of JOINTS."""
    rig: Rig
    stature_m: float


def outlines(seed: int) -> Iterator[Outline]:
    """Instants of one performance by one person before two cameras; a seed is a performance."""
    rng = np.random.default_rng([seed, 77])
    someone = person(int(rng.integers(1000, 1_000_000)))
    angles, opening = _angles(someone, rng)
    body = posed(someone.measures, angles, np.zeros(2))
    mesh, rig = body_mesh(someone), _rig(rng)
    for i in range(len(angles)):
        if i < opening and rng.random() < OPENING_LEFT_OUT:
            continue
        masks, joints = _seen(mesh, body, i, rig, rng)
        yield Outline(masks, joints, rig, someone.measures["stature_m"])


def _angles(someone: Person, rng: np.random.Generator) -> tuple[NDArray[np.float64], int]:
    """(n, 27) of a performance, made more various; how many of its frames are the opening."""
    moved, other = (_performed(someone, rng) for _ in range(2))
    angles = moved.angles_deg[moved.present].copy()
    if rng.random() < OTHER_ARMS:
        theirs = other.angles_deg[other.present]
        at = (np.arange(len(angles)) + int(rng.integers(len(theirs)))) % len(theirs)
        angles[:, ARMS] = theirs[at][:, ARMS]
    spread = np.where(ARMS, rng.choice(ARM_DEG), rng.choice(REST_DEG))
    spread[ROOT], spread[FEET] = np.minimum(spread[ROOT], REST_DEG[2]), 0.0
    angles += rng.normal(0.0, 1.0, angles.shape) * spread
    angles[:, BENT] = np.abs(angles[:, BENT])
    angles[:, YAW] = rng.normal(0.0, rng.choice(YAW_DEG), len(angles))
    return angles, int((moved.phase[moved.present] == TPOSE).sum())


def _performed(someone: Person, rng: np.random.Generator) -> Motion:
    name = "free" if rng.random() < FREE_SHARE else POSTURES[int(rng.integers(len(POSTURES)))]
    return performance(someone, name, int(rng.integers(1_000_000)), FPS)


def _rig(rng: np.random.Generator) -> Rig:
    width = int(rng.choice(WIDTHS_PX))
    far, high = rng.uniform(*DISTANCES_M, 2), rng.uniform(*HEIGHTS_M, 2)
    focal = width * rng.uniform(*FOCALS) * far / 4.5
    return paper_rig(
        (width, width * 3 // 4), (focal[0], focal[1]), (far[0], far[1]), (high[0], high[1])
    )


def _seen(
    mesh: Mesh, body: Posed, i: int, rig: Rig, rng: np.random.Generator
) -> tuple[tuple[NDArray[np.bool_], NDArray[np.bool_]], NDArray[np.float64]]:
    """Both silhouettes of an instant, and the joints, somewhere in the room."""
    places = np.empty_like(mesh.vertices_m)
    skin(mesh.vertices_m, mesh.origins_m, mesh.bones, mesh.shares, body.bones[i], places)
    x, z = rng.uniform(-ROOM_M, ROOM_M, 2)
    moved = np.array([x, 0.0, z]) - body.joints_m[i, JOINTS.index("pelvis")] * [1.0, 0.0, 1.0]
    masks = []
    for camera in rig.cameras:
        mask = np.zeros((rig.height, rig.width), np.uint8)
        cover(project(camera, places + moved) + rng.normal(0.0, JITTER_PX, 2), mesh.faces, mask)
        masks.append(_spoilt(mask, rng).astype(bool))
    return (masks[0], masks[1]), body.joints_m[i] + moved


def _spoilt(mask: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """A silhouette as one that was cut out of a film: with a shadow, too thick, too thin."""
    kernel = np.ones(1 + rng.integers(0, 2, 2), np.uint8)
    if rng.random() < SHADOW_SHARE:
        mask = _shadowed(mask, rng)
    if (chance := rng.random()) < THICK_SHARE:
        return np.asarray(cv2.dilate(mask, kernel), np.uint8)
    if chance < THICK_SHARE + THIN_SHARE:
        return np.asarray(cv2.erode(mask, kernel), np.uint8)
    if chance < THICK_SHARE + THIN_SHARE + ROUND_SHARE:
        return np.asarray(cv2.medianBlur(mask, 3), np.uint8)
    return mask


def _shadowed(mask: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """With a flat blot on the floor beside a foot."""
    rows = np.flatnonzero(mask.any(axis=1))
    if not len(rows):
        return mask
    tall = int(rows[-1] - rows[0])
    feet = np.flatnonzero(mask[rows[-1] - tall // 40])
    middle = (
        int(rng.choice(feet)) if len(feet) else 0,
        int(rows[-1] - rng.uniform(0, 0.02) * tall),
    )
    size = (int(rng.uniform(0.03, 0.14) * tall), int(rng.uniform(0.005, 0.02) * tall))
    return np.asarray(cv2.ellipse(mask.copy(), middle, size, 0, 0, 360, 1, -1), np.uint8)
