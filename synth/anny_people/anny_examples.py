"""Pictures of Anny people with known joints, in addition to those of our own people."""

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from synth.anny_people.cloth import Dressed, anny_dressed
from synth.anny_people.figures import anny_figure
from synth.anny_people.retarget import hung, retargeted
from synth.person.people import Look, person
from synth.person.rings import MATERIAL
from synth.person.wardrobe import dressed
from synth.picture.actors import palette
from synth.picture.example_poses import poses_deg
from synth.picture.picture_examples import (
    PICTURES,
    PictureExample,
    Shown,
    pictured,
    shirt_pattern,
)
from synth.picture.silhouette_examples import PEOPLE

EYES: Final = (0.25, 0.7)
"""Range of the eyes' brightness, over the skin's."""
LIPS: Final = (0.7, 0.7, 0.95)
"""Blue, green, red of the lips, over the skin's."""


def anny_examples(seed: int) -> Iterator[PictureExample]:
    """The pictures of one person, in the clothes and the poses of our own people.

    Args:
        seed: Seed of the person.

    Raises:
        NoAnny: Where the package `anny` is not installed.
    """
    rng = np.random.default_rng([seed, 83])
    someone = dressed(person(int(rng.integers(*PEOPLE))), rng)
    figure = anny_figure(rng)
    clothed = anny_dressed(figure, someone.look, rng)
    colours = _colours(someone.look, rng)
    body = retargeted(figure, someone.measures, poses_deg(someone, PICTURES, rng), rng)
    places = hung(clothed.vertices_m, clothed.weights, figure, body)
    stature_m = float(figure.vertices_m[:, 1].max())
    for i in range(len(places)):
        true = (body.joints_m[i], body.front[i], stature_m)
        shown = Shown(places[i], *_surface(clothed), colours, shirt_pattern(someone.look), *true)
        example = pictured(shown, rng)
        if example is not None:
            yield example


def _surface(
    clothed: Dressed,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    return clothed.vertices_m, clothed.faces, clothed.materials


def _colours(look: Look, rng: np.random.Generator) -> NDArray[np.float64]:
    """Colours of a face with eyes and lips, in place of a mere shadow."""
    found = palette(look)
    found[MATERIAL["dark"]] = np.array(look.skin) * rng.uniform(*EYES)
    found[MATERIAL["lips"]] = np.array(look.skin) * LIPS
    return found
