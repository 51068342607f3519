"""How far a rig is believed, by exact landmarks of somebody who stands and turns before another."""

import math
from typing import Any

import msgspec
import numpy as np
import pytest
from staging import RIG, person_of, report, standing
from staging import changed as otherwise

from calibration.gate import rig_agreement
from calibration.gate.rig_agreement import (
    FARTHEST_M,
    FEWEST,
    LEAST,
    SAMPLES,
    State,
    motion_m,
)
from calibration.gate.rig_fault import exchanged_rig
from common.body.body import JOINT_NAMES, OTHER_SIDE, POSE_INDEX
from common.body.kinematics import joints
from common.body.observation import Box, Landmarks
from common.body.proportions import body_vector, thesis_bdp
from common.bus.instant import TwoViews
from common.bus.messages import Agreement, View, ViewerNumber
from common.rig.camera import Rig, as_matrix, as_row, centre, project

BODY = body_vector(thesis_bdp(1.75))


def turned(rig: Rig, yaw_deg: float, raised_m: float = 0.0) -> Rig:
    """With camera 2 turned and raised."""
    first, second = rig.cameras
    a = math.radians(yaw_deg)
    about = [[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]]
    R = np.array(second.R) @ np.array(about)
    t = -R @ (centre(second) + np.array([0.0, raised_m, 0.0]))
    second = msgspec.structs.replace(second, R=as_matrix(R), t=as_row(t))
    return msgspec.structs.replace(rig, cameras=(first, second))


def seen(
    viewer: ViewerNumber,
    n: int,
    *,
    swaps: bool = False,
    sure: float = 0.9,
    joints_m: np.ndarray | None = None,
) -> View:
    """Somebody who stands and goes about, or whose joints (15, 3) are given."""
    if joints_m is None:
        joints_m = np.asarray(joints(BODY, standing((0.3 * math.sin(n), 0.2 * math.cos(n)))))
    places = project(RIG.cameras[viewer - 1], joints_m)
    places = places[OTHER_SIDE] if swaps else places
    facing = (0.0, 90.0)[viewer - 1]
    told = Landmarks(tuple((x, y) for x, y in places.tolist()), (sure,) * 15, facing, 0.95)
    return report(viewer, frame=n, captured_s=0.2 * n, landmarks=told, box=Box(0, 1, 0, 1))


def agreed(state: State, rig: Rig, views: TwoViews) -> State:
    first, second = (None if view is None else view.person for view in views)
    assert views[0] is not None
    return rig_agreement.step(state, rig, (first, second), views[0].captured_s)


def after(rig: Rig, instants: int = 20, *, swaps: bool = False) -> State:
    state = State()
    for n in range(instants):
        state = agreed(state, rig, (seen(1, n), seen(2, n, swaps=swaps)))
    return state


def test_a_right_rig_is_believed_also_where_a_view_exchanges_sides() -> None:
    for swaps in (False, True):
        told = after(RIG, swaps=swaps).told
        assert told is not None
        assert told.apart_mm < 5.0
        assert abs(told.soles_mm) < 30.0
        assert told.believed == 1.0


@pytest.mark.parametrize(
    "rig",
    [turned(RIG, 10.0), turned(RIG, -10.0), turned(RIG, 0.0, 0.3), exchanged_rig(RIG)],
    ids=["turned", "turned back", "raised", "exchanged"],
)
def test_a_wrong_rig_is_not_believed(rig: Rig) -> None:
    told = after(rig).told
    assert told is not None
    assert told.believed < 0.2


@pytest.mark.parametrize("copied", [1, 2])
def test_a_copy_of_one_view_is_not_believed(copied: ViewerNumber) -> None:
    """Their sight lines meet where the person is in the middle: the facing tells them apart."""
    state = State()
    for n in range(20):
        still = np.asarray(joints(BODY, standing()))
        copies = (seen(copied, n, joints_m=still), seen(copied, n, joints_m=still))
        state = agreed(state, RIG, copies)
    assert state.told is not None
    assert state.told.apart_mm < 60.0
    assert state.told.facing_deg == pytest.approx(90.0, abs=1.0)
    assert state.told.believed == LEAST


