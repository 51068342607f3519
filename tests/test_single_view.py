"""One view lifted into the room, held against drawn bodies and the user's word (T19 to T22)."""

from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMBS, POSE_INDEX, rest_pose
from common.body.kinematics import joints
from common.body.observation import Box, Fit, Landmarks, Observation
from common.body.proportions import THESIS_RATIOS, body_vector, thesis_bdp
from common.body.stick_body import (
    ADULT,
    ANGLE,
    SHOULDERS_BELOW,
    THESIS,
    Stickman,
    joints_px,
    standing,
)
from common.bus.messages import Lifting
from common.method import DEFAULT, METHODS
from common.notes.notes import Orientation
from common.raster.silhouette_report import pack
from common.rig.camera import as_matrix, centre, paper_rig, project
from integrator.landmarks import joint_marks, landmark_fusion
from integrator.proposal import pose_proposal
from integrator.single import (
    bent_limbs,
    calm_depth,
    depth_signs,
    lifted_stick,
    lone_proposal,
    reflection,
    single_view,
)
from integrator.single.reflection import Front
from integrator.single.sight import Annotations, Hypothesis, Sight, posed
from integrator.single.stick_similarity import stick_similarity

WIDTH, HEIGHT, TALL_PX = 160, 120, 80.0
RIG = paper_rig((WIDTH, HEIGHT), (200.0, 200.0), (4.375, 4.375))
CAMERA = RIG.cameras[0]
"""Somebody of 1.75 m is 80 pixels tall before it."""
Numbers = NDArray[np.float64]
AT = {name: i for i, name in enumerate(JOINT_NAMES)}


def sight_of(
    person: Observation, printed: bool = True, said: Annotations = Annotations(), n: int = 1
) -> Sight:
    """What one view shows, held against somebody of 1.75 m."""
    man, method = (THESIS, METHODS["thesis"]) if printed else (ADULT, DEFAULT)
    return Sight(method, n - 1, RIG, person, man, thesis_bdp(1.75), None, 0.0, said, n)


def seen_as(man: Stickman, arm_deg: float = 270.0) -> Observation:
    """A stick body that stands, its arm at the picture's left at an angle, in its own box."""
    pose = standing(80.0, 65.0, TALL_PX)
    pose[ANGLE + 6] = pose[ANGLE + 8] = arm_deg
    mask = np.zeros((HEIGHT, WIDTH), np.bool_)
    mask[25:105, 70:90] = True
    places = tuple((float(x), float(y)) for x, y in joints_px(man, pose))
    fit = Fit(
        joints_px=places,
        ratios=(1.0,) * 10,
        breadth=1.0,
        stature_px=TALL_PX,
        hidden=(False,) * 10,
        score=0.8,
        matches=1,
    )
    return Observation(
        width=WIDTH,
        height=HEIGHT,
        silhouette=pack(mask),
        box=Box(left=70, right=89, top=25, bottom=104),
        area_px=80 * 20,
        stick=fit,
    )


def settled(
    person: Observation, said: Annotations = Annotations(), printed: bool = True
) -> Hypothesis:
    sight = sight_of(person, printed, said)
    return single_view.step(None, single_view.begun(sight, None), sight).body


def test_a_body_in_the_picture_plane_keeps_the_printed_lengths() -> None:
    """T19, T20: what is parallel to the picture is as long as table 3.1 says."""
    joints = settled(seen_as(THESIS, 225.0)).joints_m
    unit = 1.75 / THESIS_RATIOS["stature"]
    for near, far, part in (
        ("r_shoulder", "r_elbow", "upper_arm"),
        ("r_elbow", "r_wrist", "lower_arm"),
        ("l_hip", "l_knee", "upper_leg"),
        ("l_knee", "l_ankle", "lower_leg"),
    ):
        length = np.linalg.norm(joints[AT[far]] - joints[AT[near]])
        assert length == pytest.approx(unit * THESIS_RATIOS[part], rel=0.01)


def test_the_lifted_body_is_seen_where_the_stick_was() -> None:
    person, said = seen_as(ADULT, 200.0), Annotations(orientation="forward_right")
    _, lifted = lifted_stick.step(depth_signs.init(), sight_of(person, False, said))
    assert person.stick is not None
    assert project(CAMERA, lifted.joints_m) == pytest.approx(np.array(person.stick.joints_px))


