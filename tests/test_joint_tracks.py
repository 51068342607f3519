"""Tracks of landmarks: what lies between frames, and which moments count."""

import math

import numpy as np
import pytest
from staging import report, silhouettes, standing

from common.body.body import JOINT_NAMES
from common.bus.messages import Landmarks
from integrator.selfcalibration.joint_tracks import (
    JOINTS,
    MOST_FRAMES,
    JointTrack,
    Sighting,
    at_times,
    height_px,
    row_of,
    smoothed,
    useful_times,
)


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
