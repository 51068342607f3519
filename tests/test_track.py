"""One viewer's thinking, held against persons drawn in the paper's rig."""

from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from posing import posed
from staging import (
    NAVEL_M,
    NOBODY,
    PAPER,
    PERSON,
    RIG,
    Stage,
    between,
    changed,
    exact,
    opening,
    person_of,
    silhouettes,
    squatting,
    standing,
)

from common.body.body import ANGLE_NAMES, POSE_INDEX, Vector
from common.body.kinematics import joints
from common.body.observation import Landmarks, Observation, Search
from common.body.proportions import body_vector, stature
from common.bus.message_codec import decode, encode
from common.bus.messages import Guide, View, ViewerNumber
from common.method import DEFAULT, METHODS, Method
from common.raster.silhouette_report import unpack
from common.raster.similarity import Mask
from common.rig.camera import project
from viewer import landmark_step, track
from viewer.background.background import learn
from viewer.captured_frame import CapturedFrame
from viewer.landmarks.person_mask import LandmarkResult
from viewer.paper import pose_search


@pytest.fixture(autouse=True, scope="module")
def exact_silhouettes() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as monkeypatch:
        exact(monkeypatch)
        yield


def viewer(number: ViewerNumber, method: Method = METHODS["paper"]) -> track.State:
    setup = track.Setup(number, RIG.cameras[number - 1], PAPER, method)
    return track.init(setup, None)  # type: ignore[arg-type]


def told_from_outside() -> track.State:
    """Of a viewer whose landmarks another source tells."""
    setup = viewer(1).setup
    method = msgspec.structs.replace(setup.method, landmarks=True)
    outside = msgspec.structs.replace(setup.settings, landmarks="mediapipe")
    return viewer(1)._replace(setup=setup._replace(settings=outside, method=method))


def landmarks_of(pose: Vector) -> Landmarks:
    """Where picture 1 shows the joints of a pose; a source is sure of all."""
    places_px = project(RIG.cameras[0], joints(body_vector(PERSON), pose)).tolist()
    return Landmarks(
        joints_px=tuple((x, y) for x, y in places_px), confidence=(0.9,) * 15, facing_deg=30.0
    )


def frame(mask: Mask, index: int = 0) -> CapturedFrame:
    return CapturedFrame(index, index / 15, index / 15, mask)  # type: ignore[arg-type]


def guide(pose: Vector, **said: object) -> Guide:
    """What an integrator would say that knows the person and the pose."""
    place = pose[:3]
    upright = np.array([place[0], NAVEL_M, place[2]])
    first, second = (project(camera, np.stack([place, upright])) for camera in RIG.cameras)
    scales = (200.0 / (4.0 - float(place[2])), 200.0 / (4.0 + float(place[0])))
    given = {
        "frame": 0,
        "captured_s": 0.0,
        "clock_s": 0.0,
        "frames": (0, 0),
        "status": "tracking",
        "bdp": PERSON,
        "measured": True,
        "scale_px_per_m": scales,
        "root_px": (tuple(first[0]), tuple(second[0])),
        "rest_row_px": (float(first[1, 1]), float(second[1, 1])),
        "pose": tuple(pose.tolist()),
    }
    return Guide(**{**given, **said})  # type: ignore[arg-type]


def looked(number: ViewerNumber, truth: Vector, told: Guide | None) -> Observation:
    _, view = track.step(viewer(number), frame(silhouettes(truth)[number - 1]), told)
    return person_of(view)


def searched(person: Observation) -> Search:
    assert person.search is not None
    return person.search


def landmarks_in(view: View) -> Landmarks | None:
    return None if view.person is None else view.person.landmarks