def swinging(n: int, late: float = 0.0) -> np.ndarray:
    """Somebody who lifts both arms to the side and lets them down, once in two seconds."""
    up_deg = 60.0 * (1.0 - math.cos(0.2 * math.pi * (n - late)))
    return np.asarray(
        joints(BODY, standing(r_shoulder_z=180.0 - up_deg, l_shoulder_z=180.0 + up_deg))
    )


def after_swinging(late: float) -> Agreement:
    """Of two takes, of which view 2 shows one that begins `late` instants later."""
    state = State()
    for n in range(40):
        pair = (seen(1, n, joints_m=swinging(n)), seen(2, n, joints_m=swinging(n, late)))
        state = agreed(state, RIG, pair)
    assert state.told is not None
    return state.told


def test_views_of_two_takes_are_not_believed_where_their_motions_differ() -> None:
    one, two = after_swinging(0.0), after_swinging(5.0)
    assert one.motion_mm < 5.0
    assert one.believed == 1.0
    assert two.apart_mm < 60.0  # the trunk stands: places agree
    assert two.motion_mm > 60.0
    assert two.believed == LEAST


def test_motion_is_the_root_mean_square_of_gaps_about_their_median() -> None:
    """Worked by hand: 0.05 of one joint, none of another that is 0.3 off all the time; a third is
    seen too seldom; what is farther off than FARTHEST_M counts so much."""
    gaps_m = np.full((9, 3), 0.3)
    gaps_m[:, 0] = [-0.05, 0.05, 0.0, 0.05, -0.05, 0.05, -0.05, 0.05, -0.05]
    gaps_m[1:, 2] = np.nan
    assert motion_m(gaps_m, 8) == pytest.approx(0.05 * math.sqrt(8 / 9 / 2))
    gaps_m[0, 1] = -5.0
    assert motion_m(gaps_m[:, 1:2], 8) == pytest.approx(FARTHEST_M / 3)
    assert motion_m(gaps_m[:3], 8) == 0.0


def test_nothing_is_told_of_a_moment_of_one_view_or_of_unsure_landmarks() -> None:
    assert after(RIG, FEWEST - 1).told is None
    assert after(RIG, FEWEST).told is not None
    state = State()
    for n in range(20):
        state = agreed(state, RIG, (seen(1, n), None))
        state = agreed(state, RIG, (seen(1, n), seen(2, n, sure=0.3)))
    assert state == State()


def test_what_is_kept_is_bounded_and_old_instants_are_forgotten() -> None:
    state = after(turned(RIG, 10.0), 50)
    assert len(state.samples) == len(state.facings_deg) == SAMPLES
    for n in range(50, 50 + SAMPLES):
        state = agreed(state, RIG, (seen(1, n), seen(2, n)))
    assert state.told is not None
    assert state.told.believed == 1.0


def test_a_rig_that_becomes_wrong_is_contradicted_within_two_seconds() -> None:
    state = after(RIG, 40)
    assert state.told is not None
    assert state.told.believed == 1.0
    for n in range(40, 50):
        state = agreed(state, turned(RIG, 10.0), (seen(1, n), seen(2, n)))
    assert state.told is not None
    assert state.told.believed < 0.2
    assert len(state.samples) < 40


def test_who_lies_does_not_make_a_right_rig_doubted() -> None:
    """Their feet are off the floor, and they may lie for long."""
    state, lying = after(RIG), np.asarray(joints(BODY, standing((0.1, -0.1))))
    lying = lying[:, [1, 0, 2]] * [1.0, -1.0, 1.0] + [-0.9, 0.6, 0.0]
    before = state.told
    for n in range(20, 20 + 2 * SAMPLES):
        pair = (seen(1, n, joints_m=lying), seen(2, n, joints_m=lying))
        state = agreed(state, RIG, pair)
    assert state.told == before
    assert before is not None
    assert before.believed == 1.0


