"""The figure of sticks at rest: as long as the body's bones."""

import msgspec
import numpy as np
import pytest
from moving import random_joints

from animator.exchange.sticks import THICKNESS, sticks_of
from animator.skeleton.bones import rest_origins_m, skeleton_of


def test_a_stick_spans_its_bone_and_no_other() -> None:
    skeleton = skeleton_of(random_joints(7))
    sticks = sticks_of(skeleton)
    assert sticks.faces.max() == len(sticks.places_m) - 1
    assert (sticks.bones[sticks.faces] == sticks.bones[sticks.faces[:, :1]]).all()
    for i, (origin_m, tip_m) in enumerate(
        zip(rest_origins_m(skeleton), skeleton.tips_m, strict=True)
    ):
        length_m = float(np.linalg.norm(tip_m))
        from_origin_m = sticks.places_m[sticks.bones == i] - origin_m
        along_m = from_origin_m @ (tip_m / length_m)
        across_m = np.linalg.norm(from_origin_m - np.outer(along_m, tip_m / length_m), axis=1)
        assert (along_m.min(), along_m.max()) == pytest.approx((0.0, length_m), abs=1e-5)
        assert across_m.max() == pytest.approx(THICKNESS * length_m, rel=1e-3)


def test_a_bone_of_no_length_has_a_stick_of_a_millimetre() -> None:
    skeleton = skeleton_of(random_joints(7))
    tips_m = skeleton.tips_m.copy()
    tips_m[2] = (0.0, 1e-9, 0.0)
    sticks = sticks_of(msgspec.structs.replace(skeleton, tips_m=tips_m))
    own = sticks.places_m[sticks.bones == 2] - rest_origins_m(skeleton)[2]
    spans_m = np.ptp(own.astype(float), axis=0)
    assert spans_m[1] == pytest.approx(1e-3, rel=1e-3)
    assert spans_m[[0, 2]] == pytest.approx([2 * 0.12e-3] * 2, rel=0.06)


def test_faces_of_every_stick_are_those_of_the_first() -> None:
    sticks = sticks_of(skeleton_of(random_joints(7)))
    count = len(np.unique(sticks.bones))
    faces = sticks.faces.reshape(count, -1, 3).astype(int)
    points = len(sticks.places_m) // count
    assert (faces == faces[0] + points * np.arange(count)[:, None, None]).all()
    assert sticks.bones.tolist() == np.repeat(np.arange(count), points).tolist()