def test_the_stages_follow_each_other_as_in_the_paper(monkeypatch: pytest.MonkeyPatch) -> None:
    """P23: silhouette, facade or flank, position, arms, legs."""
    called: list[str] = []

    def noted(name: str) -> None:
        inner = getattr(pose_search, name)

        def noting(*given: object) -> object:
            called.append(name)
            return inner(*given)

        monkeypatch.setattr(pose_search, name, noting)

    for name in ("thresholds_px", "located", "facade_arms", "facade_legs"):
        noted(name)
    noted("flank_arms")
    noted("flank_legs")
    looked(1, standing(), guide(standing()))
    assert called == ["thresholds_px", "located", "facade_arms", "facade_legs"]
    called.clear()
    looked(2, standing(), guide(standing()))
    assert called == ["thresholds_px", "located", "flank_arms", "flank_legs"]


@pytest.mark.parametrize(("number", "vote"), [(1, "facade"), (2, "flank")])
def test_viewer_1_begins_as_the_facade_and_viewer_2_as_the_flank(
    number: ViewerNumber, vote: str
) -> None:
    """P47."""
    assert viewer(number).search.vote == vote
    assert looked(number, standing(), None).vote == vote


def test_a_report_tells_the_angles_that_its_view_can_see() -> None:
    """P30, P35, P51: shoulders' theta_X from the flank; theta_Y, theta_Z, elbow from the front."""
    facade = searched(looked(1, standing(), guide(standing()))).angles_deg
    flank = searched(looked(2, standing(), guide(standing()))).angles_deg
    arms = {f"{side}_{name}" for side in "rl" for name in ("shoulder_y", "shoulder_z", "elbow_x")}
    hips_z, bends = {"r_hip_z", "l_hip_z"}, {"r_hip_x", "l_hip_x", "r_knee_x", "l_knee_x"}
    assert set(facade) == arms | hips_z | bends
    assert set(flank) == {"r_shoulder_x", "l_shoulder_x"} | bends
    assert set(facade) | set(flank) <= set(ANGLE_NAMES)


def test_an_empty_silhouette_is_nobody_whatever_it_scores() -> None:
    """M25: no position, no angles, score 0; the next frame is met as usual."""
    state, report = track.step(viewer(1), frame(NOBODY), guide(standing()))
    assert report.people == ()
    _, after = track.step(state, frame(silhouettes(standing())[0], 1), None)
    assert person_of(after).search is not None


def test_a_silhouette_travels_as_it_was_seen() -> None:
    mask = silhouettes(standing())[0]
    assert (unpack(looked(1, standing(), None)) == mask).all()


@pytest.mark.parametrize("number", [1, 2])
def test_a_followed_body_is_found_where_and_how_it_stands(number: ViewerNumber) -> None:
    """P23: from last frame's pose, 5 cm and 10 degrees off."""
    truth = standing((0.1, -0.1), r_shoulder_z=120.0, l_hip_z=190.0)
    before = standing((0.15, -0.05), r_shoulder_z=130.0, l_hip_z=180.0)
    report = looked(number, truth, guide(before))
    true_px = project(RIG.cameras[number - 1], truth[None, :3])[0]
    assert searched(report).root_px == pytest.approx(true_px, abs=2.0)
    assert searched(report).score > 0.8
    if number == 1:
        assert searched(report).angles_deg["r_shoulder_z"] == pytest.approx(120.0, abs=4.0)
        assert searched(report).angles_deg["l_hip_z"] == pytest.approx(190.0, abs=4.0)


@pytest.mark.parametrize("status", [None, "empty", "lost"])
def test_a_body_that_nobody_knows_of_is_found_with_its_arms_wherever_they_are(
    status: str | None,
) -> None:
    """L1: no guide, or one that has lost it: the box places the model, arms are searched widely."""
    truth = standing((0.3, 0.2), r_shoulder_z=60.0, l_shoulder_z=250.0)
    told = None if status is None else guide(posed(), status=status, root_px=((0, 0), (0, 0)))
    report = looked(1, truth, told)
    assert searched(report).angles_deg["r_shoulder_z"] == pytest.approx(60.0, abs=6.0)
    assert searched(report).angles_deg["l_shoulder_z"] == pytest.approx(250.0, abs=6.0)
    true_px = project(RIG.cameras[0], truth[None, :3])[0]
    assert searched(report).root_px == pytest.approx(true_px, abs=4.0)