def test_who_is_told_to_face_away_has_the_sides_swapped() -> None:
    """T10, T22: left and right of the picture become those of the body by its orientation."""
    person = seen_as(THESIS, 180.0)
    front = settled(person, Annotations(orientation="forward_left")).joints_m
    back = settled(person, Annotations(orientation="backward_left")).joints_m
    assert front[AT["r_wrist"], 0] == pytest.approx(back[AT["l_wrist"], 0])
    assert front[AT["l_shoulder"], 0] > 0 > back[AT["l_shoulder"], 0]


@pytest.mark.parametrize("printed", [True, False], ids=["thesis", "default"])
def test_a_joint_is_where_the_user_puts_it(printed: bool) -> None:
    """T26: a hidden joint is pointed at."""
    told = Annotations(joints_px={"r_wrist": (40.0, 30.0)})
    body = settled(seen_as(THESIS if printed else ADULT), told, printed)
    placed = project(CAMERA, body.joints_m)[AT["r_wrist"]]
    assert placed == pytest.approx((40.0, 30.0), abs=0.5)


def test_a_segment_leans_as_the_user_says() -> None:
    """T21: half a length in the picture is 60 degrees out of it, to the side that is told."""
    person = seen_as(THESIS, 180.0)
    assert person.stick is not None
    places = list(person.stick.joints_px)
    shoulder, elbow = places[AT["r_shoulder"]], places[AT["r_elbow"]]
    middle = ((shoulder[0] + elbow[0]) / 2, elbow[1])
    places[AT["r_elbow"]] = middle
    fit = msgspec.structs.replace(person.stick, joints_px=tuple(places))
    person = msgspec.structs.replace(person, stick=fit)
    for way, sign in (("toward", 1.0), ("away", -1.0)):
        joints = settled(person, Annotations(depth={"r_upper_arm": way})).joints_m
        lean = joints[AT["r_elbow"], 2] - joints[AT["r_shoulder"], 2]
        expected = sign * np.sin(np.radians(60)) * 1.75 * THESIS_RATIOS["upper_arm"] / 175
        assert lean == pytest.approx(expected, rel=0.02)


def test_what_a_pixel_does_to_a_limbs_angle_is_told() -> None:
    """T19: an upper arm of 11.4 px in the plane, one shorter, is 24 degrees out of it."""
    own = settled(seen_as(THESIS)).lifting
    length_px = THESIS_RATIOS["upper_arm"] / THESIS_RATIOS["stature"] * TALL_PX
    error_deg = np.degrees(np.arccos(1.0 - 1.0 / length_px))
    assert own.depth_error_deg[LIMBS.index("l_upper_arm")] == pytest.approx(error_deg, rel=0.02)


@pytest.mark.parametrize("away", [0.02, 0.98])
def test_whom_one_camera_had_before_it_the_opposite_one_has_from_behind(away: float) -> None:
    """They leave view 1 and are in view 2: front and back are the other way round there."""
    opposite = msgspec.structs.replace(CAMERA, R=as_matrix(np.array(CAMERA.R) * [[-1], [1], [-1]]))
    rig = msgspec.structs.replace(RIG, cameras=(CAMERA, opposite))
    pose = rest_pose()
    pose[POSE_INDEX["torso_y"]] = 180.0 if away > 0.5 else 0.0
    had = joints(body_vector(thesis_bdp(1.75)), pose)
    person = seen_as(ADULT)
    one = single_view.begun(sight_of(person)._replace(rig=rig), None)._replace(front=Front(away))
    other = single_view.begun(sight_of(person, n=2)._replace(rig=rig), had, one)
    assert other.front is not None
    assert other.front.away == pytest.approx(1.0 - away)


def test_a_view_left_alone_knows_which_way_both_had_the_body() -> None:
    """T22: what segments pointed where goes on from the last instant that both views saw."""
    sight = sight_of(seen_as(ADULT), printed=False)
    front = settled(seen_as(THESIS)).joints_m
    back = reflection.seen_from_behind(CAMERA, front)
    for joints_m, towards in ((front, "forward"), (back, "backward")):
        known = single_view.begun(sight, joints_m)
        assert known.front is None
        assert known.signs.bearing.orientation.startswith(towards)
    assert single_view.begun(sight, None).front == Front()


