"""Where on a body of the Anny model its vertices lie."""

import numpy as np
import pytest

pytest.importorskip("anny", reason="Anny's people need the extra `train`")

from synth.anny_people.figures import anny_figure
from synth.anny_people.limb_regions import NOWHERE, regions

pytestmark = pytest.mark.slow


def test_places_along_limbs_grow_from_the_trunk_to_their_ends() -> None:
    figure = anny_figure(np.random.default_rng(4))
    near, x, y = regions(figure), figure.vertices_m[:, 0], figure.vertices_m[:, 1]
    arm, leg = near.arm > 0.0, near.leg > 0.0
    assert np.corrcoef(near.arm[arm], np.abs(x[arm]))[0, 1] > 0.95
    assert np.corrcoef(near.leg[leg], -y[leg])[0, 1] > 0.9
    assert not (arm & leg).any()
    assert (near.arm[near.head > 0.9] == NOWHERE).all()
    assert y[near.head > 0.9].min() > 0.8 * y.max()


def test_both_sides_are_alike() -> None:
    figure = anny_figure(np.random.default_rng(4))
    near, x = regions(figure), figure.vertices_m[:, 0]
    for along in (near.arm, near.leg):
        left, right = along[(along > 0.0) & (x > 0.0)], along[(along > 0.0) & (x < 0.0)]
        assert np.quantile(left, [0.2, 0.5, 0.8]) == pytest.approx(
            np.quantile(right, [0.2, 0.5, 0.8]), abs=0.05
        )