def test_who_stands_on_one_leg_for_long_does_not_make_a_right_rig_doubted() -> None:
    """The middle of the ankles is 14 cm higher then, the lower one is where it was; and views take
    left for right now and then."""
    state = State()
    legs = standing((0.1, -0.1))
    legs[POSE_INDEX["l_hip_x"]], legs[POSE_INDEX["l_knee_x"]] = 60.0, -90.0
    joints_m = np.asarray(joints(BODY, legs))
    ankles_m = joints_m[[n for n, name in enumerate(JOINT_NAMES) if name.endswith("ankle")], 1]
    assert np.ptp(ankles_m) > 0.25
    for n in range(2 * SAMPLES):
        pair = (seen(1, n, joints_m=joints_m), seen(2, n, joints_m=joints_m, swaps=n % 3 == 0))
        state = agreed(state, RIG, pair)
    assert state.told is not None
    assert abs(state.told.soles_mm) < 30.0
    assert state.told.believed == 1.0


def samples(gap_mm: float, ankle_m: float, n: int = 20) -> np.ndarray:
    """Instants in which every point's sight lines miss by so much, and the ankle is so high."""
    points = len(rig_agreement.POINTS)
    return np.tile([gap_mm / 1e3] * points + [ankle_m], (n, 1))


ANKLE_M = 0.05 * 1.75


@pytest.mark.parametrize(
    ("gap_mm", "raised_mm", "facing_deg", "believed"),
    [
        (60.0, 0.0, 0.0, 1.0),
        (70.0, 0.0, 0.0, 0.525),
        (80.0, 0.0, 0.0, 0.05),
        (0.0, 60.0, 0.0, 1.0),
        (0.0, 77.5, 0.0, 0.525),
        (0.0, 95.0, 0.0, 0.05),
        (0.0, -45.0, 0.0, 1.0),
        (0.0, -60.0, 0.0, 0.525),
        (0.0, -75.0, 0.0, 0.05),
        (0.0, 0.0, -45.0, 1.0),
        (0.0, 0.0, 60.0, 0.525),
        (0.0, 0.0, 75.0, 0.05),
        (70.0, 95.0, 0.0, 0.05),
    ],
)
def test_belief_falls_between_what_is_usual_and_what_no_good_rig_has(
    gap_mm: float, raised_mm: float, facing_deg: float, believed: float
) -> None:
    given = samples(gap_mm, ANKLE_M + raised_mm / 1e3)
    told = rig_agreement.agreement_of(given, (facing_deg,) * 5)
    assert told.apart_mm == pytest.approx(gap_mm)
    assert told.soles_mm == pytest.approx(raised_mm, abs=1e-6)
    assert told.facing_deg == abs(facing_deg)
    assert told.believed == pytest.approx(believed)


def test_errors_that_change_and_feet_in_the_air_and_few_facings_say_nothing() -> None:
    given = samples(0.0, ANKLE_M)
    given[::3, :-1] = 0.5
    given[9:, -1] += 0.3
    told = rig_agreement.agreement_of(given, (180.0,) * 4)
    assert (told.apart_mm, told.facing_deg, told.believed) == (0.0, 0.0, 1.0)
    assert told.soles_mm == pytest.approx(0.0, abs=1e-6)
    given[7:, -1] += 0.3
    assert rig_agreement.agreement_of(given, ()).believed < 0.06


def test_joints_that_one_side_alone_shows_keep_their_gaps() -> None:
    """Exchanged, a sure left meets an unsure right: fewer gaps are no better ones."""
    sure = tuple(0.3 if name.startswith("r_") else 0.9 for name in JOINT_NAMES)
    one, other = (msgspec.structs.replace(shown(n), confidence=sure) for n in (1, 2))
    gaps_m = rig_agreement.joint_gaps_m(RIG.cameras, one, other, rig_agreement.SURE_JOINT)
    left = [name.startswith("l_") for name in JOINT_NAMES]
    assert np.isfinite(gaps_m[left]).all()
    assert np.isnan(gaps_m[[name.startswith("r_") for name in JOINT_NAMES]]).all()


