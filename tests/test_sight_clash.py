"""Whether two views follow one person: exact landmarks of one, of two, and by wrong rigs."""

import math

import numpy as np
import pytest
from staging import RIG
from test_rig_agreement import turned
from two_people import PERIOD_S, first_m, other_m, seen

from calibration.gate.sight_clash import (
    CLASHES_M,
    LATEST,
    MEETS_M,
    Clash,
    Meeting,
    gap_m,
    is_of_different_people,
    row_of_landmarks,
    step,
)
from calibration.tracks.joint_tracks import Sighting, track_of_rows
from common.rig.camera import Rig

LASTING = 5


def meeting(n: int, one_m: np.ndarray, two_m: np.ndarray, rig: Rig = RIG) -> Meeting:
    people = seen(0, one_m), seen(1, two_m)
    shown = [person.landmarks for person in people]
    assert shown[0] is not None
    assert shown[1] is not None
    rows = tuple(row_of_landmarks(n * PERIOD_S, each) for each in shown if each is not None)
    return Meeting(gap_m(rig.cameras, *people), (rows[0], rows[1]))


def after(*instants: Meeting, clash: Clash = Clash()) -> Clash:
    for now in instants:
        clash = step(clash, now, LASTING)
    return clash


ONE = [meeting(n, first_m(n), first_m(n)) for n in range(60)]
TWO = [meeting(n, first_m(n), other_m(n)) for n in range(60)]
WRONG = [meeting(n, first_m(n), first_m(n), turned(RIG, 0.0, 0.5)) for n in range(90)]


def test_sight_lines_of_one_person_meet_and_of_two_do_not() -> None:
    assert max(each.gap_m for each in ONE) < 1e-6
    assert min(each.gap_m for each in TWO) > CLASHES_M


def test_a_gap_is_that_of_the_vertical_distance_between_level_sight_lines() -> None:
    """Camera 2 half a metre higher than the rig says: level rays miss by half a metre."""
    found = gap_m(turned(RIG, 0.0, 0.5).cameras, seen(0, first_m(0)), seen(1, first_m(0)))
    assert found == pytest.approx(0.5, abs=0.03)


def test_too_few_sure_joints_say_nothing() -> None:
    assert math.isnan(gap_m(RIG.cameras, seen(0, first_m(0), sure=0.4), seen(1, first_m(0))))
    assert math.isnan(gap_m(RIG.cameras, None, seen(1, first_m(0))))


def test_after_one_person_a_lasting_clash_is_of_two_and_a_single_frame_changes_nothing() -> None:
    met = after(*ONE[:10])
    assert not after(*TWO[10:14], clash=met).is_apart
    assert after(*TWO[10:15], clash=met).is_apart
    assert not after(*TWO[10:14], *ONE[14:20], *TWO[20:22], clash=met).is_apart


def test_what_is_between_meeting_and_clashing_changes_nothing() -> None:
    unsure = ONE[0]._replace(gap_m=(MEETS_M + CLASHES_M) / 2.0)
    before = after(*TWO[:3])
    assert after(unsure, unsure._replace(gap_m=math.nan), clash=before) == before


def test_views_that_are_apart_are_one_again_by_a_rig_that_is_a_little_wrong() -> None:
    """Half of the way from meeting to clashing, to which no other evidence comes."""
    between = [each._replace(gap_m=(MEETS_M + CLASHES_M) / 2.0) for each in ONE]
    apart = after(*ONE[:10], *TWO[10:25])
    assert after(*between[25:29], clash=apart).is_apart
    assert not after(*between[25:30], clash=apart).is_apart


def test_views_that_meet_again_for_as_long_follow_one_person() -> None:
    apart = after(*ONE[:10], *TWO[10:25])
    assert after(*ONE[25:29], clash=apart).is_apart
    assert after(*ONE[25:30], clash=apart) == Clash(LASTING)


def test_two_people_from_the_start_are_told_by_pictures_that_no_two_cameras_would_give() -> None:
    assert not after(*TWO[:11]).is_apart
    assert after(*TWO[:40]).is_apart


def test_a_wrong_rig_is_never_taken_for_different_people() -> None:
    assert min(each.gap_m for each in WRONG) > CLASHES_M
    assert not any(after(*WRONG[:n]).is_apart for n in range(0, len(WRONG), 5))


def test_a_rig_that_becomes_wrong_is_taken_for_different_people_only_until_they_have_moved() -> (
    None
):
    """A camera that was moved, which its picture did not show."""
    apart = after(*ONE[:10], *WRONG[10:20])
    assert apart.is_apart
    later = after(*WRONG[20 : 25 + LATEST], clash=apart)
    assert (later.is_apart, later.met) == (False, 0)


def test_people_who_stand_still_do_not_make_a_rig_wrong() -> None:
    one, two = WRONG[10].rows
    times_s = [n * PERIOD_S for n in range(80)]
    still = [WRONG[10]._replace(rows=((at, *one[1:]), (at, *two[1:]))) for at in times_s]
    assert after(*ONE[:10], *still).is_apart


def test_the_pictures_of_two_people_contradict_one_person_at_any_rig() -> None:
    for meetings, different in ((ONE, False), (WRONG, False), (TWO, True)):
        first, second = zip(*(each.rows for each in meetings), strict=True)
        sighting = Sighting(track_of_rows(first), track_of_rows(second), (RIG.width, RIG.height))
        assert is_of_different_people(sighting, 0.0) == different
