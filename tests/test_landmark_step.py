"""Where the landmark network looks, when the whole picture is searched, and at whom."""

from collections.abc import Callable
from typing import Any, Literal

import msgspec
import numpy as np
import pytest
from test_own_landmarks import acted, nobody, seen

from common.body.body import JOINT_NAMES, Floats
from common.body.observation import Landmarks
from common.config.part_settings import SilhouetteSettings
from common.config.settings import Settings
from common.video.pictures import Image
from runtime.unfinished.state_codec import packed, unpacked
from viewer import landmark_step
from viewer.captured_frame import CapturedFrame
from viewer.landmark_step import State, searched, step
from viewer.landmarks.landmark_window import Window
from viewer.landmarks.person_mask import LandmarkResult, Shown
from viewer.people import close_people, detected_again
from viewer.people.known_people import People, Track, of_one
from viewer.people.looks_in_turn import LastLook
from viewer.people.people_detector import Detection
from viewer.silhouette.silhouette import Seen

EMPTY = Seen(np.zeros((240, 320), np.bool_), None, 0, 0, cut=False)
SETTINGS = Settings()


def standing(x_px: float, sure: float = 0.9) -> Landmarks:
    """A person 120 pixels tall, whose middle is at a column."""
    low, high = np.array((x_px - 20.0, 60.0)), np.array((x_px + 20.0, 180.0))
    places = np.random.default_rng(3).uniform(low, high, (15, 2))
    return Landmarks(tuple(map(tuple, places.tolist())), (sure,) * 15)


def detected(x_px: float) -> Detection:
    corners = np.array([(x_px - 25.0, 50.0), (x_px + 25.0, 190.0)])
    points = np.random.default_rng(4).uniform(corners[0], corners[1], (17, 2))
    points[[5, 6], 1], points[[11, 12], 1] = 70.0, 120.0
    points[[5, 6, 11, 12], 0] = x_px
    return Detection(0.8, corners, points)


def frame(captured_s: float, hurried: bool = False, picture: Image | None = None) -> CapturedFrame:
    shown = np.zeros((240, 320, 3), np.uint8) if picture is None else picture
    return CapturedFrame(0, captured_s, captured_s, shown, hurried=hurried)


class Scene:
    """People at columns of the picture, seen by stand-ins of both networks."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *people: Landmarks) -> None:
        self.people = list(people)
        self.own: Callable[..., Landmarks | None] = lambda: self.people[0] if self.people else None
        self.searches: list[float] = []
        self.parts_px: list[Floats] = []
        self.at_s = 0.0
        monkeypatch.setattr(landmark_step, "own_landmarks", self._own)
        for module in (landmark_step, detected_again):
            monkeypatch.setattr(module, "look_in", self._look_in)
        monkeypatch.setattr(landmark_step, "people_in", self._people_in)

    def _own(self, *_: Any, **__: Any) -> LandmarkResult:
        return LandmarkResult(self.own())

    def _look_in(self, _: Image, window: Window, __: Any) -> LandmarkResult:
        middle = window.left + window.side / 2
        near = [each for each in self.people if abs(column(each) - middle) < window.side / 2]
        best = min(near, key=lambda each: abs(column(each) - middle), default=None)
        return LandmarkResult(best)

    def _people_in(self, _: Image, part_px: Floats | None = None) -> list[Detection]:
        if part_px is None:
            self.searches.append(self.at_s)
        else:
            self.parts_px.append(part_px)
        return [detected(column(each)) for each in self.people]

    def step(
        self,
        state: State,
        at_s: float,
        silhouette: Seen = EMPTY,
        settings: Settings = SETTINGS,
        **more: Any,
    ) -> tuple[State, Shown]:
        self.at_s = at_s
        state, shown = step(state, frame(at_s), silhouette, settings, alone=False, **more)
        return searched(state), shown


def column(landmarks: Landmarks) -> float:
    return float(np.mean(landmarks.joints_px, axis=0)[0])


def columns(shown: Shown) -> list[float | None]:
    """Of the followed person, then of the others."""
    results = (shown.followed, *(each for _, each in shown.others))
    return [None if each.landmarks is None else column(each.landmarks) for each in results]


@pytest.mark.parametrize(("sure", "every"), [(0.9, 0.5), (0.4, 0.25)])
def test_the_whole_picture_is_searched_twice_a_second_and_oftener_for_a_person_unsurely_seen(
    monkeypatch: pytest.MonkeyPatch, sure: float, every: float
) -> None:
    """At 8 frames a second."""
    scene, state = Scene(monkeypatch, standing(100.0, sure)), State()
    for at in range(17):
        state, shown = scene.step(state, at / 8)
        assert shown.followed.landmarks is scene.people[0]
    assert scene.searches == pytest.approx(np.arange(0.0, 2.01, every))


def test_a_known_person_is_reported_before_the_whole_picture_is_searched(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Who comes is seen a frame later then, whether the search was made before that or in it."""
    scene = Scene(monkeypatch, standing(60.0))
    state, _ = scene.step(State(), 0.0)
    scene.people.append(standing(250.0))
    due, shown = step(state, frame(0.5), EMPTY, SETTINGS, alone=False)
    assert columns(shown) == [pytest.approx(column(scene.people[0]))]
    assert scene.searches == [0.0]
    done = searched(due)
    assert len(scene.searches) == 2
    assert done.detected is not None
    assert len(done.detected) == 2
    for before in (due, done):
        after, shown = step(before, frame(0.57), EMPTY, SETTINGS, alone=False)
        assert columns(shown) == pytest.approx([column(each) for each in scene.people])
        assert after.detected is None
    assert searched(done) is done


