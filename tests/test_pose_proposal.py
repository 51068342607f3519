"""Default mode, held against made-up people whom its network was never taught on.

They have feet and faces of their own: cylinders look the same from behind.
"""

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray
from staging import HEIGHT, RIG, WIDTH, Stage, Told, exact, observation

from common.body.body import JOINT_NAMES, POSE_INDEX, Vector
from common.body.observation import Landmarks
from common.body.proportions import stature
from common.bus.message_codec import decode, encode
from common.config.settings import Settings
from common.raster.similarity import Mask
from integrator.measuring.known_body import Measured
from integrator.person import Following, Waiting
from integrator.proposal import landmark_look, pose_proposal
from integrator.proposal.pose_proposal import (
    AT,
    PLATT,
    probability,
)
from synth.motion.footing import posed
from synth.motion.motions import MOTION, TPOSE, performance
from synth.person.mesh import body_mesh
from synth.person.people import person
from synth.person.skeleton import ANGLES, JOINTS
from synth.picture.silhouette_examples import exact_mask

SOMEBODY = 31
"""Below all who are taught on."""
UNTAUGHT = range(900_100, 900_106)
"""Seeds beyond all that are taught."""
PICK = [JOINTS.index(JOINT_NAMES[i]) for i in AT]
YAW = ANGLES.index("root_yaw")


@pytest.fixture(autouse=True)
def exact_silhouettes(monkeypatch: pytest.MonkeyPatch) -> None:
    exact(monkeypatch)


class Shown(NamedTuple):
    """What somebody did."""

    masks: list[tuple[Mask, Mask]]
    joints_m: Vector
    """(n, 12, 3)"""
    phase: NDArray[np.uint8]


def shown(posture: str, yaw_deg: Vector | None = None, somebody: int = SOMEBODY) -> Shown:
    """A take, perhaps turned about the vertical, frame by frame."""
    someone = person(somebody)
    motion = performance(someone, posture, 5)
    angles, phase = motion.angles_deg[motion.present], motion.phase[motion.present]
    if yaw_deg is not None:
        angles = angles.copy()
        angles[:, YAW] = np.interp(np.linspace(0, 1, len(angles)), *np.asarray(yaw_deg))
    body = posed(someone.measures, angles, np.zeros(2), np.zeros((len(angles), 2)))
    mesh = body_mesh(someone)
    masks = []
    for bones in body.bones:
        first, second = (
            exact_mask(mesh, bones, c, (WIDTH, HEIGHT)).astype(bool) for c in RIG.cameras
        )
        masks.append((first, second))
    return Shown(masks, body.joints_m[:, PICK], phase)


def joints(told: Told) -> Vector:
    return np.asarray(np.array(told.body.joints_m)[AT])


def missed_mm(told: list[Told], truth: Vector) -> Vector:
    """(n, 12)"""
    off = [joints(t) - each for t, each in zip(told, truth, strict=True)]
    return np.asarray(1e3 * np.linalg.norm(off, axis=-1))


def angle(told: Told, name: str) -> float:
    return told.guide.pose[POSE_INDEX[name]]


def default() -> Stage:
    return Stage(settings=Settings(mode="default"))


@pytest.mark.parametrize(
    "posture", ["squat", "kick_right_forward", "raise_left_lateral", "swing_both_backforth"]
)
def test_somebody_new_is_followed(posture: str) -> None:
    did = shown(posture)
    stage = default()
    missed = missed_mm([stage.see(pair) for pair in did.masks], did.joints_m)
    assert missed[:3].mean() < 120  # by prior proportions
    assert missed[did.phase == MOTION].mean() < 60
    assert np.median(missed) < 40


def test_a_pose_is_told_from_the_first_frame_on() -> None:
    """Measuring, by prior proportions; tracking once three frames have made the body (P46)."""
    did, stage = shown("squat"), default()
    told = [stage.see(pair) for pair in did.masks[:8]]
    assert [t.body.status for t in told] == ["measuring"] * 2 + ["tracking"] * 6
    for t in told:
        assert len(t.body.joints_m) == len(t.body.confidence) == 15
        assert decode(encode(t.body), type(t.body)) == t.body
        assert decode(encode(t.guide), type(t.guide)) == t.guide
    assert missed_mm(told, did.joints_m[:8]).mean(axis=1).max() < 150
    assert [t.guide.measured for t in told] == [False] * 2 + [True] * 6
    assert told[-1].guide.bdp is not None
    true_m = person(SOMEBODY).measures["stature_m"]
    assert stature(told[-1].guide.bdp) == pytest.approx(true_m, abs=0.08)


