"""The joint adjustment, held against that of two cameras."""

import numpy as np
import pytest
from many_views import around, shown

from calibration.person.many_fit import many_fitted, many_misfits
from calibration.person.many_guess import EACH, Layout, pair_guess
from calibration.person.rig_evidence import Evidence, gathered
from calibration.person.rig_fit import sides_of
from calibration.person.rig_residuals import misfits
from calibration.person.rig_starts import known_of
from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import Sightings
from calibration.tracks.rig_guess import guess_of
from common.body.body import Vector
from common.rig.camera import Rig


def vector_of(rig: Rig, stature_m: float) -> Vector:
    """The true vector of a rig whose camera 1 is above z."""
    layout = Layout(len(rig.cameras), 1)
    rows = np.zeros((layout.cameras, EACH))
    for n in range(1, layout.cameras):
        own = guess_of(Rig(rig.width, rig.height, (rig.cameras[0], rig.cameras[n])))
        rows[0, [0, 2, 3, 5]] = own[[0, 2, 3, 4]]
        rows[n] = own[[1, 5, 6, 7, 8, 9, 10]]
    late = np.zeros(layout.cameras - 1)
    return np.concatenate([rows.ravel(), np.log(prior.SHARES * stature_m), late])


def data_of(seen: Sightings) -> dict[tuple[int, int], Evidence]:
    known = known_of(160, 1.75, 1)
    count = len(seen.tracks)
    every = [(one, other) for one in range(count) for other in range(one + 1, count)]
    return {pair: gathered((seen.pair(*pair),), known).thinned(20) for pair in every}


def test_of_two_cameras_the_residuals_are_those_of_the_pair() -> None:
    rig = around(2)
    data = data_of(shown(rig, 11, "walk_toward"))
    layout, guess = Layout(2, 1), vector_of(rig, 1.7)
    own = pair_guess(layout, guess, (0, 1))
    sides = sides_of(own, data[0, 1])
    found = many_misfits(guess, layout, data, {(0, 1): sides})
    due = misfits(own, data[0, 1], sides)
    assert (found**2).sum() == pytest.approx((due**2).sum())
    assert len(found) == len(due)


def test_a_camera_that_starts_turned_is_turned_back_and_camera_1_keeps_its_place() -> None:
    """By ten degrees; the other cameras hold the person where they are."""
    rig = around(3)
    data = data_of(shown(rig, 11, "walk_toward"))
    layout, true = Layout(3, 1), vector_of(rig, 1.7)
    start = true.copy()
    start[2 * EACH + 1] += np.radians(10.0)
    fit = many_fitted(start, layout, data, 2, 8)
    off_deg = np.degrees(abs(fit.guess[2 * EACH + 1] - true[2 * EACH + 1]))
    assert off_deg < 4.0
    assert fit.guess[[1, 4, 6]].tolist() == [0.0, 0.0, 0.0]
    assert fit.jacobian.shape[1] == layout.size
    assert not fit.jacobian[:, [1, 4, 6]].any()