def test_the_opening_posture_is_measured_until_it_is_known() -> None:
    """P10-P21: BDPs in the front view, depth in the side view, reasons otherwise."""
    front, side = looked(1, opening(), None), looked(2, opening(), None)
    assert front.measure is not None
    assert front.measure.bdp_px is not None
    assert side.measure is not None
    assert side.measure.bdp_px is None
    hanging = looked(1, standing(), None)
    assert hanging.measure is None
    assert "arms" in hanging.refusal
    known = looked(1, opening(), guide(opening()))
    assert (known.measure, known.refusal) == (None, "")


@settings(max_examples=60)
@example([(1, 1, 1, 1)], 2, False)
@given(
    st.lists(st.tuples(*[st.integers(0, n) for n in (119, 159, 119, 159)]), min_size=1, max_size=4),
    st.sampled_from([1, 2]),
    st.booleans(),
)
def test_no_silhouette_however_odd_stops_a_viewer(
    blocks: list[tuple[int, int, int, int]], number: ViewerNumber, known: bool
) -> None:
    """Blocks anywhere, one pixel or the whole picture: a report comes, and it is finite."""
    mask = NOBODY.copy()
    for top, left, bottom, right in blocks:
        mask[min(top, bottom) : max(top, bottom) + 1, min(left, right) : max(left, right) + 1] = (
            True
        )
    told = guide(standing()) if known else None
    _, report = track.step(viewer(number), frame(mask), told)
    assert decode(encode(report), View) == report


def test_a_person_partly_outside_is_not_measured() -> None:
    report = looked(1, opening((1.4, 0.0)), None)
    assert report.cut
    assert report.measure is None
    assert "outside the picture" in report.refusal


def test_a_report_says_which_guide_it_used_and_a_late_one_still_serves() -> None:
    """P2: frame t uses the guide of t - 1; an older one is only farther from the truth."""
    poses = between(standing(), standing(r_shoulder_z=120.0), 6)
    states = {}
    for late in (1, 3):
        state = viewer(1)
        for t, pose in enumerate(poses):
            known = standing() if t < late else poses[t - late]
            told = guide(known, frames=(t - late, t - late))
            state, report = track.step(state, frame(silhouettes(pose)[0], t), told)
        states[late] = person_of(report)
    for person in states.values():
        assert searched(person).angles_deg["r_shoulder_z"] == pytest.approx(120.0, abs=4.0)


def test_the_vote_follows_the_width_of_the_trunk_with_hysteresis() -> None:
    """P24-P26: from the state that the integrator settled, not from its own last vote."""
    side_on = standing(torso_y=-90.0)
    told = guide(standing())
    turned = looked(1, side_on, msgspec.structs.replace(told, facing=("facade", "flank")))
    assert turned.vote == "flank"
    assert turned.upper_body_px < turned.thresholds_px[0]
    half = standing(torso_y=-45.0, r_shoulder_z=90.0, l_shoulder_z=270.0)
    for facing in (("facade", "flank"), ("flank", "facade")):
        report = looked(1, half, msgspec.structs.replace(guide(half), facing=facing))
        low, high = report.thresholds_px
        if low <= report.upper_body_px <= high:
            assert report.vote == facing[0]


@pytest.mark.parametrize("place_m", [(0.0, 0.0), (0.0, 1.5), (0.0, -1.5)], ids=["0", "near", "far"])
def test_a_squat_is_told_in_metres_not_in_pixels(place_m: tuple[float, float]) -> None:
    """P33: a navel 10 % of the stature lower squats at every distance, one 3 % lower does not."""
    for share, squats in ((0.03, False), (0.10, True)):
        drop_m = share * stature(PERSON)
        hip_deg = float(np.degrees(np.arccos(1 - drop_m / NAVEL_M)))
        truth = squatting(hip_deg)
        truth[POSE_INDEX["x"]], truth[POSE_INDEX["z"]] = place_m
        assert searched(looked(1, truth, guide(truth))).squatting == squats


