"""What a viewer remembers and reports of a frame, its stages decided here."""

from typing import Any

import msgspec
import numpy as np
import pytest
from staging import PERSON, person_of

from common.body.body import JOINT_NAMES
from common.body.observation import Box, Landmarks
from common.bus.messages import Guide
from common.config.settings import Settings
from common.method import DEFAULT, PAPER, THESIS, Method
from common.raster.silhouette_report import unpack
from common.rig.camera import paper_rig
from viewer import camera_fault, landmark_step, track
from viewer.background import moved_camera
from viewer.background.background import Background, learn
from viewer.background.moved_objects import Patch
from viewer.captured_frame import CapturedFrame
from viewer.landmarks.landmark_window import Window
from viewer.landmarks.person_mask import LandmarkResult, PersonMask, Shown
from viewer.people.known_people import of_one
from viewer.people.observed_people import everyone
from viewer.room.silhouette_correction import Corrected
from viewer.silhouette import silhouette
from viewer.silhouette.silhouette import Seen

WIDE, HIGH = 80, 60
CAMERA = paper_rig((WIDE, HIGH), (90.0, 90.0), (4.0, 4.0)).cameras[1]
PELVIS = JOINT_NAMES.index("pelvis")


def room(level: int = 100) -> Background:
    rng = np.random.default_rng(1)
    return learn([(level + rng.integers(-40, 40, (HIGH, WIDE, 3))).astype(np.uint8)])


def setup(method: Method = DEFAULT, alone: bool = False, calibrated: bool = True) -> track.Setup:
    settings = msgspec.structs.replace(Settings(), landmarks="none")
    return track.Setup(2, CAMERA if calibrated else None, settings, method, alone)


def frame(index: int = 7, **changed: Any) -> CapturedFrame:
    picture = np.full((HIGH, WIDE, 3), 90, np.uint8)
    shown = CapturedFrame(index, 0.5, 1000.5, picture, next_s=0.6)
    return msgspec.structs.replace(shown, **changed)


def guide() -> Guide:
    return Guide(
        frame=6, captured_s=0.4, clock_s=0.4, frames=(6, 6), status="tracking", bdp=PERSON,
        scale_px_per_m=(50.0, 40.0), root_px=((11.0, 12.0), (41.0, 32.0)), pose=(0.0,) * 25,
    )  # fmt: skip


def landmarks(sure: float) -> Landmarks:
    places = [(20.0 + n, 5.0 + 3.0 * n) for n in range(15)]
    return Landmarks(tuple(places), (sure,) * 15)


@pytest.mark.parametrize(
    ("method", "alone", "calibrated", "searches"),
    [
        (DEFAULT, False, True, False),
        (DEFAULT, True, False, False),
        (DEFAULT, False, False, True),
        (PAPER, False, True, True),
        (PAPER, True, False, True),
        (THESIS, False, True, False),
        (THESIS, True, False, False),
    ],
)
def test_a_viewer_searches_where_nothing_proposes_and_no_stick_is_lifted(
    method: Method, alone: bool, calibrated: bool, searches: bool
) -> None:
    assert setup(method, alone, calibrated).searches == searches


@pytest.mark.parametrize(
    ("method", "alone", "calibrated", "watched"),
    [
        (DEFAULT, False, True, True),
        (DEFAULT, True, True, True),
        (DEFAULT, False, False, True),
        (DEFAULT, True, False, False),
        (PAPER, False, True, False),
    ],
)
def test_a_camera_is_watched_where_a_rig_may_become_wrong(
    method: Method, alone: bool, calibrated: bool, watched: bool
) -> None:
    state = track.init(setup(method, alone, calibrated), room())
    assert (state.moved is not None) == watched
    if state.moved is not None:
        focal = 90.0 if calibrated else 1.25 * WIDE
        assert state.moved.lens.focal_px.tolist() == [focal, focal]
        assert state.moved.begun.tolist() == np.eye(3).tolist()


