"""Our poses on bodies of the Anny model, held against our own skeleton."""

import numpy as np
import pytest

pytest.importorskip("anny", reason="Anny's people need the extra `train`")

from common.body.body import JOINT_NAMES
from synth.anny_people.anatomy import anatomy
from synth.anny_people.figures import anny_figure
from synth.anny_people.retarget import Retargeted, hung, retargeted
from synth.motion.footing import posed
from synth.person.people import person
from synth.person.skeleton import ANGLES, JOINTS

pytestmark = pytest.mark.slow

LIMBS = [("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle")]
FIGURE = anny_figure(np.random.default_rng(1))
SOMEONE = person(100_001)


def some_angles(n: int) -> np.ndarray:
    angles = np.random.default_rng(2).uniform(-40.0, 70.0, (n, len(ANGLES)))
    bent = ["elbow" in name or "knee" in name for name in ANGLES]
    angles[:, bent] = np.abs(angles[:, bent])
    angles[:, ["foot" in name for name in ANGLES]] = 0.5
    return angles


def in_poses(angles: np.ndarray) -> Retargeted:
    return retargeted(FIGURE, SOMEONE.measures, angles, np.random.default_rng(3))


def way(joints: np.ndarray, start: str, end: str) -> np.ndarray:
    found = joints[:, JOINT_NAMES.index(end)] - joints[:, JOINT_NAMES.index(start)]
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def apart_deg(ours: np.ndarray, theirs: np.ndarray, ends: tuple[str, str]) -> np.ndarray:
    cosine = (way(ours, *ends) * way(theirs, *ends)).sum(axis=1)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def test_limbs_point_where_ours_do() -> None:
    """But for the twist, of which the upper half has a part: a limb's two bones lie not in line."""
    angles = some_angles(30)
    ours = posed(SOMEONE.measures, angles, np.zeros(2)).joints_m
    ours = ours[:, [JOINTS.index(name) for name in JOINT_NAMES]]
    theirs = in_poses(angles).joints_m
    for side in "lr":
        for limb in LIMBS:
            ends = (f"{side}_{limb[0]}", f"{side}_{limb[1]}")
            assert apart_deg(ours, theirs, ends).max() < 2.0, ends
    assert apart_deg(ours, theirs, ("l_hip", "r_hip")).max() < 0.1
    assert apart_deg(ours, theirs, ("l_shoulder", "r_shoulder")).max() < 6.0
    assert np.median(apart_deg(ours, theirs, ("pelvis", "neck"))) < 8.0


def test_standing_they_are_built_as_ours_are() -> None:
    """Joints mean the same: no more apart than people differ, in shares of the stature."""
    straight = np.zeros((1, len(ANGLES)))
    ours, theirs = [], []
    for seed in range(20):
        someone, figure = person(seed), anny_figure(np.random.default_rng(seed))
        own = posed(someone.measures, straight, np.zeros(2)).joints_m[0]
        ours.append((own - own[0])[[JOINTS.index(n) for n in JOINT_NAMES]])
        ours[-1] /= someone.measures["stature_m"]
        found = retargeted(figure, someone.measures, straight, np.random.default_rng(0))
        theirs.append(found.joints_m[0] - found.joints_m[0, 0])
        theirs[-1] /= figure.vertices_m[:, 1].max()
    gap = np.linalg.norm(np.mean(ours, axis=0) - np.mean(theirs, axis=0), axis=1)
    assert gap.max() < 0.03, dict(zip(JOINT_NAMES, gap.round(3), strict=True))


def test_bones_keep_their_lengths() -> None:
    joints = in_poses(some_angles(20)).joints_m
    for side in "lr":
        for start, end in LIMBS:
            ends = [joints[:, JOINT_NAMES.index(f"{side}_{name}")] for name in (start, end)]
            lengths = np.linalg.norm(ends[1] - ends[0], axis=1)
            assert np.ptp(lengths) < 0.01 * lengths.mean()


def test_a_body_whose_bones_do_not_turn_stays_as_it_rests() -> None:
    bones = anatomy().bones
    heads = np.stack([FIGURE.heads_m[name] for name in bones])[None]
    turns = np.tile(np.eye(3), (1, len(bones), 1, 1))
    still = Retargeted(turns, heads, np.empty(0), np.empty(0))
    found = hung(FIGURE.vertices_m, anatomy().weights, FIGURE, still)
    assert np.allclose(found[0], FIGURE.vertices_m, atol=1e-5)


def test_the_skin_goes_with_the_joints() -> None:
    """The vertices about each knee and elbow stay about it in any pose."""
    body = in_poses(some_angles(10))
    places = hung(FIGURE.vertices_m, anatomy().weights, FIGURE, body)
    for name, bone in (("l_knee", "lowerleg01.L"), ("r_elbow", "lowerarm01.R")):
        near = np.linalg.norm(FIGURE.vertices_m - FIGURE.heads_m[bone], axis=1) < 0.06
        middle = places[:, near].mean(axis=1)
        gap = np.linalg.norm(middle - body.joints_m[:, JOINT_NAMES.index(name)], axis=1)
        assert gap.max() < 0.04, name


def test_fingers_of_both_hands_curl_towards_the_palm() -> None:
    """Of hanging arms: inwards, since the palms face the body."""
    straight = np.zeros((24, len(ANGLES)))
    body, bones = in_poses(straight), anatomy().bones
    for side, inwards in (("L", -1.0), ("R", 1.0)):
        tip, knuckle = (
            body.places_m[:, bones.index(f"finger3-{joint}.{side}"), 0] for joint in (3, 1)
        )
        assert np.median(inwards * (tip - knuckle)) > 0.005, side