def test_a_prior_body_never_squats() -> None:
    """P33: the height in the opening posture is what the navel is compared with."""
    truth = squatting(60.0)
    assert not searched(looked(1, truth, guide(truth, measured=False))).squatting


def kick_as_followed(method: Method) -> float:
    """theta_X of the hip that viewer 2 finds of a leg that rises by 10 degrees a frame to 30, while
    the fused pose has it at rest throughout."""
    state, found = viewer(2, method), [0.0]
    for index, hip_deg in enumerate(range(0, 31, 10)):
        truth = standing(r_hip_x=float(hip_deg))
        state, report = track.step(state, frame(silhouettes(truth)[1], index), guide(standing()))
        angles_deg = searched(person_of(report)).angles_deg
        found = [angles_deg["r_hip_x"], angles_deg["l_hip_x"]]
    return max(found)


def test_the_flank_goes_on_from_the_legs_that_it_found_itself() -> None:
    """L1: the fused pose has a leg at rest wherever the facade's theta_Z does not lift it (P53).
    From there a window of 16 degrees never meets a kick."""
    paper = METHODS["paper"]
    assert kick_as_followed(paper) == pytest.approx(30.0, abs=4.0)
    shared = msgspec.structs.replace(paper, shared_start=True)
    assert kick_as_followed(shared) <= 16.0


def test_the_facade_goes_on_from_its_own_legs_in_a_squat_alone() -> None:
    """P33: standing it does not look for theta_X, so that is the fused pose's; L1."""
    bent, state = standing(r_hip_x=30.0, r_knee_x=-60.0), viewer(1)
    told = guide(standing())
    for index in range(2):
        state, report = track.step(state, frame(silhouettes(standing())[0], index), told)
        told = msgspec.structs.replace(told, pose=tuple(bent.tolist()))
    assert searched(person_of(report)).angles_deg["r_hip_x"] == 30.0


def test_the_count_of_matches_is_the_papers_cost() -> None:
    """P27, P40: position, four arm searches of at most 9, two legs of at most 7."""
    report = looked(1, standing(), guide(standing()))
    assert 13 + 4 * 6 + 2 * 5 <= searched(report).matches <= 2 * (1 + 3 * 6) + 4 * 9 + 2 * 7


@pytest.mark.parametrize("seen", [True, False], ids=["with an outline", "without one"])
def test_what_a_source_outside_sees_is_told_of_who_is_there_and_stays(seen: bool) -> None:
    person = landmarks_of(standing())
    state = told_from_outside()
    picture = frame(silhouettes(standing())[0] if seen else NOBODY)
    shown = msgspec.structs.replace(picture, landmarks=(person,))
    for told in (None, guide(standing())):
        after, view = track.step(state, shown, told)
        assert landmarks_in(view) == person
        assert after.landmarks.known == person
    assert landmarks_in(track.step(state, picture, None)[1]) is None


def test_landmarks_change_nothing_else_of_a_report() -> None:
    state = told_from_outside()
    person = landmarks_of(standing())
    picture = frame(silhouettes(standing())[0])
    shown = msgspec.structs.replace(picture, landmarks=(person,))
    _, with_them = track.step(state, shown, guide(standing()))
    _, without = track.step(state, picture, guide(standing()))
    assert changed(with_them, landmarks=None) == without


def looks_of(monkeypatch: pytest.MonkeyPatch, alone: bool) -> tuple[track.State, list[bool]]:
    """A viewer with a network of its own, which sees somebody, and at each of its looks whether
    that was in the mirror too."""
    looks: list[bool] = []

    def look(*given: Any, **_: Any) -> LandmarkResult:
        looks.append(given[3].twice)
        return LandmarkResult(landmarks_of(standing()))

    monkeypatch.setattr(landmark_step, "own_landmarks", look)
    monkeypatch.setattr(landmark_step, "people_in", lambda *_: [])
    setup = told_from_outside().setup
    settings = msgspec.structs.replace(setup.settings, landmarks="own")
    return viewer(1)._replace(setup=setup._replace(settings=settings, alone=alone)), looks