def test_before_another_background_nothing_of_the_old_one_is_kept_but_how_it_was_turned() -> None:
    state = track.init(setup(), room(), patches=[patch(3, 10)])
    assert state.moved is not None
    assert [each.frame for each in state.coming] == [3]
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    begun = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    state = state._replace(
        moved=state.moved._replace(turn=turn, begun=begun),
        landmarks=landmark_step.State(of_one(landmarks(0.9))),
    )
    new = room(140)
    found = track.with_background(state, new)
    assert found.silhouette.background is new
    assert np.array_equal(found.fault.background, camera_fault.init(new).background)
    assert found.coming == ()
    assert found.moved is not None
    assert found.moved.first is new
    assert np.array_equal(found.moved.begun, turn @ begun)
    assert found.landmarks is state.landmarks


def patch(at: int, level: float, column: int = 4) -> Patch:
    where = np.zeros((HIGH, WIDE), np.bool_)
    where[5, column : column + 2] = True
    return Patch(at, where, np.full((2, 3), level, np.float32), np.full((2, 2), 3.0, np.float32))


def test_patches_are_laid_on_the_background_when_they_are_due() -> None:
    """In the order of time: what comes later lies over what came before."""
    coming = [patch(3, 10.0), patch(5, 20.0, 5), patch(9, 30.0)]
    state = track.init(setup(), room(), patches=coming)
    assert track._patched(state, 2) is state
    found = track._patched(state, 5)
    assert found.silhouette.model.centre[5, 4:7, 0].tolist()[:2] == [10.0, 20.0]
    assert [each.frame for each in found.coming] == [9]
    assert track._patched(found, 9).silhouette.model.centre[5, 4, 0] == 30.0


@pytest.mark.parametrize(
    ("sure", "guided", "alone", "near_px"),
    [
        (0.9, True, True, (20.0 + PELVIS, 5.0 + 3.0 * PELVIS)),
        (0.1, True, True, (41.0, 32.0)),
        (0.1, False, True, (7.0, 8.0)),
        (0.1, False, False, None),
        (None, True, False, (41.0, 32.0)),
        (None, False, True, (7.0, 8.0)),
    ],
)
def test_the_body_is_expected_where_its_joints_were_where_the_guide_has_it_or_where_it_was(
    sure: float | None, guided: bool, alone: bool, near_px: tuple[float, float] | None
) -> None:
    """The pelvis of sure landmarks, this viewer's half of the guide, the only view's last box."""
    state = track.init(setup(alone=alone), room())._replace(near_px=(7.0, 8.0))
    known = landmark_step.State(of_one(None if sure is None else landmarks(sure)))
    state = state._replace(landmarks=known)
    assert track._near_px(state, guide() if guided else None) == near_px


def test_a_report_tells_what_the_silhouette_shows_and_when() -> None:
    mask = np.zeros((HIGH, WIDE), np.bool_)
    mask[10:50, 20:30] = True
    box = Box(left=20, right=29, top=10, bottom=49)
    shape = Seen(mask, box, 400, 3, cut=True)
    state = track.init(setup(), room())
    seen = everyone(state.silhouette, frame().picture, shape, Shown(LandmarkResult(None)), 0.15)
    report = track._view_of(2, frame(), shape, seen)
    assert (report.frame, report.viewer, report.width, report.height) == (7, 2, WIDE, HIGH)
    assert (report.captured_s, report.clock_s, report.next_s) == (0.5, 1000.5, 0.6)
    person = person_of(report)
    assert (person.box, person.area_px, report.blobs, person.cut) == (box, 400, 3, True)
    assert np.array_equal(unpack(person), mask)
    assert track._middle_px(box) == (25.0, 30.0)
    assert track._middle_px(None) is None


