"""People and things of a scene as surfaces: colours, and where each vertex is in each frame."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from synth.motion.motions import Motion
from synth.person.mesh import Mesh, body_mesh
from synth.person.people import PATTERNS, Colour, Look, Person
from synth.person.rings import MATERIAL, MATERIALS
from synth.picture.exposure import blurred
from synth.picture.raster import skin

SHUTTER: Final = 0.4
"""Open time of the shutter, over the frame period."""
BOX: Final = np.array(
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5)),
        *((0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)),
        *((0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ]
)
"""Faces of a box, seen from outside anticlockwise; bits of a corner are its sides of x, y, z."""
NO_PATTERN: Final = (0.0, 1.0, -1.0)


class Part(NamedTuple):
    """A person and their motion in a scene."""

    someone: Person
    motion: Motion


class Thing(NamedTuple):
    """A box that people carry."""

    sides_m: tuple[float, float, float]
    colour: Colour
    places_m: NDArray[np.float64]
    """(n, 3) of its middle; NaN while it is not in the room."""


class Actor(NamedTuple):
    """The surface of a person or a thing in all frames."""

    mesh: Mesh
    palette: NDArray[np.float64]
    """Colours of MATERIALS, then the shirt's second colour."""
    pattern: tuple[float, float, float]
    """Of the shirt, as `draw` takes it."""
    places: NDArray[np.float64]
    """(n, v, 3) of the vertices, world metres."""
    present: NDArray[np.bool_]
    smeared: NDArray[np.bool_]
    """(n,) whether a frame has motion blur."""


def actor_of(part: Part) -> Actor:
    """The surface of a person in all frames of their motion."""
    look, mesh = part.someone.look, body_mesh(part.someone)
    pattern = (float(PATTERNS.index(look.pattern)), look.pitch_m, float(MATERIAL["shirt"]))
    places, motion = _placed(mesh, part.motion), part.motion
    return Actor(mesh, palette(look), pattern, places, motion.present, blurred(motion))


def thing_of(thing: Thing) -> Actor:
    """The surface of a box in all frames; it stays upright."""
    corners = np.array([*np.ndindex(2, 2, 2)]) - 0.5
    rest = corners * thing.sides_m
    bones, shares = np.zeros((len(rest), 2), np.int64), np.zeros(len(rest))
    mesh = Mesh(rest, np.zeros((1, 3)), bones, shares, BOX, BOX[:, 0] * 0)
    places = thing.places_m[:, None] + rest
    present, still = np.isfinite(places).all((1, 2)), np.zeros(len(places), np.bool_)
    colours = np.array([thing.colour] * 2, np.float64)
    return Actor(mesh, colours, NO_PATTERN, places, np.asarray(present), still)


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


def surfaces(actor: Actor, i: int, smeared: bool) -> list[NDArray[np.float64]]:
    """The surface at the frame's time, then before and after it while the shutter is open."""
    places = actor.places
    if not smeared:
        return [places[i]]
    before, after = places[max(i - 1, 0)], places[min(i + 1, len(places) - 1)]
    frame = (after - before) / 2
    return [places[i] + SHUTTER * share * frame for share in (0.0, -0.4, -0.2, 0.2, 0.4)]
