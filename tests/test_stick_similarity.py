"""S of joints and a silhouette, held against outlines that were drawn of them."""

import numpy as np
import pytest
from posing import posed
from staging import observation
from test_single_view import RIG, sight_of

from common.body.body import JOINT_NAMES, LIMB_ENDS, Vector
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.body.stick_body import ADULT, BREADTH, GIRTH, HALF_SHOULDERS, POSE_SIZE, STATURE
from common.raster.bits import unpack_words
from common.raster.similarity import Mask, similarity
from common.raster.stick_raster import ALL_SEGMENTS, draw_segments
from common.rig.camera import project
from integrator.single.sight import Sight
from integrator.single.stick_similarity import GIRTHS, stick_similarity

AT = {name: i for i, name in enumerate(JOINT_NAMES)}
CAMERA = RIG.cameras[0]


def somebody(yaw_deg: float = 0.0, ahead_m: float = 0.0) -> Vector:
    pose = posed(torso_y=yaw_deg, r_shoulder_z=120.0, l_hip_x=30.0)
    pose[:3] = 0.1, 0.95, ahead_m
    return np.asarray(joints(body_vector(thesis_bdp(1.75)), pose))


def outline(joints_m: Vector, girth: float) -> Mask:
    """Its stick body: as tall as the pelvis' distance says, as broad as the shoulders show."""
    pixels = project(CAMERA, joints_m)
    lines = [(AT["r_shoulder"], AT["l_shoulder"]), (AT["r_hip"], AT["l_hip"])]
    ends = np.array([[*pixels[a], *pixels[b]] for a, b in (*LIMB_ENDS, *lines)])
    deep_m = 4.375 - joints_m[AT["pelvis"], 2]
    tall_px = 200.0 * 1.75 / deep_m
    across_px = float(np.linalg.norm(ends[10, :2] - ends[10, 2:]))
    stick = np.ones(POSE_SIZE)
    stick[[STATURE, GIRTH]] = tall_px, girth
    stick[BREADTH] = min(1.0, across_px / (2 * ADULT.lengths[HALF_SHOULDERS] * tall_px))
    bits = np.zeros((RIG.height, 3), np.uint64)
    draw_segments(ends, stick, ADULT.parts, ADULT.depth, ALL_SEGMENTS, RIG.width, bits)
    return unpack_words(bits, RIG.width)


def sight(mask: Mask) -> Sight:
    return sight_of(observation(mask), printed=False)


@pytest.mark.parametrize("girth", GIRTHS)
@pytest.mark.parametrize("ahead_m", [0.0, 1.5])
@pytest.mark.parametrize("yaw_deg", [0.0, 55.0])
def test_joints_fit_their_own_outline_however_thickly_they_are_clothed(
    girth: float, ahead_m: float, yaw_deg: float
) -> None:
    joints_m = somebody(yaw_deg, ahead_m)
    assert stick_similarity(sight(outline(joints_m, girth)), joints_m) == 1.0


def test_other_joints_fit_as_well_as_the_best_clothed_of_their_outlines_does() -> None:
    mask = outline(somebody(), 1.2)
    for other in (somebody(), somebody(30.0), somebody(0.0, 0.4)):
        best = max(similarity(mask, outline(other, girth)) for girth in GIRTHS)
        assert stick_similarity(sight(mask), other) == pytest.approx(best, abs=1e-9)
    assert best < 0.9
