"""The relation of two views, held against cameras and points that are known."""

import numpy as np
import pytest
from wild_rigs import random_pair

from calibration.tracks.view_relation import relation_of, terms_of
from common.rig.camera import project


def seen(seed: int, moved_m: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Points of somebody's size before two random cameras, in heights about their middles; in view
    2 each moved by another way."""
    rng = np.random.default_rng(seed)
    points_m = rng.uniform((-0.5, 0.0, -0.5), (0.5, 1.8, 0.5), (200, 3))
    views = []
    for camera, off_m in zip(random_pair(rng, 1.8).cameras, (0.0, moved_m), strict=True):
        px = project(camera, points_m + off_m * rng.normal(size=points_m.shape))
        views.append((px - px.mean(axis=0)) / np.ptp(px[:, 1]))
    return views[0], views[1]


def missed(seed: int, moved_m: float = 0.0) -> float:
    terms = terms_of(*seen(seed, moved_m))
    return float(np.sqrt(np.mean(relation_of(terms, np.ones(len(terms))).off(terms) ** 2)))


@pytest.mark.parametrize("seed", range(6))
def test_what_two_cameras_see_of_points_at_one_instant_meets_their_relation(seed: int) -> None:
    assert missed(seed) < 0.025


@pytest.mark.parametrize("seed", range(6))
def test_points_that_moved_in_one_view_miss_it(seed: int) -> None:
    assert missed(seed, 0.05) > 1.2 * missed(seed)


def test_points_without_weight_do_not_count() -> None:
    one, other = seen(0)
    wrong = other.copy()
    wrong[::4] += 0.3
    weights = np.where(np.arange(len(one)) % 4, 1.0, 0.0)
    found = relation_of(terms_of(one, wrong), weights)
    alike = relation_of(terms_of(one, wrong), np.ones(len(one)))
    off, off_alike = (np.abs(each.off(terms_of(one, other))).mean() for each in (found, alike))
    assert off < 0.5 * off_alike


def test_a_line_in_one_view_explains_nothing_of_the_other() -> None:
    """Arms and legs in a line, as a profile shows them: all places across it are one."""
    rng = np.random.default_rng(1)
    line, anywhere = rng.normal(0.0, 0.3, (2, 200, 2))
    line[:, 0] = 0.0
    terms = terms_of(line, anywhere)
    assert np.abs(relation_of(terms, np.ones(200)).off(terms)).mean() > 0.1
