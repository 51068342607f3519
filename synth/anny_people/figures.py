"""Naked Anny bodies: youths and adults of all builds."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import Vector
from synth.anny_people.anatomy import anatomy, upright
from synth.person.skeleton import HEAD_FORWARD

YOUTH, ADULT, AGED = (0.48, 0.6), (0.6, 0.8), (0.8, 1.0)
"""Ranges of Anny's age parameter: two thirds is a young adult, one is old."""
YOUTH_SHARE, AGED_SHARE = 0.15, 0.2
BETWEEN_SHARE: Final = 0.1
"""Share of bodies between man and woman."""
ABOUT: Final = {
    "muscle": (0.5, 0.22),
    "weight": (0.52, 0.24),
    "height": (0.36, 0.1),
    "proportions": (0.5, 0.25),
    "cupsize": (0.5, 0.2),
    "firmness": (0.5, 0.2),
}
"""Mean and standard deviation of Anny's other parameters, each in [0, 1]."""
ORIGINS: Final = ("african", "asian", "caucasian")
KNEE_DROP: Final = 0.06
"""Offset of Anny's knee bend above the middle of the joint, as a share of the shank; the joint
is at 0.285 of the stature. Source: Drillis and Contini 1966."""


class Figure(NamedTuple):
    """A body at rest: arms half raised, elbows slightly bent, soles at height 0."""

    vertices_m: NDArray[np.float64]
    """(v, 3): x to its left, y up, z ahead."""
    heads_m: dict[str, Vector]
    """Start of each bone."""

    def crown_m(self) -> Vector:
        """The top of the head, as far ahead of the neck as in our own people, (3,)."""
        neck, top = self.heads_m["neck01"], float(self.vertices_m[:, 1].max())
        return np.array([0.0, top, neck[2] + HEAD_FORWARD * (top - neck[1])])


def anny_figure(rng: np.random.Generator) -> Figure:
    """A body with impossible lengths.

    Args:
        rng: Source of all choices.

    Raises:
        NoAnny: Where the package `anny` is not installed.
    """
    known = anatomy()
    parameters = known.model.get_phenotype_blendshape_coefficients(**_phenotype(rng))
    rest = known.model.get_rest_model(parameters)
    vertices = upright(rest["rest_vertices"][0].numpy())[known.kept]
    heads = upright(rest["rest_bone_heads"][0].numpy())
    sole = np.array([0.0, vertices[:, 1].min(), 0.0])
    at = dict(zip(known.bones, heads - sole, strict=True))
    for side in "LR":
        shank = at[f"foot.{side}"] - at[f"lowerleg01.{side}"]
        at[f"lowerleg01.{side}"] = at[f"lowerleg01.{side}"] + KNEE_DROP * shank
    return Figure(vertices - sole, at)


def _phenotype(rng: np.random.Generator) -> dict[str, float]:
    """Anny's parameters, each in [0, 1]."""
    chance = rng.random()
    young, old = chance < YOUTH_SHARE, chance < YOUTH_SHARE + AGED_SHARE
    age = rng.uniform(*(YOUTH if young else AGED if old else ADULT))
    gender = rng.random() if rng.random() < BETWEEN_SHARE else 0.12 * rng.random()
    origin = dict(zip(ORIGINS, rng.dirichlet([0.5, 0.5, 0.5]).tolist(), strict=True))
    found = {"gender": float(gender if rng.random() < 0.5 else 1.0 - gender), "age": float(age)}
    for name, (middle, spread) in ABOUT.items():
        found[name] = float(np.clip(rng.normal(middle, spread), 0.02, 0.98))
    return found | origin