def test_squats_and_lifts_are_told_apart_by_the_hips() -> None:
    """P52-P54: both bend in a squat, one in a kick, none while standing."""
    bent = {}
    for posture in ("squat", "kick_right_forward"):
        did, stage = shown(posture), default()
        told = [stage.see(pair) for pair in did.masks]
        hips = np.array([[angle(t, f"{side}_hip_x") for side in "rl"] for t in told])
        bent[posture] = np.abs(hips[did.phase == MOTION])
        assert np.abs(hips[18]).max() < 15
    assert bent["squat"].min(axis=1).max() > 40
    assert bent["kick_right_forward"][:, 0].max() > 40
    assert bent["kick_right_forward"][:, 1].max() < 25


def test_two_views_resume_with_the_body_that_was_measured() -> None:
    did, stage = shown("squat"), default()
    for pair in did.masks[:20]:
        stage.see(pair)
    still = did.masks[20]
    before = [stage.see(still).body for _ in range(3)][-1]
    alone = [stage.see((still[0], None)).body for _ in range(22)]
    after = [stage.see(still).body for _ in range(3)][-1]
    assert (after.status, after.views) == ("tracking", "both")
    assert {body.status for body in alone} == {"tracking"}
    assert before.bdp is not None
    assert after.bdp is not None
    assert {body.bdp for body in alone} == {before.bdp}
    assert after.bdp.r_upper_leg.height == before.bdp.r_upper_leg.height
    assert np.allclose(after.joints_m, before.joints_m, atol=0.05)


def test_arms_that_point_to_the_only_camera_left_keep_doing_so() -> None:
    """Their outline would be the same if they pointed away: the sign of their depth is kept."""
    did, stage = shown("squat_arms_forward"), default()
    reach_m = did.joints_m[:, [2, 3], 2] - did.joints_m[:, [0, 1], 2]
    lost = int(np.argmax(reach_m.min(axis=1) > 0.2))
    for pair in did.masks[: lost + 2]:
        stage.see(pair)
    alone = [stage.see((first, None)) for first, _ in did.masks[lost + 2 : lost + 14]]
    found = np.array([joints(told) for told in alone])
    kept = found[:, [2, 3], 2] - found[:, [0, 1], 2]
    held = reach_m[lost + 2 : lost + 14] > 0.15
    assert held.sum() > 12
    assert (kept[held] > 0.0).all()


def test_a_turn_to_camera_2_exchanges_facade_and_flank() -> None:
    """P47-P49: exactly one facade at any time; theta_Y^T follows to -90."""
    turn = np.array([[0.0, 0.4, 0.8, 1.0], [0.0, 0.0, -90.0, -90.0]])
    did, stage = shown("walk_in_place", turn), default()
    told = [stage.see(pair) for pair in did.masks]
    assert all(set(t.body.facing) == {"facade", "flank"} for t in told)
    assert told[0].body.facing == ("facade", "flank")
    assert told[-1].body.facing == ("flank", "facade")
    assert told[-1].guide.pose[POSE_INDEX["torso_y"]] == pytest.approx(-90.0, abs=10.0)
    assert sum(a.body.facing != b.body.facing for a, b in pairwise(told)) == 1


def test_without_an_opening_posture_front_and_back_are_told_by_the_feet() -> None:
    """P10, L4: nothing is measured, and nothing is waited for."""
    did = shown("walk_in_place")
    stage, walking = default(), did.phase == MOTION
    told = [stage.see(pair) for pair, use in zip(did.masks, walking, strict=True) if use]
    assert {t.body.status for t in told} == {"tracking"}
    assert not told[-1].guide.measured
    assert missed_mm(told, did.joints_m[walking])[15:].mean() < 100