def test_without_a_person_the_whole_picture_is_searched_four_times_a_second(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene, state = Scene(monkeypatch), State()
    for at in range(9):
        state, shown = scene.step(state, at / 8)
        assert columns(shown) == [None]
    assert scene.searches == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])


def test_a_silhouette_of_no_known_person_has_the_whole_picture_searched_in_every_frame(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene, state = Scene(monkeypatch), State()
    thing = np.zeros((240, 320), np.bool_)
    thing[60:200, 5:50] = True
    for at in range(4):
        state, _ = scene.step(state, at / 8, seen(thing))
    assert scene.searches == pytest.approx([0.0, 0.125, 0.25, 0.375])


def test_while_another_person_is_out_of_sight_the_whole_picture_is_searched_oftener(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene, state = Scene(monkeypatch, standing(60.0), standing(250.0)), State()
    state, _ = scene.step(state, 0.0)
    del scene.people[1]
    for at in range(1, 6):
        state, _ = scene.step(state, at / 8)
    assert scene.searches == pytest.approx([0.0, 0.25, 0.5])


def test_two_people_are_seen_and_keep_their_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, state = Scene(monkeypatch, standing(60.0), standing(250.0)), State()
    for at in range(20):
        scene.people = [standing(60.0 + 2 * at), standing(250.0 - 2 * at)]
        state, shown = scene.step(state, at / 15)
        assert (shown.number, [number for number, _ in shown.others]) == (0, [1])
        first, second = columns(shown)
        assert first == pytest.approx(column(standing(60.0 + 2 * at)), abs=1)
        assert second == pytest.approx(column(standing(250.0 - 2 * at)), abs=1)


def test_what_is_known_of_people_is_saved_and_read_again(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene(monkeypatch, standing(60.0), standing(250.0))
    state, _ = scene.step(State(), 0.0)
    assert len(state.people.tracks) == 2
    assert unpacked(packed(state), State) == state


def test_while_the_followed_person_is_out_of_sight_no_other_takes_the_place(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """After a second another is followed, with a number of their own."""
    scene, state = Scene(monkeypatch, standing(60.0), standing(250.0)), State()
    state, _ = scene.step(state, 0.0)
    scene.people = [standing(250.0)]  # the silhouette is that of who is left
    for at in (0.3, 0.6, 0.9):
        state, shown = scene.step(state, at)
        assert (columns(shown)[0], shown.number, len(shown.others)) == (None, 0, 1)
    state, shown = scene.step(state, 1.2)
    assert (shown.number, shown.others) == (1, ())
    assert shown.followed.landmarks is scene.people[0]


def test_the_integrators_person_is_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, state = Scene(monkeypatch, standing(60.0), standing(250.0)), State()
    state, _ = scene.step(state, 0.0)
    pelvis_px = standing(250.0).joints_px[JOINT_NAMES.index("pelvis")]
    scene.own = lambda: standing(250.0)
    scene.people.reverse()
    scene._look_in = lambda *_: LandmarkResult(standing(60.0))  # type: ignore[method-assign]
    for module in (landmark_step, detected_again):
        monkeypatch.setattr(module, "look_in", scene._look_in)
    _, shown = scene.step(state, 0.1, root_px=pelvis_px)
    assert (shown.number, [number for number, _ in shown.others]) == (1, [0])


def test_an_unsure_person_is_looked_at_again_where_they_are_detected(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A silhouette that lacks legs, or has a shadow, leads astray; the surer look counts."""
    scene = Scene(monkeypatch, standing(100.0, 0.8))
    scene.own = lambda: standing(100.0, 0.45)
    _, shown = scene.step(State(), 0.0)
    assert shown.followed.surety == pytest.approx(0.8)
    scene.people = [standing(100.0, 0.39)]
    _, shown = scene.step(State(), 0.0)
    assert shown.followed.surety == pytest.approx(0.45)


def test_what_no_person_is_has_its_look_reported_and_is_not_remembered(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a silhouette: the look says how unsure it is."""
    scene = Scene(monkeypatch)
    scene.own = lambda: standing(100.0, 0.2)
    state, shown = scene.step(State(), 0.0)
    assert shown.followed.surety == pytest.approx(0.2)
    assert state.known is None


def test_a_late_frame_of_a_single_view_is_not_searched_and_the_next_one_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = Scene(monkeypatch, standing(100.0))
    late = frame(3.0, hurried=True)
    state, _ = step(State(), late, EMPTY, SETTINGS, alone=True)
    assert scene.searches == []
    state, shown = step(state, frame(3.1), EMPTY, SETTINGS, alone=True)
    assert len(scene.searches) == 1
    assert columns(shown) == [pytest.approx(column(scene.people[0]))]


def test_a_late_frame_of_two_views_keeps_what_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene(monkeypatch, standing(100.0))
    known = State(of_one(standing(100.0), 2.0), 2.0)
    late = frame(9.0, hurried=True)
    kept, shown = step(known, late, EMPTY, SETTINGS, alone=False)
    assert (kept, shown) == (known, Shown(LandmarkResult(None)))
    assert scene.searches == []


def test_a_late_frame_is_looked_at_where_no_background_shows_the_person(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    Scene(monkeypatch, standing(100.0))
    known, late = State(of_one(standing(100.0), 2.0), 2.0), frame(9.0, hurried=True)
    without = msgspec.structs.replace(
        SETTINGS, silhouette=SilhouetteSettings(background="none"), landmarks="own"
    )
    _, shown = step(known, late, EMPTY, without, alone=False)
    assert shown.followed.landmarks == standing(100.0)


def test_an_outside_source_is_asked_for_one_person_in_a_hurry_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene, person = Scene(monkeypatch), standing(100.0)
    sent = msgspec.structs.replace(frame(9.0, hurried=True), landmarks=(person,))
    state, shown = step(State(), sent, EMPTY, Settings(landmarks="mediapipe"), alone=False)
    assert state.known is shown.followed.landmarks
    assert (shown.followed.person, shown.others, scene.searches) == (None, (), [])


def found(silhouette: Seen) -> LandmarkResult:
    """What both networks, as shipped, make of a moment of a performance at first sight."""
    picture = acted()[0].frames[0]
    return step(State(), frame(0.0, picture=picture), silhouette, SETTINGS, alone=False)[1].followed


def off(result: LandmarkResult) -> Any:
    """(15,) distance of the joints, in statures."""
    assert result.landmarks is not None
    _, joints_px, stature_px, _ = acted()
    return np.linalg.norm(np.array(result.landmarks.joints_px) - joints_px, axis=1) / stature_px


def test_a_person_without_a_silhouette_is_found_in_the_whole_picture() -> None:
    assert np.median(off(found(nobody()))) < 0.05


def test_a_silhouette_that_is_elsewhere_does_not_lead_astray() -> None:
    wrong = np.zeros((240, 320), np.bool_)
    wrong[60:200, 5:50] = True
    assert np.median(off(found(seen(wrong)))) < 0.05


def test_a_person_whose_legs_did_not_move_is_found_whole() -> None:
    mask = acted()[0].masks[0].copy()
    rows = np.flatnonzero(mask.any(axis=1))
    mask[(rows[0] + rows[-1]) // 2 :] = False
    result = found(seen(mask))
    ankles = [JOINT_NAMES.index(name) for name in ("l_ankle", "r_ankle")]
    assert off(result)[ankles].max() < 0.05
    assert result.person is not None
    shown, true = result.person.over((240, 320), 0.5)[0] > 0, acted()[0].masks[0]
    assert (shown & true).sum() > 0.75 * (shown | true).sum()


def test_in_an_empty_room_no_person_is_seen() -> None:
    empty = frame(0.0, picture=acted()[3])
    state, shown = step(State(), empty, nobody(), SETTINGS, alone=False)
    assert (shown, state.known) == (Shown(LandmarkResult(None)), None)


def test_everyone_is_seen_in_the_first_frame_also_where_one_is_known_from_the_whole_video(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Else each view would begin with another person, and both would be taken for one."""
    scene = Scene(monkeypatch, standing(60.0), standing(250.0))
    _, shown = scene.step(State(of_one(scene.people[0])), 0.0)
    assert columns(shown) == pytest.approx([column(each) for each in scene.people])


def test_who_is_not_due_is_not_looked_at_and_goes_on_from_the_last_look(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene, state = Scene(monkeypatch, standing(60.0), standing(240.0)), State()
    for at in range(10):
        state, shown = scene.step(state, at / 15)
    followed, ((other, _),) = shown.number, shown.others
    looked: list[int] = []

    def look(person: int) -> Callable[..., LandmarkResult]:
        def shown_person(*_: Any, **__: Any) -> LandmarkResult:
            looked.append(person)
            return LandmarkResult(scene.people[person])

        return shown_person

    monkeypatch.setattr(landmark_step, "own_landmarks", look(0))
    monkeypatch.setattr(landmark_step, "look_in", look(1))
    carried = []
    for due in (other, followed, None):
        state, shown = scene.step(state, state.people.tracks[0].seen_s + 1 / 15, due=due)
        assert columns(shown) == pytest.approx([60.0, 240.0], abs=3.0)
        carried.append((shown.followed.carried, shown.others[0][1].carried))
    assert carried == [(True, False), (False, True), (False, False)]
    assert looked == [1, 0, 0, 1]


@pytest.mark.parametrize("is_due", [True, False], ids=["in turn", "without a turn"])
def test_in_late_frames_several_people_are_carried_on_as_long_as_that_goes(
    monkeypatch: pytest.MonkeyPatch, is_due: bool
) -> None:
    scene, state = Scene(monkeypatch, standing(60.0), standing(240.0)), State()
    for at in range(10):
        state, _ = scene.step(state, at / 15)
    first, second = (each.number for each in state.looks)
    looked = []
    for at in range(5):
        late = frame((10 + at) / 15, hurried=True)
        due = first if is_due else None
        state, shown = step(state, late, EMPTY, SETTINGS, alone=False, due=due)
        seen = {shown.number: shown.followed, **dict(shown.others)}
        looked.append([number for number, result in seen.items() if not result.carried])
    assert looked == [[], [], [], [first, second], []]
    assert len(scene.searches) == 2, "none of late frames"


def test_where_people_are_looked_at_in_turn_a_search_takes_a_turn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Its frame looks at none of them: the next frame would be late by all that it takes."""
    scene, state = Scene(monkeypatch, standing(60.0, 0.6), standing(240.0, 0.6)), State()
    for at in range(10):
        state, shown = scene.step(state, at / 15)
    due = shown.number
    looked = []
    for at in range(10, 25):
        searches = len(scene.searches)
        state, shown = scene.step(state, at / 15, due=due)
        state = searched(state)
        assert columns(shown) == pytest.approx([60.0, 240.0], abs=3.0)
        carried = [shown.followed.carried, *(each.carried for _, each in shown.others)]
        looked.append((len(scene.searches) - searches, carried.count(False)))
    assert set(looked) == {(0, 1), (0, 2), (1, 0)}, "both where the other one's look is too old"
    assert sum(searches for searches, _ in looked) == 2, "twice a second"


def test_of_two_who_are_close_the_one_who_is_not_due_is_carried_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    people = [standing(100.0), standing(150.0)]
    looked: list[float] = []

    def look_in(_: Image, window: Window, __: Any) -> LandmarkResult:
        middle = window.left + window.side / 2
        looked.append(middle)
        return LandmarkResult(min(people, key=lambda each: abs(column(each) - middle)))

    monkeypatch.setattr(close_people, "look_in", look_in)
    found = (detected(100.0), detected(150.0))
    tracks = tuple(Track(n, each, 1.0) for n, each in enumerate(people))
    last = tuple(
        LastLook(n, LandmarkResult(each), 1.0, ((0.0, 0.0),) * 15) for n, each in enumerate(people)
    )
    state = State(People(tracks, 0, 2), 1.0, detected=found, looks=last)
    later = 1.0 + 1 / 15
    state, shown = step(state, frame(later), EMPTY, SETTINGS, alone=False, due=1)
    assert looked == pytest.approx([150.0], abs=10.0)
    assert (shown.followed.carried, shown.others[0][1].carried) == (True, False)
    assert [each.at_s for each in state.looks] == [1.0, later]


def test_of_people_who_are_close_a_report_does_not_wait_for_the_search(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is of every frame where they meet, and serves the next: a new person, and where each
    is."""
    scene = Scene(monkeypatch, standing(100.0), standing(135.0))
    monkeypatch.setattr(close_people, "look_in", scene._look_in)
    tracks = tuple(Track(n, each, 0.9) for n, each in enumerate(scene.people))
    state = State(People(tracks, 0, 2), 0.9, detected=())
    scene.people.append(standing(260.0))
    state, shown = step(state, frame(1.0), EMPTY, SETTINGS, alone=False)
    assert scene.searches == []
    assert columns(shown) == pytest.approx([100.0, 135.0], abs=3.0)
    state, shown = scene.step(state, 1.0 + 1 / 15)
    assert columns(shown) == pytest.approx([100.0, 135.0, 260.0], abs=3.0)
    assert len(scene.searches) == 2


def nine_frames_of_two(monkeypatch: pytest.MonkeyPatch, second_px: float, **more: Any) -> Scene:
    """Two who were known a frame before, and are in each other's windows."""
    scene = Scene(monkeypatch, standing(100.0), standing(second_px))
    monkeypatch.setattr(close_people, "look_in", scene._look_in)
    tracks = tuple(Track(n, each, 1.0) for n, each in enumerate(scene.people))
    state = State(People(tracks, 0, 2), 1.0)
    for at in range(1, 10):
        state, _ = scene.step(state, 1.0 + at / 15, **more)
    return scene


@pytest.mark.parametrize(
    ("followed", "second_px", "searches"), [("all", 135.0, 9), ("all", 165.0, 2), (1, 165.0, 9)]
)
def test_of_people_who_are_close_and_do_not_meet_the_picture_is_searched_four_times_a_second(
    monkeypatch: pytest.MonkeyPatch, followed: Literal[1, "all"], second_px: float, searches: int
) -> None:
    """In 0.6 s; in every frame where one of them alone is followed."""
    scene = nine_frames_of_two(monkeypatch, second_px, settings=Settings(people=followed))
    assert len(scene.searches) == searches


@pytest.mark.parametrize(("second_px", "parts"), [(135.0, 7), (165.0, 0)])
def test_in_turn_only_the_part_where_people_meet_is_searched_in_each_frame(
    monkeypatch: pytest.MonkeyPatch, second_px: float, parts: int
) -> None:
    """The whole picture is four times a second."""
    scene = nine_frames_of_two(monkeypatch, second_px, settings=Settings(people="all"), due=0)
    assert (len(scene.searches), len(scene.parts_px)) == (2, parts)
    assert all((low < (75.0, 60.0)).all() for low, _ in scene.parts_px)
    assert all((high > (155.0, 180.0)).all() for _, high in scene.parts_px)
