"""The normalised silhouette, held against the shape that it is made of (T9)."""

import numpy as np
import pytest
from stick_posing import STATURE_PX, drawn, larger, stick_pose

from common.body.stick_body import X, Y
from viewer.stick.normalization import NORMAL_SIZE, normalised

ARMS = {"r_upper_arm": 200.0, "r_lower_arm": 200.0}


@pytest.mark.parametrize("times", [1, 2, 4])
def test_the_size_of_the_frame_does_not_matter(times: int) -> None:
    """T9: the same silhouette from a frame of any size."""
    mask = drawn(stick_pose(ARMS))
    one, other = normalised(mask, STATURE_PX), normalised(larger(mask, times), STATURE_PX * times)
    assert other.mask.shape == NORMAL_SIZE[::-1]
    assert np.array_equal(one.mask, other.mask)


def test_area_and_middle_are_kept() -> None:
    mask = drawn(stick_pose(ARMS))
    normal = normalised(mask, STATURE_PX)
    assert normal.mask.sum() == pytest.approx(mask.sum() * normal.scale**2, rel=0.02)
    there = np.array([np.mean(at) + 0.5 for at in np.nonzero(mask)[::-1]])
    here = np.array([np.mean(at) + 0.5 for at in np.nonzero(normal.mask)[::-1]])
    assert here == pytest.approx((there - normal.corner) * normal.scale, abs=0.3)


def test_a_pose_goes_there_and_back() -> None:
    normal, pose = normalised(drawn(stick_pose({})), STATURE_PX), stick_pose({})
    assert normal.outward(normal.inward(pose)) == pytest.approx(pose)
    assert 0 < normal.inward(pose)[X] < NORMAL_SIZE[0]
    assert 0 < normal.inward(pose)[Y] < NORMAL_SIZE[1]


def test_a_body_at_the_edge_of_the_picture_keeps_its_scale() -> None:
    mask = drawn(stick_pose({}))
    edge = mask[:, 150:]
    normal = normalised(edge, STATURE_PX)
    assert normal.mask.sum() == pytest.approx(edge.sum() * normal.scale**2, rel=0.04)