def test_limits_turn_a_limb_in_depth_and_leave_the_picture_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A knee that bends to the front is no knee; where its ankle is seen, it is."""
    turned = rest_pose()
    turned[POSE_INDEX["torso_y"]], turned[POSE_INDEX["l_knee_x"]] = 40.0, 50.0
    astray_m = joints(body_vector(thesis_bdp(1.75)), turned)
    monkeypatch.setattr(bent_limbs, "bent", lambda sight, joints_m: astray_m)
    sight = sight_of(seen_as(ADULT), printed=False)
    found = lone_proposal.step(lone_proposal.Before(None, None, None, None), sight).found
    assert found.pose[POSE_INDEX["l_knee_x"]] <= 0.0
    assert project(CAMERA, found.joints_m) == pytest.approx(project(CAMERA, astray_m))
    moved_m = np.linalg.norm(found.joints_m - astray_m, axis=1)
    assert moved_m[AT["l_ankle"]] > 0.1 > moved_m[AT["r_ankle"]]


def test_a_body_that_trembles_along_the_line_of_sight_is_kept_where_it_was(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The picture shows no motion: 12 mm to and fro are noise, in the joints that are published."""
    pose = rest_pose()
    pose[POSE_INDEX["y"]] = 0.9
    still_m = joints(body_vector(thesis_bdp(1.75)), pose)
    sight = sight_of(msgspec.structs.replace(seen_as(ADULT), stick=None), printed=False)
    off_m = still_m - centre(CAMERA)
    memory, alone, found = None, single_view.begun(sight, None), []
    for n in range(40):
        seen_m = still_m + (-1) ** n * 0.006 * off_m / np.linalg.norm(off_m, axis=1, keepdims=True)
        monkeypatch.setattr(
            lone_proposal, "_with_landmarks", lambda *_, seen_m=seen_m: (seen_m, np.ones(15), None)
        )
        body, memory, alone, _ = single_view.step(memory, alone, sight._replace(dt_s=1 / 15))
        found.append(np.linalg.norm(body.joints_m - centre(CAMERA), axis=1))
    assert np.abs(np.diff(found[20:], axis=0)).max() < 0.003
    assert found[-1] == pytest.approx(np.linalg.norm(off_m, axis=1), abs=0.004)


def test_a_stick_body_is_asked_for_where_what_is_proposed_fits_badly() -> None:
    """A box is no person: the next person shall bring a stick body."""
    person = msgspec.structs.replace(seen_as(ADULT), stick=None)
    sight = sight_of(person, printed=False)
    found = single_view.step(None, single_view.begun(sight, None), sight)
    assert found.body.score < single_view.GOOD
    assert found.alone.stick


def test_the_only_camera_of_a_rig_is_its_first_whatever_its_number() -> None:
    """Proposals are looked for in the axes of camera 1: one that stands nowhere gives none."""
    person, alone = seen_as(ADULT), msgspec.structs.replace(RIG, cameras=(CAMERA, CAMERA))
    for number, rig, seen in (
        (1, RIG, (person, None)),
        (2, RIG, (None, person)),
        (1, alone, (person, None)),
        (2, alone, (person, None)),
    ):
        assert sight_of(person, n=number)._replace(rig=rig).seen == seen


def a_body(score: float) -> Hypothesis:
    """Somebody who stands, of a score and half of it as the confidence in their orientation."""
    pose = rest_pose()
    pose[POSE_INDEX["y"]] = 0.9
    joints_m = np.asarray(joints(body_vector(thesis_bdp(1.75)), pose))
    return Hypothesis(joints_m, pose, score, np.ones(15), Lifting("left", score / 2, ()))


