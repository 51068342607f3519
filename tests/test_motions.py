"""The motions, held against their names, the floor and the clips of filmed performers."""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from synth.motion.falling import FALLS_S, RISES_S
from synth.motion.footing import posed
from synth.motion.motions import (
    EMPTY,
    LOWERING,
    MOTION,
    POSTURES,
    TPOSE,
    Motion,
    movement,
    performance,
)
from synth.motion.roaming import FREE_RANGES_DEG
from synth.person.people import person
from synth.person.skeleton import ANGLES, JOINTS

AT = {name: i for i, name in enumerate(JOINTS)}
PEOPLE = (0, 1, 4, 7)
BONES_HELD = (
    *((f"{s}_shoulder", f"{s}_elbow") for s in "lr"),
    *((f"{s}_elbow", f"{s}_wrist") for s in "lr"),
    *((f"{s}_wrist", f"{s}_knuckle") for s in "lr"),
    *((f"{s}_hip", f"{s}_knee") for s in "lr"),
    *((f"{s}_knee", f"{s}_ankle") for s in "lr"),
    *((f"{s}_ankle", f"{s}_toe") for s in "lr"),
    *((f"{s}_shoulder", "neck") for s in "lr"),
    ("l_hip", "r_hip"),
    ("pelvis", "navel"),
    ("navel", "neck"),
    ("neck", "head_top"),
)


def moving(seed: int, posture: str, take: int = 1) -> tuple[Motion, NDArray[np.float64]]:
    """A performance, and the joints (n, 20, 3) of its motion."""
    motion = performance(person(seed), posture, take)
    return motion, motion.joints_m[motion.phase == MOTION]


def rise(joints: NDArray[np.float64], name: str) -> float:
    """How far a joint rises above where the motion began, metres."""
    return float((joints[:, AT[name], 1] - joints[0, AT[name], 1]).max())


def test_the_postures_are_those_of_the_design() -> None:
    """Section 3 names them; they fall into the paper's five movements (P56)."""
    assert " ".join(POSTURES) == (
        "walk_in_place walk_sideways walk_toward walk_slow_bigswing raise_right_lateral "
        "raise_left_lateral raise_both_lateral raise_both_forward_up swing_right_circles "
        "swing_both_backforth swing_both_overhead_wave squat squat_arms_forward "
        "kick_right_forward kick_left_side"
    )
    assert {movement(name) for name in POSTURES} == {
        "walking",
        "arm_raising",
        "arm_swing",
        "squatting",
        "kicking",
    }


def test_an_unknown_posture_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ValueError, match=r"unknown posture 'jump'.*walk_in_place"):
        performance(person(0), "jump", 1)


def test_the_same_seeds_give_the_same_motion_and_others_another() -> None:
    first, again = (performance(person(3), "squat", 2) for _ in range(2))
    np.testing.assert_array_equal(first.joints_m, again.joints_m)
    for other in (performance(person(3), "squat", 3), performance(person(5), "squat", 2)):
        assert not np.allclose(first.angles_deg[30:], other.angles_deg[30:], atol=0.5)


def test_a_clip_has_the_phases_of_the_filmed_ones(data_dir: Path) -> None:
    with np.load(next((data_dir / "dev").glob("*/truth.npz"))) as truth:
        np.testing.assert_array_equal(performance(person(0), "squat", 1).phase, truth["phase"])


def test_phases_last_as_long_at_every_frame_rate() -> None:
    counts = np.bincount(performance(person(0), "squat", 1, fps=30.0).phase)
    assert counts.tolist() == [18, 28, 12, 80]


@pytest.mark.parametrize("posture", [*POSTURES, "free", "fall"])
def test_segments_keep_their_lengths(posture: str) -> None:
    for seed in PEOPLE[:2]:
        motion = performance(person(seed), posture, 1)
        joints = motion.joints_m[motion.present]
        for first, second in BONES_HELD:
            lengths = np.linalg.norm(joints[:, AT[first]] - joints[:, AT[second]], axis=1)
            assert np.ptp(lengths) < 1e-9, (first, second)


