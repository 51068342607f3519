"""Cloth that hangs about hips and thighs, held against the body that it goes round."""

import numpy as np
import pytest

pytest.importorskip("anny", reason="Anny's people need the extra `train`")

from synth.anny_people.anatomy import anatomy
from synth.anny_people.skirt import NARROWER, tube_about

pytestmark = pytest.mark.slow

ROOM_M = 0.02


def test_cloth_about_a_pillar_is_a_wider_pillar() -> None:
    angle, height = np.meshgrid(np.linspace(0.0, 2 * np.pi, 200), np.linspace(0.2, 1.2, 100))
    pillar = np.stack([0.15 * np.cos(angle), height, 0.15 * np.sin(angle)], axis=-1).reshape(-1, 3)
    tube = tube_about(pillar, (1.0, 0.4), ROOM_M)
    radius = np.hypot(tube.vertices_m[:, 0], tube.vertices_m[:, 2])
    assert radius == pytest.approx(0.17, rel=0.01)
    assert (tube.vertices_m[:, 1].max(), tube.vertices_m[:, 1].min()) == (1.0, 0.4)


def test_cloth_falls_straight_from_the_widest_place() -> None:
    """About a ball it does not close in again below."""
    way = np.random.default_rng(0).normal(size=(20_000, 3))
    ball = 0.2 * way / np.linalg.norm(way, axis=1, keepdims=True) + [0.0, 1.0, 0.0]
    tube = tube_about(ball, (1.0, 0.4), 0.0)
    radius = np.hypot(tube.vertices_m[:, 0], tube.vertices_m[:, 2])
    low = tube.vertices_m[:, 1] == 0.4
    assert radius[low].mean() > 0.2 * NARROWER**6


def test_it_is_seen_from_outside_and_follows_the_nearer_thigh() -> None:
    rng, bones = np.random.default_rng(1), anatomy().bones
    tube = tube_about(rng.uniform((-0.2, 0.4, -0.1), (0.2, 1.1, 0.1), (5000, 3)), (1.0, 0.5), 0.0)
    a, b, c = (tube.vertices_m[tube.faces[:, k]] for k in range(3))
    normals, middle = np.cross(b - a, c - a), (a + b + c) / 3
    assert ((normals * middle)[:, [0, 2]].sum(axis=1) > 0.0).all()
    left = tube.weights[:, bones.index("upperleg02.L")]
    right = tube.weights[:, bones.index("upperleg02.R")]
    assert (left - right)[tube.vertices_m[:, 0] > 0.12].min() >= 0.0
    assert np.allclose(tube.weights.sum(axis=1), 1.0)
