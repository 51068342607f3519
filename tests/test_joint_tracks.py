"""Tracks of landmarks: what lies between frames, and which moments count."""

import math

import numpy as np
import pytest
from staging import report, silhouettes, standing

from calibration.tracks.joint_tracks import (
    JOINTS,
    MOST_FRAMES,
    JointTrack,
    Sighting,
    Sightings,
    at_times,
    height_px,
    longest_seen,
    row_of,
    smoothed,
    track_of,
    useful_times,
)
from common.body.body import JOINT_NAMES
from common.body.observation import Landmarks


def moving(frames: int, sure: float = 0.9) -> JointTrack:
    """Every joint goes a pixel to the right with each frame."""
    joints = np.zeros((frames, JOINTS, 2))
    joints[..., 0] = np.arange(frames)[:, None]
    facing = np.zeros(frames)
    return JointTrack(
        np.arange(frames) / 10, joints, np.full((frames, JOINTS), sure), facing, facing
    )


@pytest.mark.parametrize("of", [lambda track: track, smoothed], ids=["as seen", "smoothed"])
def test_between_two_frames_a_joint_is_between_its_places(of) -> None:  # type: ignore[no-untyped-def]
    found = at_times(of(moving(9)), np.array([0.2, 0.25, 0.58]))
    assert found.joints_px[:, 4, 0] == pytest.approx([2.0, 2.5, 5.8])
    assert found.confidence[:, 4] == pytest.approx([0.9] * 3)


def test_beyond_its_ends_a_track_tells_nothing() -> None:
    found = at_times(moving(9), np.array([-0.5, 0.1, 1.5]))
    assert found.confidence.max(axis=1).tolist() == [0.0, 0.9, 0.0]


def test_what_is_not_seen_does_not_pull_its_neighbours() -> None:
    track = moving(5)
    track.confidence[2] = 0.0
    track.joints_px[2] = 1000.0
    assert smoothed(track).joints_px[[1, 3], 0, 0] == pytest.approx([2 / 3, 3 + 1 / 3])


def test_moments_count_where_both_views_are_sure_and_are_thinned() -> None:
    first, second = moving(400), moving(400)
    first.confidence[:100] = 0.1
    second.confidence[300:] = 0.1
    times = useful_times(Sighting(first, second, (160, 120)), 0.0)
    assert len(times) == MOST_FRAMES
    assert (times[0], times[-1]) == pytest.approx((10.0, 29.9))


def test_moments_between_two_views_that_never_saw_somebody_together_do_not_count() -> None:
    """View 1 loses the person, and view 2, which gave no picture meanwhile, finds them."""
    first, second = moving(40), moving(40)
    later = JointTrack(*(part[[0, *range(30, 40)]] for part in second))
    later.confidence[0] = 0.0
    first.confidence[30:] = 0.0
    assert not len(useful_times(Sighting(first, later, (160, 120)), 0.0))


def test_nobody_has_no_height() -> None:
    assert height_px(moving(5, sure=0.0)) == 0.0


@pytest.mark.parametrize(("lean_deg", "tells"), [(0, True), (55, True), (65, False), (175, False)])
def test_who_lies_tells_nothing_of_a_rig(lean_deg: float, tells: bool) -> None:
    """Their soles are not on the floor."""
    a = math.radians(lean_deg)
    places = [(80.0 + up * math.sin(a), 60.0 - up * math.cos(a)) for up in np.linspace(0, 30, 15)]
    order = np.argsort([name != "pelvis" for name in JOINT_NAMES], kind="stable")
    joints_px = [(0.0, 0.0)] * JOINTS
    for place, at in zip(places, order, strict=True):
        joints_px[at] = place
    shown = Landmarks(tuple(joints_px), (0.9,) * JOINTS, 0.0, 0.9)
    row = row_of(report(1, silhouettes(standing())[0], landmarks=shown))
    assert bool(row[2].any()) == tells
    assert bool(row[4]) == tells


def test_a_joint_at_the_border_of_the_picture_is_not_relied_on() -> None:
    """160 x 120: from column and row 1 on, to 159 and 119."""
    places = [(60.0 + n, 50.0 + n) for n in range(JOINTS)]
    at = dict(zip(("l_wrist", "r_wrist", "l_ankle", "r_ankle"), range(4), strict=True))
    inside = {"l_wrist": (1.0, 40.0), "r_wrist": (159.0, 40.0)}
    inside |= {"l_ankle": (60.0, 1.0), "r_ankle": (60.0, 119.0)}
    outside = {"l_wrist": (0.9, 40.0), "r_wrist": (159.1, 40.0)}
    outside |= {"l_ankle": (60.0, 0.9), "r_ankle": (60.0, 119.1)}
    for moved, sure in ((inside, 0.8), (outside, 0.0)):
        joints_px = list(places)
        for name, place in moved.items():
            joints_px[JOINT_NAMES.index(name)] = place
        joints_px[JOINT_NAMES.index("pelvis")] = (70.0, 90.0)
        shown = Landmarks(tuple(joints_px), (0.8,) * JOINTS, 33.0, 0.7)
        row = row_of(report(1, silhouettes(standing())[0], landmarks=shown, captured_s=2.5))
        assert [row[2][JOINT_NAMES.index(name)] for name in at] == [sure] * 4
        assert row[2].sum() == pytest.approx(0.8 * (JOINTS - 4) + 4 * sure)
        assert (row[0], *row[3:]) == (2.5, 33.0, 0.7)


