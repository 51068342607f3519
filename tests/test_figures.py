"""Bodies of the Anny model, held against measured people."""

import numpy as np
import pytest

pytest.importorskip("anny", reason="Anny's people need the extra `train`")

from synth.anny_people.anatomy import anatomy
from synth.anny_people.figures import Figure, anny_figure

pytestmark = pytest.mark.slow

HEIGHTS = {"lowerleg01.L": 0.285, "upperleg01.L": 0.53, "foot.L": 0.039}
"""Of knee, hip and ankle over the stature. Source: Drillis and Contini 1966."""
LENGTHS = {("upperarm01.L", "lowerarm01.L"): 0.156, ("lowerarm01.L", "wrist.L"): 0.146}
"""Of upper arm and forearm; theirs begins at the shoulder's top, 0.03 above the joint."""


@pytest.fixture(scope="module")
def crowd() -> list[Figure]:
    return [anny_figure(np.random.default_rng(seed)) for seed in range(40)]


def test_statures_are_those_of_youths_and_adults(crowd: list[Figure]) -> None:
    statures = [float(np.ptp(figure.vertices_m[:, 1])) for figure in crowd]
    assert 1.55 < np.mean(statures) < 1.75
    assert min(statures) > 1.15
    assert max(statures) < 2.15


def test_joints_lie_where_anatomy_has_them(crowd: list[Figure]) -> None:
    tall = np.array([figure.vertices_m[:, 1].max() for figure in crowd])
    for name, share in HEIGHTS.items():
        heights = np.array([figure.heads_m[name][1] for figure in crowd])
        assert np.mean(heights / tall) == pytest.approx(share, abs=0.015), name
    for (start, end), share in LENGTHS.items():
        ways = np.array([figure.heads_m[end] - figure.heads_m[start] for figure in crowd])
        lengths = np.linalg.norm(ways, axis=1)
        assert np.mean(lengths / tall) == pytest.approx(share, abs=0.015), start


def test_a_figure_stands_on_the_floor_and_faces_ahead(crowd: list[Figure]) -> None:
    for figure in crowd:
        assert figure.vertices_m[:, 1].min() == 0.0
        assert figure.heads_m["wrist.L"][0] > 0.0 > figure.heads_m["wrist.R"][0]
        assert figure.heads_m["toe3-1.L"][2] > figure.heads_m["foot.L"][2]
        a, b, c = (figure.vertices_m[anatomy().faces[:, k]] for k in range(3))
        assert np.einsum("fi,fi->", a, np.cross(b, c)) / 6 > 0.02, (
            "a body of 20 litres, not inside out"
        )


def test_a_seed_is_a_body() -> None:
    one, again = (anny_figure(np.random.default_rng(3)) for _ in range(2))
    assert np.array_equal(one.vertices_m, again.vertices_m)