def test_in_a_hurry_one_of_two_views_tells_its_outline_alone_and_remembers_who_is_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    state, looks = looks_of(monkeypatch, alone=False)
    picture = frame(silhouettes(standing())[0])
    state, first = track.step(state, picture, None)
    hurried = msgspec.structs.replace(frame(silhouettes(standing())[0], 1), hurried=True)
    state, second = track.step(state, hurried, None)
    assert looks == [False]
    one, other = person_of(first), person_of(second)
    assert (one.landmarks, other.landmarks) == (landmarks_of(standing()), None)
    assert other.silhouette == one.silhouette
    assert state.landmarks.known == one.landmarks


def test_in_a_hurry_an_only_view_is_looked_at_but_not_in_the_mirror(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    state, looks = looks_of(monkeypatch, alone=True)
    picture = frame(silhouettes(standing())[0])
    state, _ = track.step(state, picture, None)
    hurried = msgspec.structs.replace(picture, index=1, hurried=True)
    assert landmarks_in(track.step(state, hurried, None)[1]) == landmarks_of(standing())
    assert looks == [True, False]


def test_what_a_source_outside_saw_is_told_in_a_hurry_too() -> None:
    person = landmarks_of(standing())
    picture = frame(silhouettes(standing())[0])
    shown = msgspec.structs.replace(picture, landmarks=(person,), hurried=True)
    assert landmarks_in(track.step(told_from_outside(), shown, None)[1]) == person


def test_a_viewer_is_a_value() -> None:
    """The same frame and guide give the same report again."""
    state, told = viewer(1), guide(standing())
    masks = silhouettes(standing(r_shoulder_z=150.0))
    assert (
        track.step(state, frame(masks[0]), told)[1] == track.step(state, frame(masks[0]), told)[1]
    )


def test_two_viewers_need_no_more_than_what_a_guide_says() -> None:
    """P2: reports of a walk through both viewers and the integrator use the guide before."""
    told = Stage().show([opening()] * 3)
    assert [t.guide.frames for t in told] == [(0, 0), (1, 1), (2, 2)]


@pytest.mark.parametrize(("method", "known"), [(DEFAULT, True), (METHODS["paper"], False)])
def test_who_is_in_the_first_frame_is_known_where_landmarks_are_asked_for(
    method: Method, known: bool
) -> None:
    """So the outline next to them is followed, not the largest."""
    setup = viewer(1).setup._replace(method=method)
    somebody = landmarks_of(standing())
    state = track.init(setup, learn([np.zeros((240, 320, 3), np.uint8)]), somebody=somebody)
    assert (state.landmarks.known == somebody) == known


@pytest.mark.parametrize(
    ("number", "moves", "since_s"),
    [(1, (False, True), 1.5), (1, (True, False), None), (2, (True, False), 1.5), (2, (), None)],
)
def test_a_frozen_picture_is_judged_by_the_motion_of_the_other_view(
    monkeypatch: pytest.MonkeyPatch,
    number: ViewerNumber,
    moves: tuple[bool, ...],
    since_s: float | None,
) -> None:
    """A guide of 2 s tells of the half second before; of whom this view does not see, nothing."""
    told: list[float | None] = []

    def step(state: object, _picture: object, _s: float, moving_since_s: float | None) -> object:
        told.append(moving_since_s)
        return state, ""

    monkeypatch.setattr("viewer.camera_fault.step", step)
    said = guide(standing(), captured_s=2.0, moves=moves or (False, True))
    state = viewer(number)
    for _ in range(2):
        state, _, _ = track.look(state, frame(silhouettes(standing())[number - 1]), said)
    assert told == [None, since_s]