@pytest.mark.parametrize("silent", [0, 1])
def test_one_viewer_alone_carries_on(silent: int) -> None:
    """Depth is proposed from one silhouette; the other view may come back."""
    did = shown("raise_both_lateral")
    stage, told = default(), []
    for i, pair in enumerate(did.masks):
        lone = (None, pair[1]) if silent == 0 else (pair[0], None)
        told.append(stage.see(lone if 25 <= i < 45 else pair))
    assert {t.body.views for t in told[25:45]} == {"2" if silent == 0 else "1"}
    assert {t.body.status for t in told[25:45]} == {"tracking"}
    missed = missed_mm(told, did.joints_m)
    assert missed[25:45].mean() < 120
    assert missed[48:].mean() < 60
    assert told[-1].body.views == "both"


def test_a_body_that_turns_about_is_followed_by_all_its_joints() -> None:
    """L4: from facing camera 1 through camera 2 to facing away, 180 degrees in two seconds."""
    turn = np.array([[0.0, 0.3, 0.9, 1.0], [0.0, 0.0, -180.0, -180.0]])
    did = shown("raise_right_lateral", turn)
    stage = default()
    told = [stage.see(pair) for pair in did.masks]
    across = np.array([joints(t)[0] - joints(t)[1] for t in told])
    yaw_deg = np.degrees(np.arctan2(-across[:, 2], across[:, 0]))
    true = np.interp(np.linspace(0, 1, len(told)), *turn)
    off = (yaw_deg - true + 180.0) % 360.0 - 180.0
    assert np.mean(np.abs(off) < 45.0) > 0.95


@pytest.mark.slow
def test_what_is_sure_is_near_and_what_is_not_is_less_often() -> None:
    """In free motion, where two outlines leave many an arm open."""
    did, stage = shown("free"), default()
    told = [stage.see(pair) for pair in did.masks]
    near = (missed_mm(told, did.joints_m) < 50).ravel()
    said = np.array([np.array(each.body.confidence)[AT] for each in told]).ravel()
    assert 0.0 <= said.min() <= said.max() <= 1.0
    assert near[said > 0.8].mean() > near[said < 0.5].mean() + 0.2


def test_the_memory_goes_with_the_person() -> None:
    """An empty room forgets the pose; the body that was measured stays."""
    did = shown("squat")
    stage = default()
    for pair in did.masks[: (did.phase == TPOSE).sum() + 10]:
        stage.see(pair)
    assert isinstance(stage.state.person, Following)
    empty = np.zeros((HEIGHT, WIDTH), np.bool_)
    stage.see((empty, empty))
    assert isinstance(stage.state.person, Waiting)
    assert isinstance(stage.state.person.body, Measured)


def test_a_probability_keeps_the_order_and_the_bounds() -> None:
    sure = np.linspace(0.001, 1.0, 200)
    told = probability(sure)
    assert (np.diff(told) > 0).all()
    assert 0.0 < told[0] < 0.01
    assert told[-1] == 1.0
    logit = np.log(told[:-1] / (1 - told[:-1]))
    assert logit == pytest.approx(
        PLATT[0] * np.log(sure[:-1] / (1 - sure[:-1])) + PLATT[1], abs=1e-9
    )


def test_where_landmarks_show_no_one_body_the_network_keeps_what_it_remembers() -> None:
    """No landmarks at all, or views that look apart."""
    kept: Any = "remembered"
    bare = observation(), observation()
    assert pose_proposal._lifted(kept, bare, RIG, 1.75, 0.1) == (kept, None)
    assert pose_proposal._lifted(kept, (None, None), RIG, 1.75, 0.1) == (kept, None)
    places = [(80.0 + n, 60.0 + 2.0 * n) for n in range(15)]
    here, astray = (
        Landmarks(tuple((x + right_px, y) for x, y in places), (0.9,) * 15)
        for right_px in (0.0, 4000.0)
    )
    apart = observation(landmarks=here), observation(landmarks=astray)
    first, second = (landmark_look.shown_of(each) for each in apart)
    assert landmark_look.look((first, second), RIG, 1.75, 0.1) is None
    assert pose_proposal._lifted(kept, apart, RIG, 1.75, 0.1) == (kept, None)
