"""The body's size by exact landmarks of a person of known stature: two views, and one."""

import msgspec
import numpy as np
import pytest
from staging import RIG, standing
from two_people import seen

from common.body.body import OTHER_SIDE, POSE_INDEX
from common.body.kinematics import joints
from common.body.observation import Landmarks, Observation
from common.body.proportions import body_vector, stature, thesis_bdp
from integrator.measuring.known_body import Known, Measured, Sample, Unmeasured
from integrator.measuring.landmark_stature import FEWEST, by_floor_m, by_segments_m, step


def shown(view: int, tall_m: float = 1.75, sure: float = 0.9) -> Observation:
    return seen(view, np.asarray(joints(body_vector(thesis_bdp(tall_m)), standing())), sure)


def landmarks(view: int, tall_m: float = 1.75) -> Landmarks:
    found = shown(view, tall_m).landmarks
    assert found is not None
    return found


def after(body: Known, instants: int, *views: Observation | None) -> Known:
    for _ in range(instants):
        body = step(body, RIG, (views[0], views[1]))
    return body


@pytest.mark.parametrize("tall_m", [1.5, 1.75, 1.95])
def test_segments_show_the_stature_also_where_a_view_exchanges_sides(tall_m: float) -> None:
    one, other = landmarks(0, tall_m), landmarks(1, tall_m)
    swapped = msgspec.structs.replace(
        other, joints_px=tuple(other.joints_px[n] for n in OTHER_SIDE)
    )
    for second in (other, swapped):
        assert by_segments_m(RIG.cameras, one, second) == pytest.approx(tall_m, rel=0.04)


def test_unsure_joints_and_sight_lines_that_miss_each_other_show_no_stature() -> None:
    unsure = msgspec.structs.replace(landmarks(1), confidence=(0.4,) * 15)
    assert by_segments_m(RIG.cameras, landmarks(0), unsure) is None
    higher = tuple((x, y - 12.0) for x, y in landmarks(1).joints_px)
    missed = msgspec.structs.replace(landmarks(1), joints_px=higher)
    assert by_segments_m(RIG.cameras, landmarks(0), missed) is None


@pytest.mark.parametrize("view", [0, 1])
def test_one_view_shows_how_high_the_crown_of_a_standing_person_is(view: int) -> None:
    assert by_floor_m(landmarks(view), RIG.cameras[view]) == pytest.approx(1.75, rel=0.03)


def test_a_level_sight_line_to_the_feet_shows_no_place_on_the_floor() -> None:
    feet_px = tuple((x, 60.0) for x, _ in landmarks(0).joints_px)
    assert (
        by_floor_m(msgspec.structs.replace(landmarks(0), joints_px=feet_px), RIG.cameras[0]) is None
    )


def test_a_body_that_landmarks_contradict_for_long_gets_their_size() -> None:
    """The first silhouette was a thing of .8 m."""
    small = Unmeasured(thesis_bdp(0.8), samples=(Sample(standing(), (shown(0), shown(1))),))
    views = shown(0), shown(1)
    assert after(small, FEWEST - 1, *views).bdp == small.bdp
    grown = after(small, FEWEST, *views)
    assert stature(grown.bdp) == pytest.approx(1.75, rel=0.04)
    assert grown.samples == ()
    assert after(grown, 40, *views).bdp == grown.bdp


def test_a_body_that_agrees_within_a_tenth_stays_as_it_is() -> None:
    for tall_m in (1.62, 1.88):
        known = Unmeasured(thesis_bdp(tall_m))
        assert after(known, 40, shown(0), shown(1)).bdp == known.bdp


def test_a_measured_body_is_revised_and_one_that_the_user_gave_is_not() -> None:
    body = thesis_bdp(1.2)
    given = Measured(body, (0.0, 1.0, 0.0))
    assert after(given, 20, shown(0), shown(1)) is given
    measured = Measured(body, (0.0, 1.0, 0.0), measures=(("any", "any"),))  # type: ignore[arg-type]
    assert stature(after(measured, 20, shown(0), shown(1)).bdp) == pytest.approx(1.75, rel=0.04)


def test_a_single_view_makes_a_body_taller_and_never_smaller() -> None:
    """Who crouches is not small."""
    small, tall = Unmeasured(thesis_bdp(1.1)), Unmeasured(thesis_bdp(2.2))
    assert stature(after(small, FEWEST, shown(0), None).bdp) == pytest.approx(1.75, rel=0.03)
    assert after(tall, 20, shown(0), None).bdp == tall.bdp
    assert after(tall, 20, None, None) == tall


def test_who_hops_before_a_single_camera_now_and_then_does_not_grow() -> None:
    """Their feet are nearer the horizon than those of who stands on the floor."""
    body, hops = Unmeasured(thesis_bdp(1.75)), standing()
    hops[POSE_INDEX["y"]] += 0.15
    high = seen(0, np.asarray(joints(body_vector(thesis_bdp(1.75)), hops)))
    for _ in range(2 * FEWEST):
        body = after(after(body, 20, shown(0), None), 1, high, None)  # type: ignore[assignment]
    assert stature(body.bdp) == pytest.approx(1.75, rel=0.01)


def test_one_view_counts_alone_where_the_other_is_unsure_and_not_where_they_contradict() -> None:
    small = Unmeasured(thesis_bdp(1.1))
    assert stature(after(small, FEWEST, shown(0), shown(1, sure=0.1)).bdp) == pytest.approx(
        1.75, rel=0.03
    )
    far = seen(1, np.asarray(joints(body_vector(thesis_bdp(1.75)), standing((2.0, 3.0)))))
    assert after(small, 20, shown(0), far).bdp == small.bdp
