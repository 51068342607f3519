"""The matching kernel, held against cylinders in perspective and the plain score."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from posing import BODY, SIZE, picture, posed, view
from scipy.spatial import ConvexHull

from common.body.body import LIMBS, Vector
from common.body.kinematics import ALL_LIMBS, limb_frames, segments
from common.raster.bits import count, pack_words, unpack_words
from common.raster.kernel import (
    draw_body,
    draw_limbs,
    limb_primitive,
    match,
    match_over,
    score,
    view_of,
)
from common.raster.row_spans import PRIMITIVE
from common.raster.similarity import Mask, similarity
from common.rig.camera import paper_rig


@given(st.integers(0, 50), st.integers(0, 50), st.integers(0, 50))
def test_score_of_counts_is_the_similarity_of_masks(both: int, model: int, silhouette: int) -> None:
    """P9."""
    seen, drawn = np.zeros((2, 1, 150), np.bool_)
    seen[0, : both + silhouette] = True
    drawn[0, :both] = drawn[0, both + silhouette : both + silhouette + model] = True
    value = score(both, both + model, both + silhouette)
    assert value == pytest.approx(similarity(seen, drawn), abs=1e-12)


def hull_mask(points_px: Vector, size: tuple[int, int]) -> Mask:
    """Pixels whose centre lies in the convex hull of points."""
    width, height = size
    y, x = np.mgrid[:height, :width] + 0.5
    sides = ConvexHull(points_px).equations
    off = sides[:, 0, None, None] * x + sides[:, 1, None, None] * y + sides[:, 2, None, None]
    return np.asarray((off <= 0).all(axis=0))


@pytest.mark.parametrize("limb", [0, 1, 2, 6], ids=lambda limb: LIMBS[limb])
@pytest.mark.parametrize("turned", [(0, 0, 0), (0, 40, 0), (30, 20, 10)], ids=str)
def test_a_limb_in_perspective_is_the_hull_of_its_projected_surface(
    limb: int, turned: tuple[float, float, float]
) -> None:
    """P5, C1: a cloud of surface points through a pinhole, at 160x120; a row's rounding aside.

    Flat-ended cylinders are drawn as the hull of two discs that carry their end ellipses.
    """
    camera = paper_rig((160, 120), (200.0, 200.0), (4.0, 4.0)).cameras[0]
    names = {"torso_x": turned[0], "torso_y": turned[1], "torso_z": turned[2]}
    pose = posed(**names, r_shoulder_z=130.0)
    pose[:3] = 0.2, 1.0, 0.3
    body = BODY * 1.75
    frame = limb_frames(body, pose)[limb]
    long, short = (body[3 * limb], body[3 * limb + 1]) if limb < 6 else (body[18], body[18])
    ends = segments(body, pose)[limb]
    around = np.linspace(0, 2 * np.pi, 73)
    turn = frame[3:].reshape(3, 3)
    ring = (
        np.cos(around)[:, None] * long * turn[:, 0] + np.sin(around)[:, None] * short * turn[:, 2]
    )
    cloud = np.concatenate([end + ring for end in ends])
    if limb >= 6:  # a round end: a ball
        ball = np.random.default_rng(0).normal(size=(800, 3))
        ball *= long / np.linalg.norm(ball, axis=1, keepdims=True)
        cloud = np.concatenate([end + ball for end in ends])
    seen = cloud @ np.array(camera.R).T + np.array(camera.t)
    true = hull_mask(seen[:, :2] / seen[:, 2:] * 200.0 + [80.0, 60.0], SIZE)
    bits = np.zeros((120, 3), np.uint64)
    draw_limbs(body, pose, view_of(camera), 1 << limb, 160, bits)
    drawn = unpack_words(bits, 160)
    assert (drawn & true).sum() / (drawn | true).sum() > 0.9


def test_a_limb_behind_the_camera_is_not_drawn() -> None:
    camera = paper_rig(SIZE, (200.0, 200.0), (4.0, 4.0)).cameras[0]
    pose = posed()
    pose[2] = 6.0
    out = np.empty(PRIMITIVE)
    assert not limb_primitive(limb_frames(BODY, pose), BODY, 0, view_of(camera), out)
    assert not draw_body(BODY, pose, view_of(camera), SIZE).any()


def test_a_whole_body_is_the_union_of_its_limbs() -> None:
    """P5."""
    pose = posed(r_shoulder_z=120.0, l_hip_z=200.0, torso_y=30.0)
    union = np.zeros((120, 3), np.uint64)
    for limb in range(10):
        draw_limbs(BODY, pose, view(1), 1 << limb, 160, union)
    assert (unpack_words(union, 160) == picture(pose)).all()
    whole = np.zeros_like(union)
    draw_limbs(BODY, pose, view(1), ALL_LIMBS, 160, whole)
    assert (whole == union).all()


def test_a_standing_figure_of_100_px_is_100_px_high_and_its_trunk_as_wide_as_table_3_2_says() -> (
    None
):
    """T5, M18: 40 / 175 of the stature; T4: the head ends at the top. Rounded ends: a pixel."""
    mask = picture(posed(r_shoulder_z=0.0, l_shoulder_z=0.0, r_shoulder_y=90.0))
    waist = picture(posed(r_shoulder_z=20.0, l_shoulder_z=340.0))[50]
    assert abs(int(waist.sum()) - 100 * 40 / 175) <= 1
    rows = np.flatnonzero(mask.any(axis=1))
    assert rows[-1] + 1 == pytest.approx(64 + 56, abs=1)


def test_a_match_is_the_similarity_of_the_drawn_body_over_any_rest() -> None:
    """P9: all limbs over nothing, or two arms over the rest that was drawn before."""
    pose, seen = posed(r_shoulder_z=120.0), picture(posed(r_shoulder_z=100.0, l_hip_z=200.0))
    words, arms = pack_words(seen), 0b1111000000
    rest = np.zeros_like(words)
    draw_limbs(BODY, pose, view(1), ALL_LIMBS & ~arms, SIZE[0], rest)
    before = rest.copy()
    whole = match(BODY, pose, view(1), ALL_LIMBS, SIZE[0], words, count(words))
    over = match_over(rest, BODY, pose, view(1), arms, SIZE[0], words, count(words))
    assert whole == over == pytest.approx(similarity(seen, picture(pose)), abs=1e-12)
    assert (rest == before).all()
