"""The figure of sticks at rest: as long as the body's bones."""

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