@pytest.mark.parametrize(
    ("proposed", "agrees", "lifted", "farther_px", "is_lifted", "asks"),
    [
        (0.70, True, 0.99, 0.0, False, False),
        (0.69, True, 0.80, 0.0, True, True),
        (0.60, True, 0.6899, 0.0, False, True),
        (0.60, True, 0.6901, 0.0, True, True),
        (0.60, True, 0.80, 3.0, False, True),
        (0.60, True, 0.80, -3.0, True, True),
        (0.90, False, 0.10, 3.0, True, True),
    ],
    ids=["good", "not good", "no better", "better", "but farther", "and nearer", "named otherwise"],
)
def test_a_lifted_body_goes_before_a_proposed_one_that_fits_badly(
    monkeypatch: pytest.MonkeyPatch,
    proposed: float,
    agrees: bool,
    lifted: float,
    farther_px: float,
    is_lifted: bool,
    asks: bool,
) -> None:
    """By S and a margin of 0.15, where it is no farther from the landmarks."""
    person = seen_as(ADULT)
    sight = sight_of(person, printed=False)
    one = a_body(proposed)
    shown_px = project(CAMERA, one.joints_m) + np.array([5.0, 0.0])
    shown = Landmarks(tuple((x, y) for x, y in shown_px.tolist()), (0.5, 0.9, *(0.7,) * 13))
    sight = sight._replace(person=msgspec.structs.replace(person, landmarks=shown))
    two = a_body(lifted)._replace(joints_m=one.joints_m - [farther_px / 200.0 * 4.375, 0.0, 0.0])
    signs = depth_signs.init()._replace(turning=np.full((10, 3), 7.0))
    depth = calm_depth.step(None, centre(CAMERA), one.joints_m, 0.1)[0]
    seen = lone_proposal.Proposed(one, agrees, None, Front(0.2), None, depth, None)  # type: ignore[arg-type]
    monkeypatch.setattr(lone_proposal, "step", lambda before, given: seen)
    monkeypatch.setattr(lifted_stick, "step", lambda memory, given: (signs, two))
    found = single_view.step(None, single_view.begun(sight, None), sight)
    best = two if is_lifted else one
    assert found.body is best
    assert (found.alone.score, found.alone.lifting) == (best.score, best.lifting)
    assert found.alone.stick == asks
    assert found.alone.front == Front(0.2)
    assert found.alone.depth is depth
    if asks:
        assert found.alone.signs is signs
    else:
        assert found.alone.signs.bearing.confidence == proposed / 2
        assert found.alone.signs.bearing.orientation == reflection.faces(
            reflection.yaw_deg(CAMERA, one.joints_m)
        )


def test_how_far_a_body_is_from_what_is_shown_is_weighed_by_how_sure_that_is() -> None:
    """Worked by hand: 4 px at the sure joints, 10 at one that is less sure."""
    sight = sight_of(seen_as(ADULT), printed=False)
    body = a_body(0.5)
    assert single_view._off_px(sight, body) == 0.0
    shown_px = project(CAMERA, body.joints_m)
    shown_px += [2.4, -3.2]
    shown_px[4] += [3.6, -4.8]
    sure = (1.0,) * 4 + (0.2,) + (0.0,) * 10
    shown = Landmarks(tuple((x, y) for x, y in shown_px.tolist()), sure)
    person = msgspec.structs.replace(sight.person, landmarks=shown)
    off_px = single_view._off_px(sight._replace(person=person), body)
    assert off_px == pytest.approx((4 * 4.0 + 0.2 * 10.0) / 4.2)


def test_what_a_view_begins_with_is_nothing_or_what_was_known_before_it() -> None:
    sight = sight_of(seen_as(ADULT), printed=False, n=2)
    fresh = single_view.begun(sight, None)
    assert fresh == single_view.Alone(
        2, 0.0, Lifting("", 1.0, ()), Front(), fresh.signs, None, stick=False
    )
    assert fresh.signs.directions is None
    joints_m = joints(body_vector(thesis_bdp(1.75)), rest_pose())
    known = single_view.begun(sight, joints_m)
    camera = RIG.cameras[1]
    own_m = (joints_m - centre(camera)) @ np.array(camera.R).T * [1.0, -1.0, -1.0]
    assert known.signs.directions == pytest.approx(depth_signs.directions_of(own_m))
    assert known.signs.bearing.confidence == 1.0
    assert (known.front, known.landmarks, known.lifting) == (None, None, Lifting("", 1.0, ()))
    remembered = object()
    other = fresh._replace(front=None, landmarks=remembered)  # type: ignore[arg-type]
    given = single_view.begun(sight, joints_m, other)
    assert (given.front, given.landmarks) == (None, remembered)


