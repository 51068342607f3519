"""Region of each vertex: its place along an arm or leg, its weight on the head."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.anny_people.anatomy import anatomy
from synth.anny_people.figures import Figure

NOWHERE: Final = -9.0
"""Coordinate along an arm of a vertex on none; along a leg too."""
ARM: Final = (
    ("clavicle", "shoulder01", "upperarm01", "upperarm02"),
    ("lowerarm01", "lowerarm02"),
    ("wrist", "metacarpal", "finger"),
)
LEG: Final = (
    ("pelvis", "upperleg01", "upperleg02"),
    ("lowerleg01", "lowerleg02"),
    ("foot", "toe"),
)
"""Prefixes of the bones of a limb's upper half, its lower half and its end."""
HIPS: Final = ("root", "spine05")
SEAT: Final = -0.5
"""Coordinate along a leg of vertices at the hips."""
HEAD: Final = ("neck01", "neck02", "neck03", "head")


class Regions(NamedTuple):
    """Regions of all vertices, (v,)."""

    arm: Vector
    """0 shoulder, 1 elbow, 2 wrist, more on the hand; NOWHERE elsewhere."""
    leg: Vector
    """0 hip, 1 knee, 2 ankle, 3 foot, SEAT about the hips; NOWHERE elsewhere."""
    head: Vector
    """Skinning weights of neck and head."""


def regions(figure: Figure) -> Regions:
    """Regions of the vertices of a body."""
    known = anatomy()
    strongest = np.array(known.bones)[known.weights.argmax(axis=1)]
    arm, leg = np.full(len(strongest), NOWHERE), np.full(len(strongest), NOWHERE)
    leg[np.isin(strongest, HIPS)] = SEAT
    for side in "LR":
        ends = [figure.heads_m[f"{name}.{side}"] for name in ("upperarm01", "lowerarm01", "wrist")]
        upper, lower, end = (_of(strongest, names, side) for names in ARM)
        arm[upper] = _along(figure.vertices_m[upper], ends[0], ends[1])
        arm[lower] = 1.0 + _along(figure.vertices_m[lower], ends[1], ends[2])
        hand = 2.0 + _along(figure.vertices_m[end], ends[2], 2 * ends[2] - ends[1])
        arm[end] = np.maximum(2.0, hand)
        ends = [figure.heads_m[f"{name}.{side}"] for name in ("upperleg01", "lowerleg01", "foot")]
        upper, lower, end = (_of(strongest, names, side) for names in LEG)
        leg[upper] = _along(figure.vertices_m[upper], ends[0], ends[1])
        leg[lower] = 1.0 + _along(figure.vertices_m[lower], ends[1], ends[2])
        leg[end] = 3.0
    head = known.weights[:, [known.bones.index(name) for name in HEAD]].sum(axis=1)
    return Regions(arm, leg, head)


def _of(strongest: NDArray[np.str_], names: tuple[str, ...], side: str) -> NDArray[np.bool_]:
    """(v,) vertices whose main bone is of that side and has that prefix."""
    begins = [np.char.startswith(strongest, name) for name in names]
    return np.logical_or.reduce(begins) & np.char.endswith(strongest, f".{side}")


def _along(places: NDArray[np.float64], start: Vector, end: Vector) -> Vector:
    """Coordinate of each place (v, 3) along a line: 0 at its start, 1 at its end."""
    way = end - start
    return np.asarray((places - start) @ way / (way @ way))
