"""A performer's surface: tubes of skin and cloth on the bones."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.person.people import Person
from synth.person.portrait import hand, head, shoe, thumb
from synth.person.rings import lofted
from synth.person.skeleton import BONE_INDEX, BONES, rest_origins
from synth.person.tailor import arm, leg, trunk


class Mesh(NamedTuple):
    """A surface at rest and its skinning."""

    vertices_m: NDArray[np.float64]
    """(v, 3) in the resting body."""
    origins_m: NDArray[np.float64]
    """(bones, 3) starts of the bones at rest."""
    bones: NDArray[np.int64]
    """(v, 2) indices in BONES."""
    shares: Vector
    """(v,) weight of the second bone."""
    faces: NDArray[np.int64]
    """(f, 3) seen from outside anticlockwise."""
    materials: NDArray[np.int64]
    """(f,) indices in MATERIALS."""


def body_mesh(someone: Person) -> Mesh:
    """The clothed body of a person."""
    at = rest_origins(someone.measures)
    tubes = [trunk(someone, at), *head(someone, at)]
    shoes = []
    for side in "lr":
        tubes += [arm(someone, at, side), hand(someone, at, side), thumb(someone, at, side)]
        tubes.append(leg(someone, at, side))
        shoes.append(shoe(someone, at, side))
    parts = [lofted(tube, "y") for tube in tubes] + [lofted(shoe, "z") for shoe in shoes]
    counts = np.cumsum([0] + [len(part[0]) for part in parts[:-1]])
    vertices, bones, shares = (np.concatenate([part[i] for part in parts]) for i in range(3))
    faces = np.concatenate([part[3] + n for part, n in zip(parts, counts, strict=True)])
    materials = np.concatenate([part[4] for part in parts])
    vertices = _with_flat_soles(vertices, bones)
    origins = np.stack([at[name] for name in BONES])
    return Mesh(vertices, origins, bones, shares, faces, materials)


def _with_flat_soles(
    vertices: NDArray[np.float64], bones: NDArray[np.int64]
) -> NDArray[np.float64]:
    """No part of a shoe lies below the floor of the resting body."""
    shoe = np.isin(bones[:, 0], [BONE_INDEX["l_foot"], BONE_INDEX["r_foot"]])
    found = vertices.copy()
    found[shoe, 1] = np.maximum(found[shoe, 1], 0.0)
    return found