def test_a_track_of_reports_has_a_row_for_each_of_them() -> None:
    places = tuple((60.0 + n, 110.0 - 3 * n) for n in range(JOINTS))
    shown = Landmarks(places, (0.8,) * JOINTS, 33.0, 0.7)
    mask = silhouettes(standing())[0]
    track = track_of(
        [report(1, mask, landmarks=shown, captured_s=0.5), report(1, mask, captured_s=0.75)]
    )
    assert track.times_s.tolist() == [0.5, 0.75]
    assert track.joints_px[0] == pytest.approx(np.array(places))
    assert not track.confidence[1].any()
    assert track.facing_deg.tolist() == [33.0, 0.0]
    assert track.facing_confidence.tolist() == [0.7, 0.0]
    assert [part.shape for part in track_of([])] == [(0,), (0, 15, 2), (0, 15), (0,), (0,)]


def test_nothing_is_looked_at_where_a_view_has_no_two_frames() -> None:
    several, one, none = moving(20), moving(1), moving(0)
    for first, second in ((several, one), (several, none), (none, several)):
        assert not len(useful_times(Sighting(first, second, (160, 120)), 0.0))
    two = useful_times(Sighting(moving(2), moving(2), (160, 120)), 0.0)
    assert two == pytest.approx([0.0, 0.1])


def test_a_long_clip_is_looked_at_more_often_and_never_more_than_enough() -> None:
    """2.5 times a second, 360 times at most; a view that is late has as many fewer."""
    for frames, late_s, most in ((600, 0.0, 149), (600, 20.0, 100), (3000, 0.0, 360)):
        track = moving(frames)
        times = useful_times(Sighting(track, track, (160, 120)), late_s)
        assert len(times) == most
        assert times[-1] == pytest.approx((frames - 1) / 10 - late_s, abs=0.11)


def test_between_frames_the_nearest_says_the_facing_and_the_less_sure_how_sure() -> None:
    track = moving(4)
    track = track._replace(
        facing_deg=np.array([10.0, 20.0, 30.0, 40.0]),
        facing_confidence=np.array([0.1, 0.2, 0.3, 0.4]),
    )
    track.confidence[1] = 0.5
    found = at_times(track, np.array([0.04, 0.06, 0.14, 0.1, 0.2]))
    assert found.facing_deg.tolist() == [10.0, 20.0, 20.0, 20.0, 30.0]
    assert found.facing_confidence.tolist() == [0.1, 0.2, 0.2, 0.2, 0.3]
    assert found.confidence[:4, 3].tolist() == [0.5] * 4
    assert found.times_s.tolist() == [0.04, 0.06, 0.14, 0.1, 0.2]
    ends = at_times(track, np.array([-0.09, -0.11, 0.39, 0.41]))
    assert ends.confidence[:, 0] == pytest.approx([0.9, 0.0, 0.9, 0.0])
    assert ends.joints_px[:, 0, 0] == pytest.approx([0.0, 0.0, 3.0, 3.0])


def test_a_landmark_is_weighed_with_its_neighbours_one_two_one() -> None:
    track = moving(3)
    track.joints_px[:, 2] = [(1.0, 10.0), (5.0, 30.0), (6.0, 20.0)]
    track.confidence[:, 2] = [0.4, 0.8, 0.6]
    found = smoothed(track)
    weights = np.array([0.4, 1.6, 0.6])
    middle = weights @ track.joints_px[:, 2] / 2.6
    first = np.array([0.8, 0.8]) @ track.joints_px[:2, 2] / 1.6
    assert found.joints_px[:2, 2] == pytest.approx(np.array([first, middle]))
    assert found.confidence is track.confidence


def test_a_persons_height_is_that_of_most_frames_from_crown_to_between_the_ankles() -> None:
    """Ten frames: crouching in six, upright in three, and one that nobody is sure of."""
    track = moving(10)
    crown, left, right = (JOINT_NAMES.index(name) for name in ("head_top", "l_ankle", "r_ankle"))
    track.joints_px[:, left], track.joints_px[:, right] = (40.0, 100.0), (60.0, 90.0)
    track.joints_px[:, crown] = [(50.0, 95.0 - tall) for tall in (*range(40, 46), 60, 61, 62, 900)]
    track.confidence[9] = 0.39
    assert height_px(track) == pytest.approx(np.percentile([*range(40, 46), 60, 61, 62], 70))


def test_who_one_view_alone_shows_long_is_no_evidence_about_a_rig() -> None:
    """Two views judge: the second longest counts, and half of what the longest seen person has."""

    def seen(*frames: int) -> Sightings:
        return Sightings(tuple(moving(each) for each in frames), (320, 240))

    everyone = seen(40, 90), seen(80, 80), seen(90, 39, 5), seen(20, 100)
    assert longest_seen(everyone) == (everyone[1], everyone[0])
    assert longest_seen([]) == ()
