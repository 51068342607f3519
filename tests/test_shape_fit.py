"""A prior body fitted to an outline: silhouettes drawn from a body whose lengths are known."""

import msgspec
import numpy as np
import pytest
from posing import posed
from staging import observation, silhouettes

from common.body.body import Bdp, Vector
from common.body.observation import Observation
from common.body.proportions import body_vector, stature, thesis_bdp
from common.raster.similarity import similarity
from common.rig.camera import paper_rig
from integrator.fit import shape_fit
from integrator.fit.silhouette_pair import silhouettes_of
from integrator.measuring.known_body import Known, Sample, Unmeasured

SIZE = (320, 240)
RIG = paper_rig(SIZE, (400.0, 400.0), (4.5, 4.5))
PRIOR = thesis_bdp(1.75)


def slim() -> Bdp:
    """The same stature, with a narrower trunk and thinner shanks."""
    torso = msgspec.structs.replace(PRIOR.torso, long_radius=0.8 * PRIOR.torso.long_radius)
    shank = msgspec.structs.replace(
        PRIOR.r_lower_leg,
        long_radius=0.7 * PRIOR.r_lower_leg.long_radius,
        short_radius=0.7 * PRIOR.r_lower_leg.short_radius,
    )
    return msgspec.structs.replace(PRIOR, torso=torso, r_lower_leg=shank, l_lower_leg=shank)


def seen_as(body: Bdp, pose: Vector, cut: bool = False) -> tuple[Observation, Observation]:
    first, second = silhouettes(pose, body, RIG)
    return observation(first, cut=cut), observation(second, cut=cut)


def standing() -> Vector:
    pose = posed(r_shoulder_z=160.0, l_shoulder_z=200.0, r_hip_z=176.0, l_hip_z=184.0)
    pose[1] = 0.95
    return pose


def test_widths_come_nearer_to_what_the_outline_shows() -> None:
    pose = standing()
    found = shape_fit.fitted(PRIOR, RIG, (Sample(pose, seen_as(slim(), pose)),))
    assert found.torso.long_radius == pytest.approx(slim().torso.long_radius, rel=0.06)
    assert found.r_lower_leg.long_radius == pytest.approx(slim().r_lower_leg.long_radius, rel=0.15)


def test_the_stature_stays() -> None:
    """It is what the silhouette's height told."""
    pose = standing()
    found = shape_fit.fitted(PRIOR, RIG, (Sample(pose, seen_as(slim(), pose)),))
    assert stature(found) == pytest.approx(stature(PRIOR))


def test_a_body_that_fits_is_left_alone() -> None:
    pose = standing()
    assert shape_fit.fitted(PRIOR, RIG, (Sample(pose, seen_as(PRIOR, pose)),)) == PRIOR


def test_a_body_that_is_being_measured_is_not_fitted() -> None:
    known, pose = Unmeasured(PRIOR, bodies=(PRIOR,)), standing()
    assert shape_fit.step(known, RIG, seen_as(slim(), pose), pose) is known


def test_a_person_partly_outside_tells_no_widths() -> None:
    known: Known = Unmeasured(PRIOR)
    pose = standing()
    assert shape_fit.step(known, RIG, seen_as(slim(), pose, cut=True), pose) is known


def test_samples_are_few_and_apart() -> None:
    known: Known = Unmeasured(PRIOR)
    pose = standing()
    seen = seen_as(PRIOR, pose)
    taken = []
    for frame in range(100):
        before = len(known.samples)
        known = shape_fit.step(known, RIG, seen, pose)
        if len(known.samples) > before:
            taken.append(frame)
    assert taken == [0, 13, 26, 39, 52, 65]
    assert np.diff(taken).min() > shape_fit.APART


def test_an_outline_that_the_body_explains_badly_tells_no_widths() -> None:
    """Something else belongs to it, or the pose is wrong."""
    known: Known = Unmeasured(PRIOR)
    pose = standing()
    elsewhere = pose.copy()
    elsewhere[0] += 0.4
    assert shape_fit.step(known, RIG, seen_as(slim(), pose), elsewhere) is known


def test_no_limb_becomes_wider_than_a_persons() -> None:
    """Shanks that a slab on the floor widens threefold in the outline."""
    thick = msgspec.structs.replace(
        PRIOR.r_lower_leg,
        long_radius=3 * PRIOR.r_lower_leg.long_radius,
        short_radius=3 * PRIOR.r_lower_leg.short_radius,
    )
    slab = msgspec.structs.replace(PRIOR, r_lower_leg=thick, l_lower_leg=thick)
    pose = standing()
    found = shape_fit.fitted(PRIOR, RIG, (Sample(pose, seen_as(slab, pose)),))
    widest = shape_fit.WIDEST * PRIOR.r_lower_leg.long_radius
    assert PRIOR.r_lower_leg.long_radius < found.r_lower_leg.long_radius <= widest


def test_a_fit_is_the_sum_of_similarities_over_samples_and_views() -> None:
    body, other = body_vector(PRIOR), standing()
    other[0] += 0.2
    samples = [(pose, seen_as(slim(), pose)) for pose in (standing(), other)]
    both = [silhouettes_of(RIG, seen) for _, seen in samples]
    found = shape_fit.fit(
        body,
        np.array([pose for pose, _ in samples]),
        both[0].views,
        np.array([each.seen for each in both]),
        np.array([each.seen_px for each in both]),
        SIZE[0],
    )
    expected = [
        similarity(mask, drawn)
        for pose, _ in samples
        for mask, drawn in zip(
            silhouettes(pose, slim(), RIG), silhouettes(pose, PRIOR, RIG), strict=True
        )
    ]
    assert found == pytest.approx(sum(expected))
    assert min(expected) < 0.95


def test_a_body_is_sampled_once_it_fits_and_then_every_so_many_frames() -> None:
    """A first time at once, and the last time with all of the samples."""
    pose = standing()
    known: Known = Unmeasured(PRIOR)
    fits, cut = seen_as(slim(), pose), seen_as(slim(), pose, cut=True)
    assert shape_fit.step(known, RIG, cut, pose) == known
    far = pose.copy()
    far[0] += 1.0
    assert shape_fit.step(known, RIG, fits, far) == known, "it does not fit"
    counts = []
    for _ in range(shape_fit.APART * shape_fit.MOST_SAMPLES + 9):
        known = shape_fit.step(known, RIG, fits, pose)
        counts.append(len(known.samples))
    changes = np.flatnonzero(np.diff([0, *counts]))
    assert changes.tolist() == [(shape_fit.APART + 1) * n for n in range(shape_fit.MOST_SAMPLES)]
    assert known.bdp != PRIOR
