"""The matching kernel, held against cylinders in perspective and the plain score."""

import time
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from posing import BODY, SIZE, picture, posed, view
from scipy.spatial import ConvexHull

from common.body.body import LIMBS, Vector
from common.body.kinematics import ALL_LIMBS, FRAME, limb_frames, segments
from common.raster.bits import count, pack_words, unpack_words
from common.raster.kernel import (
    DEPTH,
    VIEW,
    draw_body,
    draw_limbs,
    limb_primitive,
    match,
    match_over,
    score,
    seen_at,
    view_of,
    warm,
)
from common.raster.row_spans import PRIMITIVE
from common.raster.similarity import Mask, similarity
from common.rig.camera import Camera, paper_rig, project


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


LEANING: Final = Camera(
    name="leaning",
    K=((150.0, 0.0, 70.0), (0.0, 230.0, 50.0), (0.0, 0.0, 1.0)),
    R=((0.8, 0.36, 0.48), (-0.6, 0.48, 0.64), (0.0, -0.8, 0.6)),
    t=(0.1, -0.7, 3.9),
)
"""Neither its focal lengths nor its axes are alike: what is exchanged shows."""


def ellipse(out: Vector, at: int) -> tuple[Vector, Vector]:
    """Middle (px) and the square of the half axes (px^2) of the end that a primitive has at 0 or 3.

    By its definition: x' = shear y + stretch x of a disc.
    """
    shape = out[at + 2] * np.array([[out[7], out[6]], [0.0, 1.0]])
    middle = np.array([out[7] * out[at] + out[6] * out[at + 1], out[at + 1]])
    return middle, shape @ shape.T


@pytest.mark.parametrize("limb", [0, 1, 3, 6, 9], ids=lambda limb: LIMBS[limb])
@pytest.mark.parametrize("depth_m", [0.0, 3.3])
def test_a_limbs_ends_are_the_ellipses_of_its_ends_in_the_world(limb: int, depth_m: float) -> None:
    """P5, T19: to nine digits, by matrices; each end seen at its own depth, or all at one."""
    body = BODY * 1.75
    pose = posed(torso_x=12.0, torso_y=25.0, torso_z=8.0, r_shoulder_z=70.0, l_hip_x=20.0)
    pose[:3] = 0.2, 0.9, 0.3
    frame = limb_frames(body, pose)[limb]
    turn = frame[3:].reshape(3, 3)
    radii_m = body[[3 * limb, 3 * limb + 1] if limb < 6 else [18 + 2 * (limb - 6)] * 2]
    out = np.empty(PRIMITIVE)
    assert limb_primitive(limb_frames(body, pose), body, limb, view_of(LEANING, depth_m), out)
    R, t, K = np.array(LEANING.R), np.array(LEANING.t), np.array(LEANING.K)
    for at, end in zip((0, 3), segments(body, pose)[limb], strict=True):
        seen = R @ end + t
        far_m = depth_m or seen[2]
        middle, square = ellipse(out, at)
        assert middle == pytest.approx((K @ [*seen[:2] / far_m, 1.0])[:2])
        across = K[:2, :2] @ (R @ turn)[:2][:, [0, 2]] * radii_m / far_m
        round_px = (radii_m[0] * K[0, 0] / far_m) ** 2 * np.eye(2)
        assert square == pytest.approx(across @ across.T if limb < 6 else round_px, rel=1e-9)


def test_a_place_is_seen_where_the_camera_projects_it_and_no_nearer_than_five_centimetres() -> None:
    place_m = np.array([0.4, 1.1, -0.6])
    u, v, depth_m = seen_at(view_of(LEANING), *place_m)
    assert (u, v) == pytest.approx(project(LEANING, place_m[None])[0])
    seen = np.array(LEANING.R) @ place_m + LEANING.t
    assert depth_m == pytest.approx(seen[2])
    away_m = -3.88 * np.array(LEANING.R)[2]  # 2 cm before the camera
    across_m, down_m, _ = np.array(LEANING.R) @ away_m + LEANING.t
    u, v, depth_m = seen_at(view_of(LEANING), *away_m)
    assert depth_m == pytest.approx(0.02)
    assert (u, v) == pytest.approx((70 + 150 * across_m / 0.05, 50 + 230 * down_m / 0.05))


@pytest.mark.parametrize(("low_m", "is_drawn"), [(0.06, True), (0.04, False), (-0.3, False)])
@pytest.mark.parametrize("lying", [1.0, -1.0])
def test_a_limb_is_drawn_where_both_its_ends_are_five_centimetres_before_the_camera(
    low_m: float, is_drawn: bool, lying: float
) -> None:
    """The camera looks along the trunk, from below or from above; scaled orthography sees all."""
    body, pose = BODY * 1.75, posed()
    frames = limb_frames(body, pose)
    heights = sorted(lying * end[1] for end in segments(body, pose)[0])
    view = np.zeros(VIEW)
    view[[0, 5]], view[7], view[11] = 1.0, lying, low_m - heights[0]
    view[12:16] = 100.0, 100.0, 80.0, 60.0
    assert limb_primitive(frames, body, 0, view, np.empty(PRIMITIVE)) == is_drawn
    view[DEPTH] = 2.0
    assert limb_primitive(frames, body, 0, view, np.empty(PRIMITIVE))


@pytest.mark.parametrize(
    "turn", [np.eye(3), [[0, 1, 0], [1, 0, 0], [0, 0, -1]]], ids=["up", "across"]
)
def test_a_section_that_is_seen_from_its_edge_is_a_thousandth_as_thick_as_long(
    turn: Vector,
) -> None:
    """Of a limb that stands, or lies across the picture, whose depth points to the camera."""
    frames, body, view = np.zeros((10, FRAME)), BODY * 1.75, np.zeros(VIEW)
    frames[0, 3:12] = np.ravel(turn)
    view[[0, 4, 8]], view[11], view[12:14] = 1.0, 4.0, 200.0
    out = np.empty(PRIMITIVE)
    assert limb_primitive(frames, body, 0, view, out)
    thin, long = sorted(np.sqrt(np.diag(ellipse(out, 0)[1])))
    assert long == pytest.approx(50.0 * body[0], rel=1e-5)
    assert thin == pytest.approx(1e-3 * long, rel=1e-3)


def test_the_kernel_says_how_long_it_took_to_be_ready() -> None:
    began_s = time.perf_counter()
    took_s = warm()
    assert 0.0 < took_s <= time.perf_counter() - began_s


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
