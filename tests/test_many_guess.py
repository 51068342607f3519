"""A rig of many cameras as a vector: what any two of it are, and how pairs are put together."""

import numpy as np
import pytest
from many_views import around

from calibration.person.many_guess import EACH, Layout, chained, pair_guess, pinholes_of
from calibration.tracks import person_prior as prior
from calibration.tracks.rig_guess import BODY, LATE, RIG, guess_of, pinholes, rig_of
from common.body.body import Vector
from common.rig.camera import Rig, centre

LAYOUT = Layout(4, 2)
LENGTHS = np.log(prior.SHARES * 1.7)
LATE_S = np.array([[0.1, -0.2, 0.3], [0.0, 0.4, 0.5]])


def random_vector(seed: int) -> Vector:
    rng = np.random.default_rng(seed)
    rows = rng.uniform(-1.0, 1.0, (4, EACH)) * (0.2, 3.0, 0.3, 0.2, 3.0, 0.5, 3.0)
    rows[:, 0] += 5.0
    rows[:, 5] += 1.5
    rows[0, [1, 4, 6]] = 0.0
    return np.concatenate([rows.ravel(), LENGTHS, LATE_S.ravel()])


@pytest.mark.parametrize("pair", [(0, 2), (1, 3), (3, 1)])
def test_two_cameras_of_many_stand_to_each_other_as_the_pair_says(pair: tuple[int, int]) -> None:
    """Relative rotation and place are those of the whole rig, whatever world either has."""
    guess = random_vector(3)
    every = pinholes_of(LAYOUT, guess)
    whole = [every[n] for n in pair]
    own = pair_guess(LAYOUT, guess, pair)
    alone = pinholes(own)
    for cameras in (whole, alone):
        assert [camera.focal_px for camera in cameras] == pytest.approx(
            [camera.focal_px for camera in whole]
        )
    turns = [other.R @ one.R.T for one, other in (whole, alone)]
    assert turns[0] == pytest.approx(turns[1])
    places = [one.R @ (other.centre_m - one.centre_m) for one, other in (whole, alone)]
    assert places[0] == pytest.approx(places[1])
    heights = [[camera.centre_m[1] for camera in cameras] for cameras in (whole, alone)]
    assert heights[0] == pytest.approx(heights[1])
    assert own[BODY] == pytest.approx(LENGTHS)
    late = np.pad(LATE_S, ((0, 0), (1, 0)))
    assert own[LATE:] == pytest.approx(late[:, pair[1]] - late[:, pair[0]])


@pytest.mark.parametrize(
    "tree",
    [[(0, 1), (0, 2), (0, 3)], [(0, 2), (2, 3), (3, 1)], [(0, 3), (3, 2), (2, 1)]],
    ids=["a star", "a chain", "another"],
)
def test_pairs_of_one_rig_are_put_together_to_that_rig(tree: list[tuple[int, int]]) -> None:
    """Each pair is published in a world of its own, with another origin and another heading."""
    guess = random_vector(7)
    late = np.pad(LATE_S, ((0, 0), (1, 0)))
    rigs = {}
    for one in range(4):
        for other in range(one + 1, 4):
            own = pinholes(pair_guess(LAYOUT, guess, (one, other)))
            rig = rig_of(own, (320, 240), np.array([one - 0.5, 0.0, other]))
            rigs[one, other] = rig, tuple((late[:, other] - late[:, one]).tolist())
    assert chained(LAYOUT, tree, rigs, LENGTHS) == pytest.approx(guess)


def test_a_rig_of_two_is_a_pairs_vector() -> None:
    rig = around(2)
    own = guess_of(rig)
    layout = Layout(2, 1)
    rows = [[own[0], 0.0, *own[2:4], 0.0, own[4], 0.0], [own[1], *own[5:11]]]
    guess = np.concatenate([np.ravel(rows), LENGTHS, [0.2]])
    assert pair_guess(layout, guess, (0, 1)) == pytest.approx([*own[:RIG], *LENGTHS, 0.2])
    cameras = pinholes_of(layout, guess)
    built = rig_of(cameras, (160, 120), -centre(Rig(160, 120, rig.cameras).cameras[0]) * [1, 0, 1])
    for one, other in zip(built.cameras, rig.cameras, strict=True):
        assert np.array(one.R) == pytest.approx(np.array(other.R), abs=1e-9)
        assert one.t == pytest.approx(other.t, abs=1e-9)
