"""Error bars of a rig, held against covariances that were made by hand."""

import math

import numpy as np
import pytest

from calibration.person.rig_certainty import covariance_of, turn_error_deg, unsure_of
from calibration.person.rig_fit import Fit
from calibration.tracks.rig_guess import LATE, PLACE
from common.body.body import Vector

GUESS = np.zeros(LATE + 1)
GUESS[: PLACE["yaw_2"] + 1] = (5.0, 5.2, -0.2, 0.03, 1.4, 1.2)
SURE = {"log_focal_1": 0.01, "log_focal_2": 0.02, "yaw_2": math.radians(0.5)}


def found_with(sigmas: dict[str, float], late_s: float = 1e-4) -> Fit:
    sigma: Vector = np.full(len(GUESS), 1e-4)
    for name, value in sigmas.items():
        sigma[PLACE[name]] = value
    sigma[LATE] = late_s
    return Fit(GUESS, 0.0, (), np.diag(1 / sigma))


@pytest.mark.parametrize("name", ["yaw_2", "pitch_2", "roll_1"])
def test_a_turn_of_one_camera_is_a_turn_between_both(name: str) -> None:
    covariance = covariance_of(found_with({name: math.radians(2.0)}))
    assert turn_error_deg(GUESS, covariance) == pytest.approx(2.0, rel=0.02)


def test_turns_about_two_axes_add_up_by_their_squares() -> None:
    both = found_with({"pitch_2": math.radians(3.0), "roll_2": math.radians(4.0)})
    assert turn_error_deg(GUESS, covariance_of(both)) == pytest.approx(5.0, rel=0.02)


def test_where_a_camera_stands_turns_nothing() -> None:
    far = found_with({"x_2": 3.0, "height_1": 1.0, "log_focal_1": 0.5})
    assert turn_error_deg(GUESS, covariance_of(far)) < 0.1


def test_of_a_rig_that_is_known_nothing_is_unsure() -> None:
    assert unsure_of(found_with(SURE), 1 / 15) == ()


def test_what_is_not_known_is_named_with_its_error_bar() -> None:
    focal = found_with({**SURE, "log_focal_2": 0.2})
    assert unsure_of(focal, 1 / 15) == ("focal lengths to 20 % only",)
    turned = found_with({**SURE, "yaw_2": math.radians(6.0)})
    assert unsure_of(turned, 1 / 15) == ("turn between the cameras to 6.0 degrees only",)
    late = found_with(SURE, late_s=2.0 / 15)
    assert unsure_of(late, 1 / 15) == ("clocks to 2.0 frames only",)