@pytest.mark.parametrize("seed", PEOPLE)
def test_who_falls_lies_on_the_floor_for_seven_seconds_and_stands_up_again(seed: int) -> None:
    motion, joints = moving(seed, "fall")
    trunk = joints[:, AT["neck"]] - joints[:, AT["pelvis"]]
    lean_deg = np.degrees(np.arccos(trunk[:, 1] / np.linalg.norm(trunk, axis=1)))
    at_s = np.arange(len(joints)) / motion.fps
    lies = (at_s > FALLS_S[1]) & (at_s < RISES_S[0])
    assert np.count_nonzero(lies) == pytest.approx(7.2 * motion.fps, abs=2)
    assert lean_deg[lies].min() > 45.0
    assert joints[lies][:, AT["pelvis"], 1].max() < 0.6
    assert lean_deg[(at_s < FALLS_S[0]) | (at_s > RISES_S[1])].max() < 60.0
    carried = [i for i, name in enumerate(JOINTS) if name[2:] not in ("elbow", "wrist", "knuckle")]
    assert joints[:, carried, 1].min() > -0.01


@pytest.mark.parametrize("posture", [*POSTURES, "free"])
def test_somebody_stands_on_the_floor_and_nothing_is_below_it(posture: str) -> None:
    for seed in PEOPLE:
        motion = performance(person(seed), posture, 1)
        joints = motion.joints_m[motion.present]
        ankle_m = person(seed).measures["ankle_height_m"]
        assert joints[..., 1].min() > -0.01
        if posture != "free":
            lower = joints[:, [AT["l_ankle"], AT["r_ankle"]], 1].min(axis=1)
            assert lower.max() < ankle_m + 0.08


def test_the_standing_foot_rests() -> None:
    """While a walker's one foot is clearly in the air the other one does not slide."""
    for posture in ("walk_toward", "walk_in_place"):
        _, joints = moving(0, posture)
        left, right = joints[:, AT["l_ankle"]], joints[:, AT["r_ankle"]]
        for stood, raised in ((left, right), (right, left)):
            up = raised[:, 1] - stood[:, 1] > 0.04
            both = up[1:] & up[:-1]
            slid = np.linalg.norm(np.diff(stood[:, [0, 2]], axis=0), axis=1)[both]
            assert both.any()
            assert slid.max() < 0.01


@pytest.mark.parametrize("seed", PEOPLE)
def test_the_opening_is_a_t_pose(seed: int) -> None:
    motion = performance(person(seed), "walk_in_place", 1)
    assert np.isnan(motion.joints_m[motion.phase == EMPTY]).all()
    joints = motion.joints_m[motion.phase == TPOSE]
    for side, sign in (("l", 1.0), ("r", -1.0)):
        arm = joints[:, AT[f"{side}_wrist"]] - joints[:, AT[f"{side}_shoulder"]]
        out = sign * arm[:, 0] / np.linalg.norm(arm, axis=1)
        assert out.min() > np.cos(np.radians(15.0))
    hang = motion.angles_deg[motion.phase == LOWERING][-1, ANGLES.index("l_sh_abd")]
    assert hang < 20.0


@pytest.mark.parametrize("seed", PEOPLE)
def test_raising_lifts_the_arms_that_it_names(seed: int) -> None:
    """Sideways, to shoulder height and above; the other arm stays down."""
    arm_m = person(seed).measures["upper_arm_m"] + person(seed).measures["forearm_m"]
    for posture, raised in (
        ("raise_right_lateral", "r"),
        ("raise_left_lateral", "l"),
        ("raise_both_lateral", "lr"),
    ):
        _, joints = moving(seed, posture)
        for side in "lr":
            high = rise(joints, f"{side}_wrist")
            assert high > 0.75 * arm_m if side in raised else high < 0.06
            away = np.ptp(joints[:, AT[f"{side}_wrist"], 2])
            assert away < 0.35
    _, joints = moving(seed, "raise_both_forward_up")
    for side in "lr":
        assert rise(joints, f"{side}_wrist") > 1.5 * arm_m
        forwards = joints[:, AT[f"{side}_wrist"], 2] - joints[:, AT[f"{side}_shoulder"], 2]
        assert forwards.max() > 0.85 * arm_m


@pytest.mark.parametrize("seed", PEOPLE)
def test_swings_go_where_they_should(seed: int) -> None:
    motion, joints = moving(seed, "swing_right_circles")
    turned = np.ptp(motion.angles_deg[motion.phase == MOTION, ANGLES.index("r_sh_flex")])
    assert turned > 1.7 * 360.0
    assert rise(joints, "l_wrist") < 0.1
    _, joints = moving(seed, "swing_both_backforth")
    for side in "lr":
        reach = joints[:, AT[f"{side}_wrist"], 2] - joints[:, AT[f"{side}_shoulder"], 2]
        assert reach.max() > 0.3
        assert reach.min() < -0.1
        assert joints[:, AT[f"{side}_wrist"], 1].max() < joints[0, AT["head_top"], 1]
    _, joints = moving(seed, "swing_both_overhead_wave")
    assert min(rise(joints, "l_wrist"), rise(joints, "r_wrist")) > 0.8
    over = joints[12:-8, [AT["l_wrist"], AT["r_wrist"]], 1].min(axis=1)
    assert (over > joints[12:-8, AT["neck"], 1]).mean() > 0.8


