"""Clothes on Anny bodies: painted on the skin, and offset from it like cloth."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.anny_people.anatomy import anatomy
from synth.anny_people.figures import Figure
from synth.anny_people.folds import folds
from synth.anny_people.hair_and_face import grow_hair, paint_face
from synth.anny_people.limb_regions import NOWHERE, Regions, regions
from synth.anny_people.skirt import Tube, tube_about
from synth.person.people import Look
from synth.person.rings import MATERIAL

SLEEVE_ENDS: Final = {"none": (-0.1, 0.25), "short": (0.4, 0.95), "long": (1.7, 2.0)}
"""Ends of sleeves along an arm."""
SHORTS_END, LEGS_END = (0.35, 1.2), (1.75, 2.05)
"""Ends of trousers along a leg."""
BOOT_SHARE: Final = 0.1
SHOE_TOP_M, BOOT_TOP_M = (0.0, 0.07), (0.1, 0.3)
"""Height of shoes and boots above the ankles."""
SOLE_M: Final = (0.006, 0.014)
"""Thickness of shoes."""
NECKLINE_M, NECKLINE_DROP = (-0.075, 0.035), (0.2, 1.0)
"""Height of a shirt's edge above the base of the neck, and its fall per metre ahead."""
COLLAR_HALF_M: Final = 0.12
CLOTH_M: Final = 0.003
"""Smallest distance of cloth from the skin."""
FLARE_M: Final = (-0.01, 0.035)
"""Additional width of trousers at the ankle, beyond the leg and their looseness."""
FOLD_SHARE: Final = 0.3
"""Relative change of the cloth's distance over the surface."""
HANGS_M: Final = 0.03
"""Length of a shirt below the hips from which on it hangs in front of and between the thighs."""
COAT_M: Final = 0.12
"""Length from which on it is a coat."""
SKIRT_SHARE, SKIRT_M = 0.05, (0.15, 0.6)
"""Share of people without a coat who wear a skirt; range of its length below the hips."""
WAIST_M: Final = 0.07
"""Height above the hips where hanging cloth begins."""


class Dressed(NamedTuple):
    """A clothed surface at rest."""

    vertices_m: NDArray[np.float64]
    """(v, 3)."""
    faces: NDArray[np.int64]
    """(f, 3) seen from outside anticlockwise."""
    materials: NDArray[np.int64]
    """(f,) indices in MATERIALS."""
    weights: NDArray[np.float64]
    """(v, bones)."""


def anny_dressed(figure: Figure, look: Look, rng: np.random.Generator) -> Dressed:
    """A body in clothes.

    Args:
        figure: The naked body.
        look: Clothes, their looseness, and the haircut.
        rng: Source of what a look leaves open.
    """
    known, near = anatomy(), regions(figure)
    hips = float(figure.heads_m["upperleg01.L"][1])
    skirt = look.hem_m < COAT_M and rng.random() < SKIRT_SHARE
    wear = _worn(figure, near, look, hips, rng)
    off_m = _off(figure, near, look, wear, rng)
    if skirt:
        wear[(wear == MATERIAL["trousers"]) & (near.leg > 0.3)] = MATERIAL["skin"]
    grow_hair(figure, near.head, look.hair, wear, off_m, rng)
    paint_face(figure, wear)
    vertices = figure.vertices_m + off_m[:, None] * _normals(figure.vertices_m, known.faces)
    materials = np.sort(wear[known.faces], axis=1)[:, 1]
    body = Dressed(vertices, known.faces, materials, known.weights)
    drop = float(rng.uniform(*SKIRT_M)) if skirt else look.hem_m
    if not skirt and look.hem_m < HANGS_M:
        return body
    cloth, loose_m = ("trousers", look.loose_legs_m) if skirt else ("shirt", look.loose_top_m)
    inside = vertices[(near.leg > -0.8) & (near.leg < 1.9)]
    tube = tube_about(inside, (hips + WAIST_M, hips - drop), 0.3 * loose_m)
    return _joined(body, tube, MATERIAL[cloth])


def _worn(
    figure: Figure, near: Regions, look: Look, hips: float, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Material of each vertex, (v,)."""
    places, neck = figure.vertices_m, figure.heads_m["neck01"]
    skin = MATERIAL["skin"]
    wear = np.full(len(places), MATERIAL["shirt"])
    ahead = np.maximum(0.0, places[:, 2] - neck[2])
    collar = neck[1] + rng.uniform(*NECKLINE_M) - rng.uniform(*NECKLINE_DROP) * ahead
    middle = (near.arm < -0.2) & (np.abs(places[:, 0]) < COLLAR_HALF_M)
    wear[(places[:, 1] > collar) & middle] = skin
    wear[near.head > 0.9] = skin
    wear[near.arm > min(rng.uniform(*SLEEVE_ENDS[look.sleeve]), 2.1)] = skin
    wear[(near.arm == NOWHERE) & (places[:, 1] < hips - look.hem_m)] = MATERIAL["trousers"]
    wear[near.leg > rng.uniform(*(SHORTS_END if look.shorts else LEGS_END))] = skin
    over = rng.uniform(*(BOOT_TOP_M if rng.random() < BOOT_SHARE else SHOE_TOP_M))
    ankle = float(figure.heads_m["foot.L"][1])
    shod = (near.leg > 2.5) | ((near.leg > 1.3) & (places[:, 1] < ankle + over))
    wear[shod & ((wear == skin) | (places[:, 1] < ankle))] = MATERIAL["shoes"]
    return wear


def _off(
    figure: Figure, near: Regions, look: Look, wear: NDArray[np.int64], rng: np.random.Generator
) -> Vector:
    """Distance of the clothes from the skin, (v,) metres."""
    places = figure.vertices_m
    neck, hips = (figure.heads_m[name][1] for name in ("neck01", "upperleg01.L"))
    creased = 1.0 + FOLD_SHARE * folds(places, rng)
    off_m = np.zeros(len(places))
    shirt, trousers = wear == MATERIAL["shirt"], wear == MATERIAL["trousers"]
    down = np.clip((neck - 0.1 - places[:, 1]) / (neck - 0.1 - hips), 0.0, 1.0)
    sag = np.where(near.arm > NOWHERE, np.clip(near.arm, 0.0, 1.0), down)
    off_m[shirt] = look.loose_top_m * (0.25 + 0.75 * sag[shirt])
    leg = near.leg[trousers]
    off_m[trousers] = look.loose_legs_m * (0.3 + 0.7 * np.clip(leg / 1.2, 0.0, 1.0))
    off_m[trousers] += rng.uniform(*FLARE_M) * np.clip((leg - 0.6) / 1.2, 0.0, 1.0)
    off_m = np.maximum(off_m * creased, CLOTH_M * (shirt | trousers))
    off_m[wear == MATERIAL["shoes"]] = rng.uniform(*SOLE_M)
    return off_m


def _normals(places: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """(v, 3) outward normals, unit length."""
    a, b, c = (places[faces[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    found = np.zeros_like(places)
    for corner in range(3):
        for axis in range(3):
            found[:, axis] += np.bincount(faces[:, corner], across[:, axis], len(places))
    return np.asarray(found / (np.linalg.norm(found, axis=1, keepdims=True) + 1e-12))


def _joined(body: Dressed, tube: Tube, material: int) -> Dressed:
    return Dressed(
        np.concatenate([body.vertices_m, tube.vertices_m]),
        np.concatenate([body.faces, tube.faces + len(body.vertices_m)]),
        np.concatenate([body.materials, np.full(len(tube.faces), material)]),
        np.concatenate([body.weights, tube.weights]),
    )
