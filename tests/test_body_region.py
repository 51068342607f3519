"""The body's region in a picture, held against the silhouette of a rendered person."""

import numpy as np
import pytest
from test_own_landmarks import acted

from common.body.body import JOINT_NAMES
from common.bus.messages import Landmarks
from viewer.landmarks.body_region import BONES, body_region, bone_region, stature_px


def true_landmarks() -> Landmarks:
    joints_px = acted()[1]
    return Landmarks(tuple((float(x), float(y)) for x, y in joints_px), (1.0,) * 15)


def test_the_stature_is_that_of_the_person() -> None:
    assert stature_px(true_landmarks()) == pytest.approx(acted()[2], rel=0.1)


def test_the_region_is_nearly_the_silhouette_and_a_little_more_holds_it() -> None:
    mask = acted()[0].mask1
    own = body_region(true_landmarks(), mask.shape, 0.0) > 0
    assert (own & mask).sum() / (own | mask).sum() > 0.7
    assert (mask & ~(body_region(true_landmarks(), mask.shape, 0.06) > 0)).mean() < 0.0005


def test_all_bones_together_are_no_more_than_the_region() -> None:
    mask = acted()[0].mask1
    bones = [bone_region(true_landmarks(), mask.shape, n) for n in range(len(BONES))]
    whole = body_region(true_landmarks(), mask.shape, 0.01) > 0
    assert not (np.any(bones, axis=0) & ~whole).any()


def without(*names: str) -> Landmarks:
    """These joints unseen, as keypoint files write them: anywhere, with confidence 0."""
    known, gone = true_landmarks(), [JOINT_NAMES.index(name) for name in names]
    places = [(0.0, 0.0) if n in gone else place for n, place in enumerate(known.joints_px)]
    sure = [0.0 if n in gone else 1.0 for n in range(len(places))]
    return Landmarks(tuple(places), tuple(sure))


def test_what_is_not_seen_makes_nobody_taller_and_is_not_drawn() -> None:
    mask = acted()[0].mask1
    unseen = without("l_ankle", "r_ankle", "l_wrist")
    assert stature_px(unseen) == pytest.approx(stature_px(true_landmarks()), rel=0.15)
    own, whole = (body_region(each, mask.shape, 0.0) > 0 for each in (unseen, true_landmarks()))
    assert own.sum() < whole.sum()
    assert (own & ~whole).mean() < 0.002


def test_of_whom_nothing_long_is_seen_nothing_is_told() -> None:
    assert stature_px(without("pelvis", "l_knee", "r_knee")) == 0.0
