"""The people of a scene as surfaces: their colours, and where each vertex is in each frame."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from synth.motion.motions import Motion
from synth.person.mesh import Mesh, body_mesh
from synth.person.people import PATTERNS, Look, Person
from synth.person.rings import MATERIAL, MATERIALS
from synth.picture.exposure import blurred
from synth.picture.raster import skin

SHUTTER: Final = 0.4
"""Open time of the shutter, over the frame period."""


class Part(NamedTuple):
    """A person and their motion in a scene."""

    someone: Person
    motion: Motion


class Actor(NamedTuple):
    """A person's surface in all frames."""

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