@pytest.mark.parametrize(
    ("reflects", "known", "lies", "behind", "named", "done_m"),
    [
        (True, True, False, True, None, 1100.0),
        (True, True, False, False, None, 1000.0),
        (True, True, False, True, "left", 100.0),
        (True, True, False, False, "left", 0.0),
        (True, False, False, True, None, 0.0),
        (False, True, False, True, None, 0.0),
        (True, True, True, True, None, 0.0),
    ],
    ids=["behind", "front", "named behind", "named", "both knew", "no reflection", "lies"],
)
def test_a_proposal_is_turned_about_and_shown_otherwise_where_front_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
    reflects: bool,
    known: bool,
    lies: bool,
    behind: bool,
    named: Orientation | None,
    done_m: float,
) -> None:
    """The user's word is not held against what the picture shows."""
    asked: list[tuple[object, ...]] = []

    def front_of(*given: object) -> tuple[Front, bool]:
        asked.append(given)
        return Front(0.3), behind

    def with_landmarks(before: object, sight: Sight, joints_m: Numbers, sure: object) -> object:
        raised.append(joints_m)
        return joints_m, np.ones(15), None

    raised: list[Numbers] = []
    proposed = a_body(0.5).joints_m
    found = pose_proposal.PoseProposal(
        proposed[pose_proposal.AT],
        np.ones(15),
        pose_proposal.Memory(None, None, 0.0),
    )
    up_m = np.array([0.0, 1.0, 0.0])
    monkeypatch.setattr(pose_proposal, "step", lambda *_, at_once: found)
    monkeypatch.setattr(pose_proposal, "up_of", lambda *_: up_m if lies else None)
    monkeypatch.setattr(reflection, "front_of", front_of)
    monkeypatch.setattr(reflection, "seen_from_behind", lambda _, joints_m: joints_m + 100.0 * up_m)
    monkeypatch.setattr(reflection, "as_shown", lambda _, joints_m, shown: joints_m + 1000.0 * up_m)
    monkeypatch.setattr(lone_proposal, "_with_landmarks", with_landmarks)
    sight = sight_of(seen_as(ADULT), False, Annotations(orientation=named))
    sight = sight._replace(
        method=msgspec.structs.replace(sight.method, reflection=reflects), dt_s=0.2
    )
    front = Front(0.4) if known else None
    told = lone_proposal.step(lone_proposal.Before(None, front, None, None), sight)
    assert raised[0][0, 1] - proposed[0, 1] == pytest.approx(done_m)
    is_asked = reflects and known and not lies
    assert told.front == (Front(0.3) if is_asked else front)
    if is_asked:
        before, yaw, shown, word, dt_s = asked[0]
        assert (before, shown, word, dt_s) == (front, None, named, 0.2)
        assert yaw == pytest.approx(reflection.yaw_deg(CAMERA, proposed), abs=0.1)
    else:
        assert not asked


@pytest.mark.parametrize("knows_front", [True, False])
def test_what_the_picture_shows_is_joined_with_a_proposal_that_is_sure_in_the_picture(
    monkeypatch: pytest.MonkeyPatch, knows_front: bool
) -> None:
    """A joint that is 0.2 sure is so in depth; in the picture it is the cube root of that."""
    asked: list[Any] = []
    body = a_body(0.5)
    fused_m = body.joints_m[pose_proposal.AT] + [0.01, 0.0, 0.02]
    sure = np.linspace(0.3, 0.9, 12)

    def joined(*given: Any) -> Any:
        asked.append(given)
        return SimpleNamespace(joints_m=fused_m, confidence=sure, memory="remembered")

    monkeypatch.setattr(landmark_fusion, "step", joined)
    shown_px = project(CAMERA, body.joints_m).tolist()
    shown = Landmarks(tuple((x, y) for x, y in shown_px), (0.9,) * 15, 20.0, 0.95)
    person = msgspec.structs.replace(seen_as(ADULT), landmarks=shown)
    sight = sight_of(person, printed=False)
    own_m = body.joints_m[pose_proposal.AT]
    remembered: Any = SimpleNamespace(joints_m=own_m)
    before = lone_proposal.Before(None, Front() if knows_front else None, remembered, None)
    confidence = np.linspace(0.2, 0.8, 15)
    joints_m, found, memory = lone_proposal._with_landmarks(
        before, sight, body.joints_m, confidence
    )
    kept, proposed_m, beside, rays, stature_m = asked[0]
    own = confidence[pose_proposal.AT]
    assert kept == remembered
    assert memory == joined().memory
    inside_m = 1.75 * joint_marks.bent(own_m, *joint_marks.PROPOSED_INSIDE)
    assert proposed_m == pytest.approx(own_m - inside_m)
    assert beside == pytest.approx(own ** (1 / 3))
    assert stature_m == pytest.approx(1.75)
    assert rays.facing_confidence == ((0.0, 0.0) if knows_front else (0.95, 0.0))
    assert rays.confidence[0].max() == 0.9
    assert not rays.confidence[1].any()
    assert found[pose_proposal.AT] == pytest.approx(sure * own ** (2 / 3))
    assert joints_m[pose_proposal.AT] == pytest.approx(fused_m)
    nothing = sight_of(seen_as(ADULT), printed=False)
    same_m, same, memory = lone_proposal._with_landmarks(before, nothing, body.joints_m, confidence)
    assert same_m is body.joints_m
    assert same is confidence
    assert memory == remembered
    assert len(asked) == 2, "and by this test"


