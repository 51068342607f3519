"""Poses of people who are pictured."""

import numpy as np

from synth.person.people import person
from synth.person.skeleton import ANGLES
from synth.picture.example_poses import WILD_DEG, poses_deg


def many() -> list[np.ndarray]:
    return [poses_deg(person(seed), 16, np.random.default_rng(seed)) for seed in range(40)]


def test_all_of_them_are_poses() -> None:
    for angles in many():
        assert angles.shape == (16, len(ANGLES))
        assert np.isfinite(angles).all()
        assert angles[:, [i for i, name in enumerate(ANGLES) if "knee" in name]].min() >= 0.0


def test_people_are_seen_from_all_sides_and_some_lie() -> None:
    angles = np.concatenate(many())
    yaw = angles[:, ANGLES.index("root_yaw")]
    quarters = np.histogram(np.mod(yaw, 360.0), bins=4, range=(0.0, 360.0))[0] / len(yaw)
    assert quarters.min() > 0.1
    leaning = np.abs(angles[:, ANGLES.index("root_pitch")]) > 50.0
    assert 0.03 < leaning.mean() < 0.2


def test_wild_poses_reach_far_with_every_joint() -> None:
    angles = np.concatenate(many())
    for i, name in enumerate(ANGLES):
        low, high = WILD_DEG[name[2:] if name[1] == "_" else name]
        assert np.ptp(angles[:, i]) > 0.5 * (high - low), name
