"""Feet, hands and nose as views see them: two lines of sight meet; else the rule holds."""

import msgspec
import numpy as np
import pytest
from staging import RIG, observation
from test_best_pair import rig as rig_around

from common.body.body import rest_pose
from common.body.extremities import EXTREMITY_NAMES, extremities
from common.body.kinematics import joints
from common.body.observation import Landmarks, Observation
from common.body.proportions import body_vector, thesis_bdp
from common.bus.messages import ViewerNumber
from common.rig.camera import project
from integrator.landmarks.extremity_sight import DEPTH_BY_RULE, seen_extremities

STATURE_M = 1.7
RULE_M = extremities(joints(body_vector(thesis_bdp(STATURE_M)), rest_pose()), STATURE_M)
TRUE_M = RULE_M + np.array([0.02, 0.03, -0.04])
NOBODY = Landmarks(((0.0, 0.0),) * 15, (0.0,) * 15)
TOE = EXTREMITY_NAMES.index("l_toe")


def report(viewer: ViewerNumber, places_m: np.ndarray, sure: tuple[float, ...]) -> Observation:
    """A view that sees these places."""
    pixels = tuple(map(tuple, project(RIG.cameras[viewer - 1], places_m).tolist()))
    shown = msgspec.structs.replace(NOBODY, extremities_px=pixels, extremities_confidence=sure)
    return observation(landmarks=shown)


def found(*views: Observation | None) -> tuple[np.ndarray, np.ndarray]:
    first, second = views
    return seen_extremities(RULE_M, RIG, (first, second), STATURE_M)


def test_what_both_views_see_is_where_their_lines_meet() -> None:
    places_m, sure = found(report(1, TRUE_M, (0.9,) * 7), report(2, TRUE_M, (0.6,) * 7))
    assert places_m == pytest.approx(TRUE_M, abs=1e-6)
    assert sure.tolist() == [0.6] * 7


@pytest.mark.parametrize("wrong", [0, 1, 2])
def test_of_three_views_the_two_that_are_surest_place_each_point(wrong: int) -> None:
    around = rig_around(0.0, 50.0, 100.0)
    seen = []
    for view, camera in enumerate(around.cameras):
        places_m = TRUE_M + np.array([0.0, 0.15, 0.0]) if view == wrong else TRUE_M
        pixels = tuple(map(tuple, project(camera, places_m).tolist()))
        sure = (0.4 if view == wrong else 0.7 + 0.1 * view,) * 7
        seen.append(
            observation(
                landmarks=msgspec.structs.replace(
                    NOBODY, extremities_px=pixels, extremities_confidence=sure
                )
            )
        )
    places_m, sure_of = seen_extremities(RULE_M, around, tuple(seen), STATURE_M)
    assert places_m == pytest.approx(TRUE_M, abs=1e-6)
    assert sure_of == pytest.approx([0.7 + 0.1 * min({0, 1, 2} - {wrong})] * 7)


def test_what_nobody_sees_is_the_rules_and_said_to_be_unmeasured() -> None:
    for views in ((None, None), (report(1, TRUE_M, (0.1,) * 7), None)):
        places_m, sure = found(*views)
        assert (places_m == RULE_M).all()
        assert not sure.any()


def test_one_view_moves_a_place_across_its_picture_and_is_believed_by_half() -> None:
    sees = tuple(0.8 if i == TOE else 0.0 for i in range(7))
    places_m, sure = found(report(1, TRUE_M, sees), None)
    assert sure[TOE] == pytest.approx(0.8 * DEPTH_BY_RULE)
    camera = RIG.cameras[0]
    assert project(camera, places_m)[TOE] == pytest.approx(project(camera, TRUE_M)[TOE], abs=1e-6)
    others = np.delete(np.arange(7), TOE)
    assert (places_m[others] == RULE_M[others]).all()
    assert not sure[others].any()


def test_a_view_that_takes_left_for_right_is_read_the_other_way() -> None:
    swapped = TRUE_M[[0, 4, 5, 6, 1, 2, 3]]
    places_m, sure = found(report(1, swapped, (0.9,) * 7), report(2, TRUE_M, (0.9,) * 7))
    assert places_m == pytest.approx(TRUE_M, abs=1e-6)
    assert sure.tolist() == [0.9] * 7


def test_points_of_somebody_else_are_not_taken() -> None:
    elsewhere = TRUE_M + np.array([0.8, 0.0, 0.5])
    places_m, sure = found(report(1, elsewhere, (0.9,) * 7), report(2, elsewhere, (0.9,) * 7))
    assert (places_m == RULE_M).all()
    assert not sure.any()
