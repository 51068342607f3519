"""Clothes on bodies of the Anny model."""

import numpy as np
import pytest

pytest.importorskip("anny", reason="Anny's people need the extra `train`")

from synth.anny_people.cloth import CLOTH_M, Dressed, anny_dressed
from synth.anny_people.figures import anny_figure
from synth.person.people import Look, person
from synth.person.rings import MATERIAL, MATERIALS

pytestmark = pytest.mark.slow

FIGURE = anny_figure(np.random.default_rng(6))
PLAIN = person(2).look._replace(
    sleeve="long", shorts=False, hair="short", loose_top_m=0.01, loose_legs_m=0.01, hem_m=0.0
)


def worn(look: Look, seed: int = 0) -> Dressed:
    return anny_dressed(FIGURE, look, np.random.default_rng(seed))


def area(dressed: Dressed, material: str) -> float:
    a, b, c = (dressed.vertices_m[dressed.faces[:, k]] for k in range(3))
    sizes = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    return float(sizes[dressed.materials == MATERIAL[material]].sum())


def test_everything_is_worn() -> None:
    dressed = worn(PLAIN)
    assert set(np.unique(dressed.materials)) == set(range(len(MATERIALS)))
    assert 0.3 < area(dressed, "shirt") < 1.2
    assert 0.3 < area(dressed, "trousers") < 1.2


def test_cloth_is_outside_of_the_skin() -> None:
    dressed = worn(PLAIN)
    count = len(FIGURE.vertices_m)
    cloth = np.isin(dressed.materials, [MATERIAL["shirt"], MATERIAL["trousers"]])
    inner = np.setdiff1d(dressed.faces[cloth], dressed.faces[~cloth])
    off = np.linalg.norm(dressed.vertices_m[:count] - FIGURE.vertices_m, axis=1)
    assert off[inner[inner < count]].min() >= CLOTH_M - 1e-9


@pytest.mark.parametrize(
    ("less", "material"),
    [
        (PLAIN._replace(sleeve="none"), "shirt"),
        (PLAIN._replace(shorts=True), "trousers"),
        (PLAIN._replace(hair="bald"), "hair"),
    ],
    ids=["sleeves", "shorts", "hair"],
)
def test_less_cloth_shows_more_skin(less: Look, material: str) -> None:
    full, short = worn(PLAIN), worn(less)
    assert area(short, material) < 0.85 * area(full, material)
    assert area(short, "skin") > area(full, "skin")


def test_a_coat_hangs_below_the_hips_and_a_shirt_does_not() -> None:
    coat, shirt = worn(PLAIN._replace(hem_m=0.4)), worn(PLAIN, 1)
    assert len(coat.vertices_m) > len(shirt.vertices_m) == len(FIGURE.vertices_m)
    lowest = coat.vertices_m[coat.faces[coat.materials == MATERIAL["shirt"]], 1].min()
    hips = FIGURE.heads_m["upperleg01.L"][1]
    assert lowest == pytest.approx(hips - 0.4, abs=0.03), "but for a face"
    assert np.allclose(coat.weights.sum(axis=1), 1.0, atol=1e-5)