def test_neck_and_crown_are_in_line_with_a_trunk_that_leans() -> None:
    """Worked by hand: from between hips to between shoulders it is (0.3, 0.4, 0) m."""
    sight = sight_of(seen_as(ADULT), printed=False)
    places_m = a_body(0.5).joints_m.copy()
    places_m[AT["l_hip"]], places_m[AT["r_hip"]] = (0.3, 0.8, 0.1), (0.1, 1.0, -0.1)
    places_m[AT["l_shoulder"]], places_m[AT["r_shoulder"]] = (0.7, 1.2, 0.0), (0.3, 1.4, 0.0)
    found = lone_proposal._with_trunk(sight, places_m[pose_proposal.AT])
    assert found[AT["pelvis"]] == pytest.approx([0.2, 0.9, 0.0])
    up, drop_m = np.array([0.6, 0.8, 0.0]), ADULT.lengths[SHOULDERS_BELOW] * 1.75
    assert found[AT["neck"]] == pytest.approx([0.5, 1.3, 0.0] + up * drop_m)
    assert found[AT["head_top"]] == pytest.approx(found[AT["neck"]] + up * 0.155 * 1.75)
    assert found[pose_proposal.AT] == pytest.approx(places_m[pose_proposal.AT])


def test_a_pixel_is_met_at_the_depth_of_a_place() -> None:
    place_m = np.array([0.3, 1.2, 0.5])
    found_m = lone_proposal._at_depth(CAMERA, (30.0, 90.0), place_m)
    forward = np.array(CAMERA.R)[2]
    assert forward @ (found_m - place_m) == pytest.approx(0.0, abs=1e-9)
    assert project(CAMERA, found_m[None])[0] == pytest.approx([30.0, 90.0])


def test_limits_are_kept_where_the_method_has_them_and_the_user_placed_nothing() -> None:
    """A knee that bends to the front; as printed there are no limits in space."""
    turned = rest_pose()
    turned[POSE_INDEX["l_knee_x"]], turned[POSE_INDEX["l_hip_x"]] = 50.0, 20.0
    astray_m = np.asarray(joints(body_vector(thesis_bdp(1.75)), turned))
    person = seen_as(ADULT)
    placed = Annotations(joints_px={"r_wrist": (40.0, 30.0)})
    for printed, said, limits in (
        (False, Annotations(), True),
        (False, placed, False),
        (True, Annotations(), False),
        (True, placed, False),
    ):
        _, found_m = posed(sight_of(person, printed, said), astray_m)
        assert (found_m is astray_m) is not limits


def test_a_lifted_body_is_scored_by_its_fit_as_printed_else_by_its_place_in_the_picture() -> None:
    person = seen_as(ADULT)
    for printed in (True, False):
        sight = sight_of(person, printed)
        _, body = lifted_stick.step(depth_signs.init(), sight)
        own = 0.8 if printed else stick_similarity(sight, body.joints_m)
        assert body.score == own
    assert own != 0.8


def test_a_joint_is_as_sure_as_its_fit_what_it_hangs_on_and_its_sign() -> None:
    """Worked by hand: a hidden left upper arm keeps a quarter, and so its hand; a right shank that
    leans by 20 degrees has its sign's confidence, one that leans by 15 does not."""
    person = seen_as(ADULT)
    assert person.stick is not None
    hidden = tuple(name == "l_upper_arm" for name in LIMBS)
    fit = msgspec.structs.replace(person.stick, hidden=hidden, score=0.8)
    tilt_deg = np.zeros(10)
    tilt_deg[LIMBS.index("r_lower_leg")], tilt_deg[LIMBS.index("l_lower_leg")] = -20.0, 15.0
    tilt_deg[LIMBS.index("head")] = 30.0
    nothing = depth_signs.init()
    choice = depth_signs.Choice(
        np.ones(10), np.linspace(0.5, 0.95, 10), "left", 1.0, nothing.bearing
    )
    lifted: Any = SimpleNamespace(tilt_deg=tilt_deg)
    found = lifted_stick._confidence(fit, lifted, choice)
    expected = np.full(15, 0.8)
    expected[[AT["l_elbow"], AT["l_wrist"]]] = 0.2
    expected[AT["r_ankle"]] *= choice.confidence[LIMBS.index("r_lower_leg")]
    expected[AT["head_top"]] *= choice.confidence[LIMBS.index("head")]
    assert found == pytest.approx(expected)
