"""Landmarks without pictures, held against what hides what, and against what they say."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, rest_pose
from common.body.kinematics import joints
from common.body.proportions import body_vector, thesis_bdp
from common.rig.camera import paper_rig, project
from synth.picture.shown_joints import hides, shown_joints

RIG = paper_rig((320, 240), (300.0, 300.0), (4.5, 4.5))
FACADE, FLANK = RIG.cameras
TALL_M = 1.75
AT = {name: i for i, name in enumerate(JOINT_NAMES)}


def standing(n: int = 1) -> NDArray[np.float64]:
    """(n, 15, 3) somebody who faces the first camera."""
    pose = rest_pose()
    pose[1] = 0.95
    return np.tile(joints(body_vector(thesis_bdp(TALL_M)), pose), (n, 1, 1))


def hidden(eye_m: tuple[float, float, float]) -> set[str]:
    (found,) = hides(standing(), np.array(eye_m), TALL_M)
    return {name for name, is_hidden in zip(JOINT_NAMES, found, strict=True) if is_hidden}


def test_from_before_nothing_of_who_stands_is_hidden() -> None:
    assert hidden((0.0, 1.0, 4.5)) == set()


def test_from_the_side_the_other_side_is_hidden() -> None:
    left, right = hidden((-4.5, 1.0, 0.0)), hidden((4.5, 1.0, 0.0))
    left, right = left - {"pelvis"}, right - {"pelvis"}
    assert {name[0] for name in left} | {name[0] for name in right} == {"l", "r"}
    assert {name[2:] for name in left} == {name[2:] for name in right}
    assert not left & right
    assert {"hip", "shoulder", "knee"} <= {name[2:] for name in left}


def test_surer_joints_are_shown_nearer_to_where_they_are() -> None:
    off, sure = [], []
    body_m = standing(60)
    for seed in range(40):
        shown = shown_joints(body_m, FLANK, (320, 240), TALL_M, np.random.default_rng(seed))
        true_px = project(FLANK, body_m[0])
        off.append(np.linalg.norm(shown.joints_px - true_px, axis=2))
        sure.append(shown.confidence)
    off_px, confidence = np.array(off).ravel(), np.array(sure).ravel()
    bounds = [0.0, 0.2, 0.5, 0.8, 0.95, 1.0]
    medians = [
        np.median(off_px[(confidence > low) & (confidence <= high)])
        for low, high in pairwise(bounds)
    ]
    assert medians == sorted(medians, reverse=True)
    assert medians[-1] < 0.02 * 300.0 * TALL_M / 4.5


def test_what_is_outside_the_picture_is_not_sure() -> None:
    shown = shown_joints(standing(30), FACADE, (320, 150), TALL_M, np.random.default_rng(3))
    below = project(FACADE, standing()[0])[:, 1] > 150
    assert below.any()
    assert shown.confidence[:, below].mean() < 0.2 < shown.confidence[:, ~below].mean()


def test_who_faces_a_camera_is_shown_to_face_it() -> None:
    """0 before the facade's, a quarter turn before the flank's; but 6 in 100 are turned about."""
    for camera, due_deg in ((FACADE, 0.0), (FLANK, 90.0)):
        facing = [
            shown_joints(standing(20), camera, (320, 240), TALL_M, np.random.default_rng(seed))
            for seed in range(30)
        ]
        deg = np.median(np.abs([(one.facing_deg + 180.0) % 360.0 - 180.0 for one in facing]))
        assert deg == pytest.approx(due_deg, abs=12.0)


def test_chance_is_the_generators() -> None:
    one, again = (
        shown_joints(standing(9), FACADE, (320, 240), TALL_M, np.random.default_rng(5))
        for _ in range(2)
    )
    assert all(np.array_equal(a, b) for a, b in zip(one, again, strict=True))
