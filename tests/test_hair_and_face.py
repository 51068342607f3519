"""Hair behind, a face in front, on bodies of the Anny model."""

import numpy as np
import pytest

pytest.importorskip("anny", reason="Anny's people need the extra `train`")

from synth.anny_people.figures import Figure, anny_figure
from synth.anny_people.hair_and_face import grow_hair, paint_face
from synth.anny_people.limb_regions import regions
from synth.person.people import Hair
from synth.person.rings import MATERIAL

pytestmark = pytest.mark.slow

CUTS: tuple[Hair, ...] = ("bald", "short", "bob", "tail")


def painted(figure: Figure, cut: Hair, seed: int) -> np.ndarray:
    wear = np.full(len(figure.vertices_m), MATERIAL["skin"])
    rng = np.random.default_rng(seed)
    grow_hair(figure, regions(figure).head, cut, wear, np.zeros(len(wear)), rng)
    paint_face(figure, wear)
    return wear


@pytest.mark.parametrize("cut", CUTS)
def test_eyes_and_lips_are_in_front_and_lips_below(cut: Hair) -> None:
    for seed in range(4):
        figure = anny_figure(np.random.default_rng(seed))
        wear, places = painted(figure, cut, seed), figure.vertices_m
        eyes, lips = places[wear == MATERIAL["dark"]], places[wear == MATERIAL["lips"]]
        assert len(eyes) > 4
        assert {float(side) for side in np.sign(eyes[:, 0])} == {-1.0, 1.0}
        middle = figure.heads_m["head"][2]
        assert min(eyes[:, 2].min(), lips[:, 2].min(initial=np.inf)) > middle
        assert len(lips) == 0 or lips[:, 1].max() < eyes[:, 1].min()


def test_hair_covers_the_back_of_the_head_but_of_the_bald() -> None:
    figure = anny_figure(np.random.default_rng(2))
    eye = figure.heads_m["eye.L"]
    behind = (figure.vertices_m[:, 1] > eye[1]) & (figure.vertices_m[:, 2] < eye[2] - 0.12)
    shares = {cut: (painted(figure, cut, 0) == MATERIAL["hair"])[behind].mean() for cut in CUTS}
    assert shares.pop("bald") == 0.0
    assert min(shares.values()) > 0.95
