"""By how much one view is late, held against films that were shifted."""

import numpy as np
import pytest
from test_person_calibration import filmed_by_the_papers_rig

from integrator.selfcalibration.joint_tracks import JointTrack
from integrator.selfcalibration.lateness import likely_lateness_s

WALKS = filmed_by_the_papers_rig(8, "walk_in_place").sighting
SHOWN = filmed_by_the_papers_rig(8, "raise_both_forward_up").sighting


def late(track: JointTrack, by_s: float) -> JointTrack:
    return track._replace(times_s=track.times_s + by_s)


@pytest.mark.parametrize("by_s", [-0.5, 0.2, 0.6])
def test_a_view_whose_clock_is_late_is_found_within_a_frame_and_a_half(by_s: float) -> None:
    found = likely_lateness_s(SHOWN.first, late(SHOWN.second, by_s))
    assert found == pytest.approx(by_s, abs=0.1)


@pytest.mark.parametrize("by_s", [-0.4, 0.0, 0.3])
def test_somebody_who_rises_slowly_in_one_picture_and_sinks_in_the_other_is_timed_by_his_steps(
    by_s: float,
) -> None:
    up, down = moved_slowly(WALKS.first, -60.0), moved_slowly(WALKS.second, 60.0)
    assert likely_lateness_s(up, late(down, by_s)) == pytest.approx(by_s, abs=0.1)


def moved_slowly(track: JointTrack, rows_px: float) -> JointTrack:
    """The track by so many rows lower at its end than at its beginning."""
    share = (track.times_s - track.times_s[0]) / np.ptp(track.times_s)
    down = np.zeros_like(track.joints_px)
    down[..., 1] = rows_px * share[:, None]
    return track._replace(joints_px=track.joints_px + down)


def test_a_view_that_shows_nobody_is_not_late() -> None:
    blind = SHOWN.second._replace(confidence=np.zeros_like(SHOWN.second.confidence))
    assert likely_lateness_s(SHOWN.first, blind) == 0.0
