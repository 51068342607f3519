"""What landmarks are worth before a rig is fitted to them, counted by hand."""

import numpy as np
import pytest

from calibration.person import rig_evidence
from calibration.person.rig_evidence import (
    ClipEvidence,
    Evidence,
    exchanged,
    gathered,
    own_moments,
    sigma_px,
)
from calibration.person.rig_starts import known_of
from calibration.tracks import person_prior as prior
from calibration.tracks.joint_tracks import JointTrack, Sighting
from common.body.body import JOINT_NAMES

AT = {name: n for n, name in enumerate(JOINT_NAMES)}
KNOWN = known_of(320, 1.75, 1)


def track(seconds: float, hz: float = 15.0, sure: float = 0.9) -> JointTrack:
    """A joint's column is its number, its row the frame's."""
    n = round(seconds * hz)
    joints = np.stack(np.broadcast_arrays(np.arange(15.0), np.arange(float(n))[:, None]), axis=-1)
    facing = np.zeros(n)
    return JointTrack(np.arange(n) / hz, joints.copy(), np.full((n, 15), sure), facing, facing)


def of(first: JointTrack) -> ClipEvidence:
    return ClipEvidence(first, first, (100.0, 100.0))


def test_landmarks_err_anew_once_a_second_and_never_more_often_than_they_are_seen() -> None:
    assert own_moments(of(track(4.0))) == pytest.approx(4.0 - 1 / 15)
    assert own_moments(of(track(4.0, hz=0.5))) == pytest.approx(2.0), "two frames, 2 s apart"
    assert own_moments(of(track(10.0, hz=0.2))) == pytest.approx(2.0), "two frames, 5 s apart"
    assert own_moments(of(track(0.0))) == 0.0


def test_what_errs_by_itself_is_a_share_of_all_moments_and_no_more_than_all() -> None:
    evidence = Evidence((of(track(4.0)), of(track(2.0))), (320, 240), KNOWN, 6.0)
    assert evidence.moments == 90
    assert evidence.own_share == pytest.approx(6.0 / 90)
    assert evidence._replace(worth=500.0).own_share == 1.0
    assert Evidence((), (320, 240), KNOWN, 0.0).own_share == 0.0
    thin = evidence.thinned(30)
    assert [len(clip.first.times_s) for clip in thin.clips] == [20, 10]
    assert thin.clips[0].first.joints_px[1, 0, 1] == 3.0
    assert len(thin.clips[0].second.times_s) == 60
    assert evidence.thinned(1000).moments == 90


def test_a_landmark_is_as_sure_as_it_is_probably_within_three_hundredths_of_a_stature() -> None:
    """Of a Rayleigh law: P(off < r) = 1 - exp(-r^2 / 2 sigma^2)."""
    one = track(1.0)
    one.confidence[0, :4] = (0.9, 0.5, 0.11, 1.0)
    found = sigma_px(one, 200.0)[0]
    for sigma, sure in zip(found[[0, 1, 3]], (0.9, 0.5, 0.98), strict=True):
        assert 1.0 - np.exp(-(6.0**2) / (2 * sigma**2)) == pytest.approx(sure)
    assert found[2] == np.inf


def test_only_the_parts_that_are_the_other_way_round_change_sides() -> None:
    one = track(0.2)
    one.confidence[:] = np.arange(15) / 100
    sides = np.zeros((3, 3), bool)
    sides[1, prior.ARMS] = sides[2, prior.LEGS] = True
    found = exchanged(one, sides)
    assert np.array_equal(found.joints_px[0], one.joints_px[0])
    for n, changed in ((1, ("wrist", "elbow", "shoulder")), (2, ("hip", "knee", "ankle"))):
        for name, joint in AT.items():
            other = name
            if name.endswith(changed):
                other = {"l": "r", "r": "l"}[name[0]] + name[1:]
            assert found.joints_px[n, joint].tolist() == [AT[other], n]
            assert found.confidence[n, joint] == AT[other] / 100


def test_a_clip_counts_five_moments_at_most_and_the_person_is_as_high_as_the_crown_tells(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(rig_evidence, "height_px", lambda track: 95.2 * len(track.times_s) / 150)
    monkeypatch.setattr(rig_evidence, "smoothed", lambda track: track)
    monkeypatch.setattr(rig_evidence, "useful_times", lambda one, _: one.first.times_s[::2])
    ten, two = track(10.0), track(2.0)
    sightings = (Sighting(ten, two, (320, 240)), Sighting(two, ten, (320, 240)))
    evidence = gathered(sightings, known_of(320, 1.75, len(sightings)))
    assert evidence.size_px == (320, 240)
    assert evidence.worth == pytest.approx(5.0 + 28 / 15)
    first, second = evidence.clips
    assert first.units_px == pytest.approx((100.0, 20.0))
    assert second.units_px == pytest.approx((20.0, 100.0))
    assert first.first.times_s.tolist() == ten.times_s[::2].tolist()
    assert first.second is two