@pytest.mark.parametrize("seed", PEOPLE)
def test_squats_go_down_on_flat_feet(seed: int) -> None:
    stature, ankle_m = (person(seed).measures[n] for n in ("stature_m", "ankle_height_m"))
    arm_m = person(seed).measures["upper_arm_m"] + person(seed).measures["forearm_m"]
    reach = {}
    for posture in ("squat", "squat_arms_forward"):
        _, joints = moving(seed, posture)
        assert -(joints[:, 0, 1] - joints[0, 0, 1]).min() > 0.1 * stature
        feet = joints[:, [AT["l_ankle"], AT["r_ankle"]], 1]
        np.testing.assert_allclose(feet, ankle_m, atol=0.03)
        low = joints[int(joints[:, 0, 1].argmin())]
        reach[posture] = low[AT["r_wrist"], 2] - low[AT["r_shoulder"], 2]
    assert reach["squat"] < 0.75 * arm_m < 0.8 * arm_m < reach["squat_arms_forward"]


@pytest.mark.parametrize("seed", PEOPLE)
def test_kicks_move_the_leg_that_they_name(seed: int) -> None:
    _, joints = moving(seed, "kick_right_forward")
    ankle = joints[:, AT["r_ankle"]] - joints[0, AT["r_ankle"]]
    assert ankle[:, 2].max() > 0.4
    assert rise(joints, "r_ankle") > 0.25
    assert rise(joints, "l_ankle") < 0.03
    _, joints = moving(seed, "kick_left_side")
    ankle = joints[:, AT["l_ankle"]] - joints[0, AT["l_ankle"]]
    assert ankle[:, 0].max() > 0.4
    assert rise(joints, "r_ankle") < 0.03


@pytest.mark.parametrize("seed", PEOPLE)
def test_walks_go_where_they_should(seed: int) -> None:
    travel = {}
    for posture in POSTURES[:4]:
        _, joints = moving(seed, posture)
        travel[posture] = joints[-1, 0] - joints[0, 0]
        assert min(rise(joints, "l_ankle"), rise(joints, "r_ankle")) > 0.015
    assert np.abs(travel["walk_in_place"][[0, 2]]).max() < 0.15
    assert travel["walk_sideways"][0] > 0.3
    assert travel["walk_toward"][2] > 0.8
    assert 0.3 < travel["walk_slow_bigswing"][2] < travel["walk_toward"][2]


@pytest.mark.parametrize("seed", [2, 5, 11])
def test_free_motion_uses_every_joint_and_every_facing(seed: int) -> None:
    """At least 80 % of each joint's range, limbs faster than 300 degrees a second, all round."""
    motion = performance(person(seed), "free", seed)
    angles = motion.angles_deg[motion.phase == MOTION]
    for i, name in enumerate(ANGLES):
        joint = name[2:] if name[1] == "_" else name
        if joint in FREE_RANGES_DEG:
            low, high = FREE_RANGES_DEG[joint]
            assert np.ptp(angles[:, i]) >= 0.8 * (high - low), name
    for name in ("l_sh_flex", "r_sh_flex", "l_knee", "r_knee"):
        assert np.abs(np.diff(angles[:, ANGLES.index(name)])).max() * motion.fps > 300.0
    facing = np.histogram(angles[:, ANGLES.index("root_yaw")] % 360.0, 8, (0.0, 360.0))[0]
    assert facing.min() > 0
    assert np.abs(motion.root_m[motion.present][:, [0, 2]]).max() < 1.0


def test_the_skeleton_turns_filmed_angles_into_filmed_joints(data_dir: Path) -> None:
    """The angles and measures of the development clips give their joints, within the few
    centimetres by which their generator's spine, shoulders and feet differ from ours."""
    for clip in sorted((data_dir / "dev").glob("r0[14]_*_1[1245]_*")):
        measures = json.loads((clip / "meta.json").read_text())["measures"]
        with np.load(clip / "truth.npz") as truth:
            seen = truth["present"]
            filmed = truth["joints3d"][seen].astype(float)
            ours = posed(measures, truth["angles"][seen].astype(float), np.zeros(2)).joints_m
        off = (ours - ours[:, :1]) - (filmed - filmed[:, :1])
        assert np.linalg.norm(off, axis=-1).mean() < 0.04, clip.name
        assert np.linalg.norm(off, axis=-1).max() < 0.13, clip.name
