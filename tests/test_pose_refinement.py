"""Poses matched where the proposed one fits badly, held against outlines of a known pose (L1)."""

import subprocess
import sys

import numpy as np
import pytest
from posing import posed
from rolling import BODY, ROLLED, on_one_leg, outlines, told
from scipy.stats import maxwell

from common.body.body import JOINT_NAMES, LIMITS_DEG, POSE_INDEX, Vector
from common.body.kinematics import ALL_LIMBS, joints
from common.body.proportions import body_vector
from common.bus.messages import Report
from common.raster.kernel import match, view_of
from integrator.fit import pose_refinement
from integrator.fit.pose_refinement import Previous
from integrator.fit.silhouette_pair import silhouettes_of
from integrator.proposal.pose_proposal import CONFIDENT

VECTOR = body_vector(BODY)
REHEARSED = """
from common.config.settings import Settings
from integrator.fit import pose_refinement, visual_hull
from integrator.integrator_warmup import warm_up
warm_up(Settings(), (160, 120))
for compiled in (visual_hull._carve, pose_refinement._penalties):
    print(len(compiled.signatures))
"""
UNSURE = np.full(15, 0.05)


def seen_as(pose: Vector) -> tuple[Report, Report]:
    first, second = outlines(pose)
    return told(1, first), told(2, second)


def scores(pose: Vector, seen: tuple[Report, Report]) -> list[float]:
    both = silhouettes_of(ROLLED, seen)
    return [
        match(VECTOR, pose, view_of(camera), ALL_LIMBS, both.width, mask, int(area))
        for camera, mask, area in zip(ROLLED.cameras, both.seen, both.seen_px, strict=True)
    ]


def error_m(pose: Vector, truth: Vector) -> float:
    return float(np.linalg.norm(joints(VECTOR, pose) - joints(VECTOR, truth), axis=1).mean())


def standing() -> Vector:
    pose = posed()
    pose[1] = 0.98
    return pose


def test_a_pose_is_followed_from_the_one_before_whatever_is_proposed() -> None:
    """Leaning far over on one leg, which the network hardly learnt, before rolled cameras."""
    before, truth = on_one_leg(35.0), on_one_leg(45.0)
    seen = seen_as(truth)
    found = pose_refinement.refined(standing(), UNSURE, Previous(before), VECTOR, ROLLED, seen)
    assert found is not None
    assert min(scores(standing(), seen)) < 0.4
    assert min(scores(found, seen)) > 0.75
    assert error_m(found, truth) < 0.05
    assert error_m(found, truth) < 0.5 * error_m(before, truth)


def test_somebody_is_found_where_nothing_was_known_before() -> None:
    truth = standing()
    truth[POSE_INDEX["r_shoulder_z"]] = 90.0
    seen = seen_as(truth)
    found = pose_refinement.refined(on_one_leg(), UNSURE, Previous(), VECTOR, ROLLED, seen)
    assert found is not None
    assert min(scores(found, seen)) > 0.75


def test_a_proposal_that_matches_is_left_alone() -> None:
    truth = on_one_leg()
    assert (
        pose_refinement.refined(truth, UNSURE, Previous(), VECTOR, ROLLED, seen_as(truth)) is None
    )


def test_a_pose_that_was_matched_goes_on_until_a_proposal_matches_as_well() -> None:
    truth = on_one_leg()
    seen, proposed = seen_as(truth), truth.copy()
    proposed[POSE_INDEX["l_hip_z"]] -= 10.0
    assert min(scores(proposed, seen)) > pose_refinement.POOR
    found = pose_refinement.refined(
        proposed, UNSURE, Previous(on_one_leg(42.0), True), VECTOR, ROLLED, seen
    )
    assert found is not None
    assert error_m(found, truth) < error_m(proposed, truth)
    assert (
        pose_refinement.refined(
            truth, UNSURE, Previous(on_one_leg(42.0), True), VECTOR, ROLLED, seen
        )
        is None
    )


def test_one_view_alone_matches_nothing() -> None:
    first, _ = seen_as(on_one_leg())
    assert (
        pose_refinement.refined(standing(), UNSURE, Previous(), VECTOR, ROLLED, (first, None))
        is None
    )


def test_joints_that_are_sure_stay_where_they_are() -> None:
    """A leg that the outlines lost is not looked for where it is surely not."""
    proposed, seen = _bent_over(), seen_as(on_one_leg())
    legs = np.array(["knee" in name or "ankle" in name for name in JOINT_NAMES])
    sure = np.where(legs, 0.999, UNSURE)
    assert sure.mean() < CONFIDENT
    held = pose_refinement.refined(proposed, sure, Previous(proposed), VECTOR, ROLLED, seen)
    free = pose_refinement.refined(proposed, UNSURE, Previous(proposed), VECTOR, ROLLED, seen)
    assert held is not None
    assert free is not None
    moved_m = [
        np.linalg.norm(joints(VECTOR, pose)[legs] - joints(VECTOR, proposed)[legs], axis=1).mean()
        for pose in (held, free)
    ]
    assert moved_m[0] < moved_m[1]


def _bent_over() -> Vector:
    proposed = on_one_leg()
    proposed[POSE_INDEX["torso_z"]] += 12.0
    return proposed


def test_the_same_instant_gives_the_same_pose() -> None:
    seen = seen_as(on_one_leg())
    first, second = (
        pose_refinement.refined(
            standing(), UNSURE, Previous(on_one_leg(35.0)), VECTOR, ROLLED, seen
        )
        for _ in range(2)
    )
    assert first is not None
    assert second is not None
    assert np.array_equal(first, second)


def test_no_joint_is_turned_beyond_its_limits() -> None:
    found = pose_refinement.refined(
        standing(), UNSURE, Previous(on_one_leg(35.0)), VECTOR, ROLLED, seen_as(on_one_leg(45.0))
    )
    assert found is not None
    for name, (low, high) in LIMITS_DEG.items():
        assert low <= found[POSE_INDEX[name]] <= high, name


@pytest.mark.parametrize("sure", [0.05, 0.3, 0.5, 0.9, 0.99])
def test_a_spread_is_that_of_a_cloud_with_so_many_points_within_50_mm(sure: float) -> None:
    """The distance of a point of a round normal cloud from its middle has Maxwell's law."""
    spread_m = pose_refinement.spread_m(np.array([sure]))[0]
    assert maxwell.cdf(0.05, scale=spread_m) == pytest.approx(sure, abs=0.01)


def test_pictures_of_two_sizes_are_matched_as_those_of_one() -> None:
    """A narrower picture is taken to be empty beside its border."""
    first, second = outlines(on_one_leg())
    rows, columns = np.flatnonzero(second.any(axis=1)), np.flatnonzero(second.any(axis=0))
    narrow = second[: rows[-1] + 2, : columns[-1] + 2]
    assert narrow.shape[1] < second.shape[1]
    whole = silhouettes_of(ROLLED, (told(1, first), told(2, second)))
    other = silhouettes_of(ROLLED, (told(1, first), told(2, narrow)))
    assert np.array_equal(whole.seen, other.seen)
    assert whole.seen_px.tolist() == other.seen_px.tolist()
    assert whole.width == other.width


def test_a_rehearsal_compiles_what_a_doubtful_pose_needs() -> None:
    """In a process of its own: nothing is left to compile in the middle of a live run."""
    told = subprocess.run(
        [sys.executable, "-c", REHEARSED], capture_output=True, text=True, check=True, timeout=300
    )
    assert told.stdout.split() == ["1", "1"]
