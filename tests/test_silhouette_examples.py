"""Outlines that a network is taught on, held against the bodies that cast them."""

import numpy as np
import pytest

from common.rig.camera import project
from synth.person.skeleton import JOINTS
from synth.picture.silhouette_examples import (
    AT_LARGE,
    FPS,
    LONGEST,
    ORDINARY,
    PEOPLE,
    Manner,
    silhouette_examples,
)


def test_outlines_hold_the_pelvis_and_repeat() -> None:
    first, again = list(silhouette_examples(5)), list(silhouette_examples(5))
    assert 10 < len(first) <= LONGEST
    for a, b in zip(first, again, strict=True):
        for m, n in zip(a.masks, b.masks, strict=True):
            assert (m is None) == (n is None)
            assert m is None or n is None or np.array_equal(m, n)
    inside = [
        mask[tuple(np.floor(project(camera, shown.joints_m[:1])[0]).astype(int)[::-1])]
        for shown in first
        for mask, camera in zip(shown.masks, shown.rig.cameras, strict=True)
        if mask is not None
    ]
    assert np.mean(inside) > 0.95


def test_one_camera_at_least_sees_every_instant() -> None:
    shown = [each for seed in range(12) for each in silhouette_examples(seed)]
    seeing = np.array([[mask is not None for mask in each.masks] for each in shown])
    assert seeing.any(axis=1).all()
    assert 0.03 < (~seeing.all(axis=1)).mean() < 0.5


def test_time_passes_by_whole_frames() -> None:
    frames = np.array(
        [each.since_s * FPS for seed in range(6) for each in silhouette_examples(seed)]
    )
    assert np.allclose(frames, np.rint(frames))
    assert frames.min() >= 1
    assert 1 < frames.max() <= 5


def test_joints_move_as_bodies_do_from_frame_to_frame() -> None:
    """No jump: nothing is faster than a thrown hand, 16 m/s."""
    for seed in range(6):
        shown = list(silhouette_examples(seed))
        steps = np.diff([each.joints_m for each in shown], axis=0)
        since_s = np.array([each.since_s for each in shown[1:]])
        speed = np.linalg.norm(steps, axis=-1).max(axis=1) / since_s
        assert speed.max() < 16.0


def test_nobody_who_is_taught_on_has_a_small_number() -> None:
    """Clips for tests are made with performers below: seeds of `tritrack synth` times ten."""
    assert PEOPLE[0] >= 100_000


@pytest.mark.slow
def test_people_at_large_lean_farther_and_lift_their_legs_higher() -> None:
    """Measured on the joints: the trunk from the vertical, an ankle above the other."""

    def reached(manner: Manner) -> tuple[float, float]:
        poses = np.array(
            [each.joints_m for seed in range(24) for each in silhouette_examples(seed, manner)]
        )
        at = {name: poses[:, JOINTS.index(name)] for name in JOINTS}
        trunk = at["neck"] - at["pelvis"]
        lean_deg = np.degrees(np.arccos(trunk[:, 1] / np.linalg.norm(trunk, axis=1)))
        lifted_m = np.abs(at["l_ankle"][:, 1] - at["r_ankle"][:, 1])
        return float(np.percentile(lean_deg, 95)), float(np.percentile(lifted_m, 95))

    (lean_deg, lifted_m), (usual_deg, usual_m) = reached(AT_LARGE), reached(ORDINARY)
    assert lean_deg > usual_deg + 5.0
    assert lifted_m > usual_m + 0.05
