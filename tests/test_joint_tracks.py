"""Tracks of landmarks: what lies between frames, and which moments count."""

import numpy as np
import pytest

from integrator.selfcalibration.joint_tracks import (
    JOINTS,
    MOST_FRAMES,
    JointTrack,
    Sighting,
    at_times,
    height_px,
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
    times = useful_times(Sighting(first, second, (160, 120)))
    assert len(times) == MOST_FRAMES
    assert (times[0], times[-1]) == pytest.approx((10.0, 29.9))


def test_nobody_has_no_height() -> None:
    assert height_px(moving(5, sure=0.0)) == 0.0