def shown(viewer: ViewerNumber) -> Landmarks:
    """Joints of which none is exactly where the other view's sight line passes."""
    told = person_of(seen(viewer, 3)).landmarks
    assert told is not None
    return msgspec.structs.replace(
        told, joints_px=tuple((x, y + 2.0 * viewer) for x, y in told.joints_px)
    )


def test_sight_lines_miss_by_what_lies_across_both_and_meet_half_way() -> None:
    """A point for each view, 0.08 m apart along what is across both lines, on one side and on the
    other: the gap has the side's sign."""
    first, second = RIG.cameras
    middle = np.array([[0.3, 1.2, 0.4], [-0.6, 0.5, -0.2]])
    one, other = (middle - centre(camera) for camera in (first, second))
    across = np.cross(one, other)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    half_m = np.array([[0.04], [-0.025]]) * across
    gaps_m, places_m = rig_agreement.meetings(
        RIG.cameras, project(first, middle - half_m), project(second, middle + half_m)
    )
    assert gaps_m == pytest.approx([0.08, -0.05], rel=1e-3)
    assert places_m == pytest.approx(middle, abs=1e-3)


def test_lines_that_are_nearly_one_miss_by_no_more_than_narrow_ones() -> None:
    """Seen twice from one place, a hand's breadth apart: 0.05 is the least squared sine."""
    first = RIG.cameras[0]
    beside = msgspec.structs.replace(first, t=as_row(np.array(first.t) - [0.1, 0.0, 0.0]))
    point, raised = np.array([[0.0, 1.0, 0.0]]), np.array([[0.0, 1.03, 0.0]])
    one = point[0] - centre(first)
    other = raised[0] - centre(beside)
    one, other = one / np.linalg.norm(one), other / np.linalg.norm(other)
    shown_px = project(first, point), project(beside, raised)
    gaps_m, _ = rig_agreement.meetings((first, beside), *shown_px)
    base = centre(beside) - centre(first)
    assert gaps_m[0] == pytest.approx(np.cross(one, other) @ base / math.sqrt(0.05))


def test_the_views_are_turned_against_each_other_by_the_rays_to_their_cameras() -> None:
    """Worked by hand: from the person camera 1 is at 45 degrees, camera 2 at -90; 20 and 130 to
    the right of them are 65 and 40. From -170 to 170 it is the short way round."""
    first, second = RIG.cameras
    place = np.array([centre(first)[0] - 1.5, 1.0, centre(first)[2] - 1.5])
    moved = -np.array(second.R) @ (place - np.array([3.0, -0.4, 0.0]))
    cameras = (first, msgspec.structs.replace(second, t=as_row(moved)))
    told = person_of(seen(1, 0)).landmarks
    assert told is not None

    def facing(deg: float, sure: float = 0.9) -> Landmarks:
        return msgspec.structs.replace(told, facing_deg=deg, facing_confidence=sure)

    def turned_deg(one: Landmarks, other: Landmarks) -> tuple[float, ...]:
        return rig_agreement._turned(cameras, (one, other), place)

    assert turned_deg(facing(20.0), facing(130.0)) == pytest.approx((25.0,))
    assert turned_deg(facing(125.0), facing(-80.0)) == pytest.approx((-20.0,))
    assert turned_deg(facing(20.0, 0.85), facing(130.0)) == ()
    assert turned_deg(facing(20.0), facing(130.0, 0.86)) == pytest.approx((25.0,))


