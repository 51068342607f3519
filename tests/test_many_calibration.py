"""Rigs of three cameras found by the person before them, held against rigs that are known."""

import math
from typing import Any, NamedTuple

import numpy as np
import pytest
from many_views import around, shown

from calibration.person import many_calibration
from calibration.person.many_calibration import _pairs, _tree, calibrated_by_all
from calibration.person.rig_quality import CameraQuality, PersonCalibration, Quality
from calibration.tracks.camera_clocks import clocks_of
from calibration.tracks.lateness import Clock
from common.rig.camera import Rig, centre
from common.rig.rig_file import CalibrationError, check_rig
from synth.person.people import person


def off(found: Rig, true: Rig, number: int) -> tuple[float, float]:
    """Turn, degrees, and place, metres, of a camera against camera 1, off the truth."""
    turns, places = [], []
    for rig in (found, true):
        first, other = rig.cameras[0], rig.cameras[number]
        turns.append(np.array(other.R) @ np.array(first.R).T)
        places.append(np.array(first.R) @ (centre(other) - centre(first)))
    cosine = (np.trace(turns[0] @ turns[1].T) - 1) / 2
    return math.degrees(math.acos(min(1.0, cosine))), float(np.linalg.norm(places[0] - places[1]))


LATE_S = (-0.2, 0.2)
"""Of the clocks of cameras 2 and 3, before the first person."""


class Found(NamedTuple):
    """A rig of three cameras, and what its person gave of it."""

    true: Rig
    joint: PersonCalibration
    pairs: dict[tuple[int, int], Any]
    """What the joint adjustment began with."""


def found_by(seed: int, posture: str, late_s: tuple[float, ...] = ()) -> Found:
    begun, by_pairs = list[Any](), many_calibration._by_pairs

    def noted(*given: Any) -> Any:
        begun.append(by_pairs(*given))
        return begun[-1]

    rig, stature_m = around(3, seed), person(seed).measures["stature_m"]
    seen = shown(rig, seed, posture, late_s)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(many_calibration, "_by_pairs", noted)
        joint = calibrated_by_all((seen,), stature_m, None, (clocks_of(seen),))
    return Found(rig, joint, begun[-1])


@pytest.fixture(scope="module")
def by_first() -> Found:
    return found_by(12, "free", (0.0, *LATE_S))


@pytest.mark.slow
def test_three_cameras_are_found_with_their_clocks_by_one_person(by_first: Found) -> None:
    rig, found, _ = by_first
    check_rig(found.rig, "found")
    assert [camera.name for camera in found.rig.cameras] == ["cam1", "cam2", "cam3"]
    assert found.late_s == pytest.approx(LATE_S, abs=0.5 / 15)
    assert len(found.clocks) == len(found.quality.late_error_frames) == 2
    for number in (1, 2):
        turn_deg, place_m = off(found.rig, rig, number)
        assert turn_deg < 4.0
        assert place_m < 0.5
    for camera, true in zip(found.rig.cameras, rig.cameras, strict=True):
        assert camera.K[0][0] == pytest.approx(true.K[0][0], rel=0.08)
    assert found.quality.gap_mm < 40.0


def test_two_cameras_are_found_as_a_pair(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr(
        many_calibration, "calibrated_by_person", lambda *given: asked.append(given)
    )
    seen = shown(around(2), 11, "squat")
    calibrated_by_all((seen, seen), 1.7, 50.0, ((Clock(0.1),), (Clock(0.2),)))
    ((pairs, *given),) = asked
    assert given == [1.7, 50.0, (Clock(0.1), Clock(0.2))]
    assert len(pairs) == 2


def test_a_camera_that_sees_nobody_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """The pairs with camera 3 fail; the others' is as good as any."""

    def by_person(pairs: object, *_: object) -> object:
        first, second = pairs[0].first, pairs[0].second  # type: ignore[index]
        if not (first.confidence.any() and second.confidence.any()):
            raise CalibrationError("nobody is there")
        return calibration(1.0)

    monkeypatch.setattr(many_calibration, "calibrated_by_person", by_person)
    seen = shown(around(3), 11, "squat")
    blind = seen.tracks[2]._replace(confidence=np.zeros_like(seen.tracks[2].confidence))
    seen = seen._replace(tracks=(*seen.tracks[:2], blind))
    with pytest.raises(CalibrationError, match=r"^camera 3: nobody is there$"):
        calibrated_by_all((seen,), 1.7, None, ((Clock(0.0), Clock(0.0)),))


def calibration(error_deg: float) -> PersonCalibration:
    """Of two cameras, so sure."""
    own = CameraQuality("cam1", 1.0, 1.0, (0.0,) * 3, (0.0,) * 3, (error_deg, 0.0, 0.0))
    quality = Quality((own,), 1.75, 40, 12.0, 1.0, (0.0,), (0.1,))
    return PersonCalibration(around(2), (0.0,), (Clock(0.0),), quality)


def test_from_each_camera_the_surest_ways_lead_to_the_others() -> None:
    """Camera 3 is seen surely from camera 2 alone: 1 + 1 is less than 4."""
    found = {
        pair: calibration(deg) for pair, deg in {(0, 1): 1.0, (1, 2): 1.0, (0, 2): 2.0}.items()
    }
    assert _tree(found, 3, 0) == [(0, 1), (1, 2)]
    assert _tree(found, 3, 2) == [(0, 1), (1, 2)]
    direct = {**found, (0, 2): calibration(1.2)}
    assert _tree(direct, 3, 0) == [(0, 1), (0, 2)]
    assert _tree(direct, 3, 2) == [(0, 2), (2, 1)]


def test_of_many_cameras_each_is_paired_with_its_neighbours() -> None:
    assert len(_pairs(3)) == 3
    assert len(_pairs(4)) == 6
    eight = _pairs(8)
    assert len(eight) == 24
    assert (0, 4) not in eight
    assert {(0, 1), (0, 3), (0, 5), (0, 7)} <= {*eight}


@pytest.mark.slow
def test_the_joint_adjustment_is_better_than_the_pairs_it_begins_with(by_first: Found) -> None:
    """Of two people before three cameras, each camera's turn against camera 1, on average."""
    pairs_deg, joint_deg = [], []
    for rig, joint, pairs in (by_first, found_by(13, "walk_slow_bigswing")):
        for n in (1, 2):
            joint_deg.append(off(joint.rig, rig, n)[0])
            two = Rig(rig.width, rig.height, (rig.cameras[0], rig.cameras[n]))
            pairs_deg.append(off(pairs[0, n].rig, two, 1)[0])
    assert np.mean(joint_deg) < np.mean(pairs_deg)