def test_a_picture_that_shows_no_scene_is_reported_and_not_looked_at(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    state = track.init(setup(), room())
    watched = state.fault._replace(background=state.fault.background + 1)
    monkeypatch.setattr(camera_fault, "step", lambda *_: (watched, "black"))
    monkeypatch.setattr(silhouette, "step", lambda *_: pytest.fail("it was looked at"))
    found, report, mask = track.look(state, frame(), guide())
    assert (report.fault, report.people, report.width, report.height) == ("black", (), WIDE, HIGH)
    assert mask.shape == (HIGH, WIDE)
    assert not mask.any()
    assert found == state._replace(fault=watched)


class Stages:
    """A frame's stages, each as it is decided; what each was given."""

    def __init__(self, patch_: pytest.MonkeyPatch, things: bool = False) -> None:
        self.told: dict[str, Any] = {}
        mask = np.zeros((HIGH, WIDE), np.bool_)
        mask[10:50, 20:30] = True
        self.seen = Seen(mask, Box(left=20, right=29, top=10, bottom=49), 400, 1, cut=False)
        less = mask.copy()
        less[:, 25:] = False
        self.less = Seen(less, Box(left=20, right=24, top=10, bottom=49), 200, 1, cut=False)
        self.things = np.ones((HIGH, WIDE), np.uint8)

        def step(state: Any, picture: Any, near_px: Any) -> Any:
            self.told["near_px"] = near_px
            return state._replace(frames=state.frames + 5), self.seen

        def corrected(
            seen: Seen, told: LandmarkResult, least_share: float, others: Any
        ) -> Corrected:
            self.told["corrected"] = (seen, told.landmarks, least_share)
            assert not others
            if not things:
                return Corrected(seen, None, is_changed=False)
            return Corrected(self.less, self.things, is_changed=True)

        def without_things(after: Any, before: Any, picture: Any, things: Any) -> Any:
            self.told["without"] = (after.frames, before.frames, picture, things)
            return before._replace(frames=99)

        patch_.setattr(camera_fault, "step", lambda state, *_: (state, ""))
        patch_.setattr(moved_camera, "step", lambda state, _: (state, False))
        patch_.setattr(silhouette, "step", step)
        patch_.setattr(silhouette, "without_things", without_things)
        patch_.setattr(track, "corrected", corrected)


def test_a_frame_is_cut_out_held_against_its_landmarks_and_remembered(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stages = Stages(monkeypatch)
    state = track.init(setup(), room())
    found, report, mask = track.look(state, frame(), guide())
    assert stages.told["near_px"] == (41.0, 32.0)
    assert stages.told["corrected"] == (stages.seen, None, 0.15)
    assert "without" not in stages.told
    person = person_of(report)
    assert (person.area_px, report.fault, person.landmarks) == (400, "", None)
    assert mask is stages.seen.mask
    assert found.silhouette.frames == 5
    assert found.near_px == (25.0, 30.0)


def test_what_the_landmarks_say_is_a_thing_is_left_out_of_report_and_memory(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stages = Stages(monkeypatch, things=True)
    shown = frame()
    found, report, mask = track.look(track.init(setup(), room()), shown, None)
    after, before, picture, things = stages.told["without"]
    assert (after, before) == (5, 0)
    assert picture is shown.picture
    assert things is stages.things
    person = person_of(report)
    assert (person.area_px, person.box) == (200, stages.less.box)
    assert mask is stages.less.mask
    assert found.silhouette.frames == 99
    assert found.near_px == (22.5, 30.0)


def test_a_camera_that_was_moved_looks_before_its_background_as_it_is_turned(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Who was there is looked for anew; how it is turned is in the report."""
    Stages(monkeypatch)
    state = track.init(setup(), room())
    still = state.moved
    assert still is not None
    state = state._replace(
        landmarks=landmark_step.State(of_one(landmarks(0.9))),
        near_px=(7.0, 8.0),
        unsearched=frame().picture,
    )
    angle = np.radians(3.0)
    turn = np.array(
        [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    )
    moved = still._replace(turn=turn)
    told: list[Any] = []
    new = room(140)

    def turned(*given: Any) -> Background:
        told.append(given)
        return new

    monkeypatch.setattr(track, "turned_background", turned)
    monkeypatch.setattr(moved_camera, "step", lambda *_: (moved, True))
    found = track._followed(state)
    assert told == [(moved.first, moved.lens, turn, state.unsearched)]
    assert found.silhouette.background is new
    assert (found.landmarks.known, found.near_px, found.moved) == (None, None, moved)
    monkeypatch.setattr(moved_camera, "step", lambda *_: (moved, False))
    found = track._followed(state)
    assert found == state._replace(moved=moved, unsearched=None)
    report = track.look(state, frame(), None)[1]
    assert report.shift is not None
    assert report.shift.right_px == pytest.approx(90.0 * np.tan(angle), rel=0.01)
    alone = state._replace(moved=None)
    assert track._followed(alone) is alone


def test_a_report_does_not_wait_for_the_search_for_a_moved_camera(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is of the frame before, whether it is done after that one's report or before the next."""
    Stages(monkeypatch)
    searched: list[Any] = []

    def step(state: Any, picture: Any) -> tuple[Any, bool]:
        searched.append(picture)
        return state, False

    monkeypatch.setattr(moved_camera, "step", step)
    first, second = frame(), frame()
    state = track.look(track.init(setup(), room()), first, None)[0]
    assert searched == []
    done = track.finished(state)
    assert [id(each) for each in searched] == [id(first.picture)]
    assert track.finished(done) == done
    track.look(done, second, None)
    assert len(searched) == 1
    track.look(state, second, None)
    assert [id(each) for each in searched] == [id(first.picture)] * 2


def test_who_is_nobody_starts_the_search_anew() -> None:
    state = track.init(setup(PAPER), room())
    state = state._replace(search=state.search._replace(found="before"))  # type: ignore[arg-type]
    nobody = Seen(np.zeros((HIGH, WIDE), np.bool_), None, 0, 0, cut=False)
    report = track._view_of(2, frame(), nobody, ())
    found, told = track.describe(state, report, nobody.mask, None)
    assert found.search.found is None
    assert told is report


@pytest.mark.parametrize(
    ("alone", "calibrated", "count"), [(False, True, 1), (True, False, 1), (False, False, 0)]
)
@pytest.mark.parametrize("has_landmarks", [False, True])
def test_others_are_reported_without_the_followed_one_where_places_tell_people_apart(
    monkeypatch: pytest.MonkeyPatch, alone: bool, calibrated: bool, count: int, has_landmarks: bool
) -> None:
    """Elsewhere the integrator takes the first, who must not be another; also where the followed
    one has landmarks and no pixel."""
    logits = np.full((48, 48), -4.0, np.float32)
    logits[4:44, 10:30] = 4.0
    other = LandmarkResult(landmarks(0.9), PersonMask(logits, Window(0, 0, 48)))
    nowhere = PersonMask(np.full((48, 48), -4.0, np.float32), Window(0, 0, 48))
    followed = LandmarkResult(landmarks(0.9), nowhere) if has_landmarks else LandmarkResult(None)
    shown = Shown(followed, 3, ((5, other),))
    monkeypatch.setattr(landmark_step, "step", lambda state, *_, **__: (state, shown))
    begun = track.init(setup(alone=alone, calibrated=calibrated), room())
    rng = np.random.default_rng(1)
    picture = (100 + rng.integers(-40, 40, (HIGH, WIDE, 3))).astype(np.uint8)
    _, report, mask = track.look(begun, frame(picture=picture), None)
    assert [person.track for person in report.people] == [5] * count
    assert mask.any() == bool(count)
    for person in report.people:
        np.testing.assert_array_equal(mask, unpack(person))