def test_points_are_joints_of_the_middle_and_middles_of_pairs() -> None:
    places = tuple((3.0 * n, 100.0 + n**2) for n in range(15))
    told = msgspec.structs.replace(shown(1), joints_px=places)
    at = {name: n for n, name in enumerate(JOINT_NAMES)}
    middles = [
        ((3.0 * (left + right)) / 2, (200.0 + left**2 + right**2) / 2)
        for left, right in (
            (at[f"l_{part}"], at[f"r_{part}"]) for part in ("shoulder", "knee", "ankle")
        )
    ]
    alone = [places[at[name]] for name in ("pelvis", "neck", "head_top")]
    assert rig_agreement._points(told) == pytest.approx(np.array([*alone, *middles]))


def test_the_lower_ankle_is_lower_whichever_sides_a_view_has_exchanged() -> None:
    legs = standing((0.1, -0.1))
    legs[POSE_INDEX["l_hip_x"]], legs[POSE_INDEX["l_knee_x"]] = 60.0, -90.0
    joints_m = np.asarray(joints(BODY, legs))
    ankles_m = joints_m[[n for n, name in enumerate(JOINT_NAMES) if name.endswith("ankle")], 1]
    for swaps in (False, True):
        one = person_of(seen(1, 0, joints_m=joints_m)).landmarks
        other = person_of(seen(2, 0, joints_m=joints_m, swaps=swaps)).landmarks
        assert one is not None
        assert other is not None
        found_m = rig_agreement._lower_ankle_m(RIG.cameras, one, other)
        assert found_m == pytest.approx(ankles_m.min(), abs=1e-6)


def test_joints_gaps_are_those_of_the_sides_that_meet_better() -> None:
    """An arm is raised: exchanged sight lines miss each other by much more."""
    joints_m = np.asarray(joints(BODY, standing((0.2, 0.1), r_shoulder_z=100.0)))
    one, other = (person_of(seen(n, 0, joints_m=joints_m)).landmarks for n in (1, 2))
    swapped = person_of(seen(2, 0, joints_m=joints_m, swaps=True)).landmarks
    assert one is not None
    assert other is not None
    assert swapped is not None
    for second in (other, swapped):
        gaps_m = rig_agreement.joint_gaps_m(RIG.cameras, one, second, rig_agreement.SURE_JOINT)
        assert gaps_m == pytest.approx(np.zeros(15), abs=1e-6)


def test_an_instant_counts_if_it_is_late_enough_and_both_views_are_sure_of_a_whole_person() -> None:
    state = agreed(State(), RIG, (seen(1, 0), seen(2, 0)))
    assert (len(state.samples), state.last_s) == (1, 0.0)

    def told(captured_s: float, **changed: Any) -> int:
        pair = [msgspec.structs.replace(seen(n, 0), captured_s=captured_s) for n in (1, 2)]
        pair[1] = otherwise(pair[1], **changed)
        return len(agreed(state, RIG, (pair[0], pair[1])).samples)

    assert told(0.149) == 1
    assert told(0.15) == 2
    assert told(-0.05) == 2, "a clip that begins anew"
    assert told(0.3, cut=True) == 1
    assert told(0.3, landmarks=None) == 1
    assert told(0.3, landmarks=person_of(seen(2, 0, sure=0.59)).landmarks) == 1
    assert told(0.3, landmarks=person_of(seen(2, 0, sure=0.61)).landmarks) == 2


def test_a_sample_is_points_then_joints_then_the_ankle() -> None:
    one, other = shown(1), shown(2)
    sample, turned_deg = rig_agreement._sample(RIG, one, other)
    points = rig_agreement.meetings(
        RIG.cameras, rig_agreement._points(one), rig_agreement._points(other)
    )[0]
    assert sample[:6] == pytest.approx(points)
    assert sample[6:21] == pytest.approx(
        rig_agreement.joint_gaps_m(RIG.cameras, one, other, rig_agreement.SURE_JOINT)
    )
    assert sample[21] == pytest.approx(rig_agreement._lower_ankle_m(RIG.cameras, one, other))
    assert len(sample) == 22
    assert np.abs(turned_deg).max() < 5.0
