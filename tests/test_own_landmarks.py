"""The viewer's own landmarks: found where the outline is, and where there is none."""

from functools import lru_cache
from typing import Any
from unittest.mock import Mock

import cv2
import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from common.body.observation import Box, Landmarks
from common.raster.similarity import Mask
from common.rig.camera import project
from common.video.pictures import Image
from synth.motion.motions import MOTION, performance
from synth.person.people import person
from synth.person.skeleton import JOINTS
from synth.picture.exposure import default_rig
from synth.picture.render import Shot, render
from viewer.landmarks import own_landmarks as source
from viewer.landmarks.landmark_looks import SHIPPED
from viewer.landmarks.landmark_network import Found, find
from viewer.landmarks.landmark_window import (
    Window,
    planes_of,
    turned_window_of,
    window_about,
    window_of,
)
from viewer.landmarks.own_landmarks import (
    LandmarkModel,
    _about,
    _turn_deg,
    found_anywhere,
    found_between,
    look_in,
    own_landmarks,
)
from viewer.landmarks.person_mask import PersonMask
from viewer.silhouette.silhouette import Seen

RIG = default_rig(320, 240)
PICK = [JOINTS.index(name) for name in JOINT_NAMES]


@lru_cache(maxsize=1)
def acted() -> tuple[Shot, np.ndarray, float, Image]:
    """A moment of a performance, its joints in camera 1, the stature there, the empty room."""
    someone = person(4322)
    motion = performance(someone, "raise_both_lateral", 3)
    at = int(np.flatnonzero(motion.phase == MOTION)[15])
    shots = render(someone, motion, RIG, 77, 3)
    empty = next(shots).frames[0]
    shot = next(shot for i, shot in enumerate(shots, 1) if i == at)
    joints_px = project(RIG.cameras[0], motion.joints_m[at, PICK])
    focal, far_m = RIG.cameras[0].K[0][0], 4.5
    return shot, joints_px, focal * someone.measures["stature_m"] / far_m, empty


def overlap(one: Mask, other: Mask) -> float:
    """Intersection over union."""
    return float((one & other).sum() / (one | other).sum())


def landmarks_by(*given: Any) -> Landmarks | None:
    return own_landmarks(*given).landmarks


def seen(mask: Mask) -> Seen:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    box = Box(left=int(columns[0]), right=int(columns[-1]), top=int(rows[0]), bottom=int(rows[-1]))
    return Seen(mask, box, int(mask.sum()), 1, cut=False)


def nobody() -> Seen:
    return Seen(np.zeros((240, 320), np.bool_), None, 0, 0, cut=False)


def off(found: Landmarks | None) -> float:
    """Median distance of the joints, in statures."""
    assert found is not None
    _, joints_px, stature_px, _ = acted()
    return float(
        np.median(np.linalg.norm(np.array(found.joints_px) - joints_px, axis=1)) / stature_px
    )


@pytest.mark.slow
def test_a_silhouette_that_is_a_guess_is_shown_to_the_network_only_where_no_person_is_known(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shown: list[Mask | None] = []

    def planes(picture: Image, mask: Mask | None, window: Window) -> np.ndarray:
        shown.append(mask)
        return planes_of(picture, mask, window)

    monkeypatch.setattr(source, "planes_of", planes)
    picture, mask = acted()[0].frames[0], acted()[0].masks[0]
    door = np.zeros_like(mask)
    door[40:200, 20:80] = True
    known = landmarks_by(picture, seen(mask), None)
    for is_guess, before, count in ((False, known, 2), (True, known, 0), (True, None, 2)):
        shown.clear()
        found = landmarks_by(picture, seen(mask | door)._replace(is_guess=is_guess), before)
        assert len([each for each in shown if each is not None]) in ((0,) if not count else (1, 2))
        assert found is not None
    assert off(landmarks_by(picture, seen(door)._replace(is_guess=True), known)) < 0.03


@pytest.mark.slow
def test_the_joints_of_somebody_with_an_outline_are_found() -> None:
    shot = acted()[0]
    assert off(landmarks_by(shot.frames[0], seen(shot.masks[0]), None)) < 0.03


def upper_half() -> Seen:
    """Of the person's silhouette; the legs, which do not move, were learnt with the background."""
    mask = acted()[0].masks[0].copy()
    rows = np.flatnonzero(mask.any(axis=1))
    mask[(rows[0] + rows[-1]) // 2 :] = False
    return seen(mask)


def test_the_network_sees_the_person_where_they_are_and_nothing_outside_of_its_window() -> None:
    """In a turned window too."""
    picture, mask = acted()[0].frames[0], acted()[0].masks[0]
    for turn_deg in (0.0, 30.0):
        window = turned_window_of(mask, turn_deg)
        found = find(planes_of(picture, None, window))
        person = PersonMask(found.mask, window).over(picture.shape, 0.5)[0] > 0
        assert person.shape == mask.shape
        assert overlap(person, mask) > 0.7
    few = PersonMask(np.full((48, 48), 9.0, np.float32), Window(100, 60, 96))
    rows, columns = np.nonzero(few.over((240, 320), 0.5)[0])
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == pytest.approx(
        (60, 155, 100, 195), abs=1
    )


def test_an_outline_of_which_the_picture_shows_nobody_has_landmarks_that_are_not_sure_at_all() -> (
    None
):
    """A door that opened: the outline is there, and as tall as a person."""
    door = acted()[3].copy()
    cv2.rectangle(door, (200, 40), (250, 190), (60, 90, 130), cv2.FILLED)
    mask = np.zeros((240, 320), np.bool_)
    mask[40:190, 200:250] = True
    found = landmarks_by(door, seen(mask), None)
    assert found is not None
    assert (max(found.confidence), found.facing_confidence) == (0.0, 0.0)


def test_whoever_faces_the_camera_is_told_to() -> None:
    shot = acted()[0]
    found = landmarks_by(shot.frames[0], seen(shot.masks[0]), None)
    assert found is not None
    assert abs(found.facing_deg) < 45
    assert found.facing_confidence > 0.5


def test_a_grey_and_tiny_picture_is_looked_at_too() -> None:
    shot, joints_px, stature_px, _ = acted()
    small = cv2.resize(shot.frames[0], (160, 120), interpolation=cv2.INTER_AREA)
    grey = cv2.cvtColor(cv2.cvtColor(small, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)
    mask = cv2.resize(shot.masks[0].astype(np.uint8), (160, 120)) > 0
    found = landmarks_by(np.asarray(grey, np.uint8), seen(mask), None)
    assert found is not None
    apart = np.linalg.norm(2 * np.array(found.joints_px) - joints_px, axis=1) / stature_px
    assert np.median(apart) == pytest.approx(0.0, abs=0.04)


@pytest.mark.parametrize("times", [1, 2, 3])
def test_whoever_lies_or_stands_on_their_hands_is_found_as_well(
    times: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All of the picture is turned by a quarter, so often. At first it is looked at where the
    outline is, as a whole, closer, and upright; after that one look is enough."""
    shot, joints_px, stature_px, _ = acted()
    size = np.array([320.0, 240.0])
    for _ in range(times):  # to the left
        joints_px, size = np.stack([joints_px[:, 1], size[0] - joints_px[:, 0]], 1), size[::-1]
    picture = np.array(np.rot90(shot.frames[0], times), np.uint8)
    outline = seen(np.array(np.rot90(shot.masks[0], times), np.bool_))
    looks = Mock(wraps=find)
    monkeypatch.setattr("viewer.landmarks.own_landmarks.find", looks)
    found = None
    for more in (4, 1):
        looks.reset_mock()
        found = landmarks_by(picture, outline, found)
        assert found is not None
        off_px = np.linalg.norm(np.array(found.joints_px) - joints_px, axis=1)
        assert np.median(off_px) < 0.03 * stature_px
        assert abs(found.facing_deg) < 45.0, "about the trunk, the person faces the camera"
        assert found.facing_confidence > 0.5
        assert looks.call_count <= more


def test_who_seemed_to_lie_and_stands_is_looked_at_upright_again() -> None:
    shot, joints_px, _, _ = acted()
    wrong = np.stack([joints_px[:, 1] + 40.0, joints_px[:, 0]], axis=1)
    before = Landmarks(tuple((x, y) for x, y in wrong.tolist()), (0.9,) * 15)
    found = landmarks_by(shot.frames[0], seen(shot.masks[0]), before)
    assert off(found) < 0.03


class Looks:
    """A network that finds what it is told to, look by look, and keeps what it was shown."""

    def __init__(self, patch: pytest.MonkeyPatch, *found: Found) -> None:
        self.found, self.shown, self.eyes = list(found), [], []  # type: ignore[var-annotated]
        patch.setattr(source, "planes_of", self.planes_of)
        patch.setattr(source, "find", self.find)

    def planes_of(self, _picture: Image, mask: Mask | None, window: Window) -> None:
        self.shown.append((window, mask is not None))

    def find(self, _planes: None, *eye: object) -> Found:
        self.eyes.append(eye)
        return self.found.pop(0)


UPRIGHT = np.array(
    [[96.0, 100.0], [96.0, 60.0], [96.0, 40.0], *[[90.0 + i, 150.0] for i in range(12)]]
)
"""Joints in the planes of a trunk that stands: pelvis, neck, head, and limbs below."""


NO_MASK = np.full((48, 48), -9.0, np.float32)


def looked(sure: float, nobody: float = 0.0, joints: np.ndarray = UPRIGHT) -> Found:
    return Found(
        joints,
        np.full(15, sure),
        12.0,
        0.7,
        nobody,
        joints + 1.0,
        np.full(15, 0.25 * sure),
        NO_MASK,
    )


PICTURE = np.zeros((240, 320, 3), np.uint8)
BOXED = np.zeros((240, 320), np.bool_)
BOXED[60:200, 100:160] = True
WHOLE = Window(0, -40, 320)


def lying() -> np.ndarray:
    """The same, along the row: the head to the right of the pelvis."""
    return np.stack([192.0 - UPRIGHT[:, 1], UPRIGHT[:, 0]], axis=1)


def test_a_sure_look_at_the_outline_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    looks = Looks(monkeypatch, looked(0.5))
    found = landmarks_by(PICTURE, seen(BOXED), None, LandmarkModel(SHIPPED, twice=True))
    window = window_of(Box(left=100, right=159, top=60, bottom=199))
    assert looks.shown == [(window, True)]
    assert looks.eyes == [(SHIPPED, True)]
    assert found is not None
    assert np.array(found.joints_px) == pytest.approx(window.in_picture(UPRIGHT))
    assert np.array(found.second_px) == pytest.approx(window.in_picture(UPRIGHT + 1.0))
    assert found.confidence == (0.5,) * 15
    assert found.second_confidence == (0.125,) * 15
    assert (found.facing_deg, found.facing_confidence) == (12.0, 0.7)


def test_a_silhouette_elsewhere_than_the_person_of_before_is_looked_at_and_that_place_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The surer of both is taken."""
    before = Landmarks(tuple((200.0 + i, 90.0 + 9 * i) for i in range(15)), (0.9,) * 15)
    known = _about(np.array(before.joints_px), before.confidence)
    for sures in ((0.6, 0.7), (0.7, 0.6)):
        looks = Looks(monkeypatch, *[looked(sure) for sure in sures])
        told = own_landmarks(PICTURE, seen(BOXED), before)
        assert [is_masked for _, is_masked in looks.shown] == [True, False]
        assert looks.shown[1][0] == known
        assert told.landmarks is not None
        assert told.landmarks.confidence[0] == 0.7


def test_without_a_silhouette_and_a_known_person_nothing_is_looked_at(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looks = Looks(monkeypatch, looked(0.9))
    assert landmarks_by(PICTURE, nobody(), None) is None
    assert looks.shown == []


@pytest.mark.parametrize(("sure", "kept"), [(0.31, 0.31), (0.29, 0.7)])
def test_beside_other_people_the_place_of_before_counts_for_more_than_a_surer_silhouette(
    monkeypatch: pytest.MonkeyPatch, sure: float, kept: float
) -> None:
    before = Landmarks(tuple((200.0 + i, 90.0 + 9 * i) for i in range(15)), (0.9,) * 15)
    Looks(monkeypatch, looked(0.7), looked(sure))
    found = own_landmarks(PICTURE, seen(BOXED), before, crowded=True).landmarks
    assert found is not None
    assert found.confidence[0] == kept


@pytest.mark.parametrize(
    ("sure", "empty", "there"), [(0.31, 0.5, True), (0.29, 0.0, False), (0.9, 0.51, False)]
)
def test_a_look_at_a_window_must_be_sure_that_a_person_is_there(
    monkeypatch: pytest.MonkeyPatch, sure: float, empty: float, there: bool
) -> None:
    looks = Looks(monkeypatch, looked(sure, empty))
    found = look_in(PICTURE, WHOLE)
    assert (found.landmarks is not None, found.person is not None) == (there, there)
    assert found.surety == pytest.approx(sure if there else 0.0)
    assert looks.shown == [(WHOLE, False)]


@pytest.mark.parametrize(
    ("sure", "empty", "there"),
    [(0.31, 0.5, True), (0.29, 0.0, False), (0.9, 0.51, False), (0.6, 0.4, True)],
)
def test_without_an_outline_somebody_must_be_sure_and_likely(
    monkeypatch: pytest.MonkeyPatch, sure: float, empty: float, there: bool
) -> None:
    before = Landmarks(tuple((150.0 + i, 90.0 + 3 * i) for i in range(15)), (0.9,) * 15)
    looks = Looks(monkeypatch, looked(sure, empty))
    found = landmarks_by(PICTURE, nobody(), before)
    assert (found is not None) == there
    known = _about(np.array(before.joints_px), before.confidence)
    assert looks.shown == [(known, False)]


@pytest.mark.parametrize(
    ("sure", "empty", "kept"), [(0.49, 0.09, 0.0), (0.49, 0.08, 0.49), (0.5, 0.9, 0.5)]
)
def test_an_outline_of_nobody_has_no_sure_joints(
    monkeypatch: pytest.MonkeyPatch, sure: float, empty: float, kept: float
) -> None:
    Looks(monkeypatch, looked(sure, empty), looked(0.01))
    found = landmarks_by(PICTURE, seen(BOXED), None)
    assert found is not None
    assert found.confidence == (kept,) * 15
    assert (found.facing_deg, found.facing_confidence) == ((12.0, 0.7) if kept else (0.0, 0.0))


def test_a_trunk_that_leans_in_its_window_is_looked_at_again_upright(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The head is to the right: the window is turned clockwise, about the outline."""
    looks = Looks(monkeypatch, looked(0.6, joints=lying()), looked(0.7, joints=lying()))
    found = landmarks_by(PICTURE, seen(BOXED), None)
    (_, (window, outlined)) = looks.shown
    assert window.turn_deg == pytest.approx(90.0)
    assert outlined
    assert window == turned_window_of(BOXED, window.turn_deg)
    assert found is not None
    assert found.confidence[0] == 0.7
    looks = Looks(monkeypatch, looked(0.6, joints=lying()), looked(0.55))
    found = landmarks_by(PICTURE, seen(BOXED), None)
    assert found is not None
    assert found.confidence[0] == 0.6


def before_lying() -> Landmarks:
    places = Window(20, 20, 218).in_picture(lying())
    return Landmarks(tuple((float(x), float(y)) for x, y in places), (0.9,) * 15)


@pytest.mark.parametrize(
    ("sures", "turns"),
    [((0.6,), (90.0,)), ((0.3, 0.6), (90.0, 90.0)), ((0.3, 0.2, 0.4), (90.0, 90.0, 0.0))],
)
def test_who_lay_is_looked_at_as_they_lay_and_upright_where_that_shows_nobody(
    monkeypatch: pytest.MonkeyPatch, sures: tuple[float, ...], turns: tuple[float, ...]
) -> None:
    """The outline in the turned window, the place of before, the outline as the picture stands."""
    looks = Looks(monkeypatch, *[looked(sure) for sure in sures])
    found = landmarks_by(PICTURE, seen(BOXED), before_lying())
    assert [window.turn_deg for window, _ in looks.shown] == pytest.approx(turns)
    assert [outlined for _, outlined in looks.shown] == [True, False, True][: len(turns)]
    assert found is not None
    assert found.confidence[0] == max(sures)


@pytest.mark.parametrize(("sure", "turns_deg"), [(0.19, [0.0, 90.0, 180.0, 270.0]), (0.2, [0.0])])
def test_an_unsure_look_at_an_unknown_person_is_repeated_in_turned_windows(
    monkeypatch: pytest.MonkeyPatch, sure: float, turns_deg: list[float]
) -> None:
    looks = Looks(monkeypatch, *[looked(each) for each in (sure, 0.1, 0.3, 0.2)])
    found, _ = found_between(PICTURE, np.array([[100.0, 50.0], [130.0, 170.0]]), 0.2)
    assert [window.turn_deg for window, _ in looks.shown][:4] == turns_deg
    assert found.confidence[0] == (0.3 if sure < 0.2 else 0.2)


def test_pictures_of_which_nothing_is_known_are_looked_at_in_the_mirror_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looks = Looks(monkeypatch, looked(0.4), looked(0.6, 0.03), looked(0.7, 0.04))
    found, empty = found_anywhere(PICTURE)
    assert (found.confidence[0], empty) == (0.6, 0.03)
    corners = np.array([[100.0, 50.0], [130.0, 170.0]])
    found, empty = found_between(PICTURE, corners, 0.2)
    assert (found.confidence[0], empty) == (0.7, 0.04)
    assert looks.shown[2] == (window_about(corners, margin=0.2), False)
    assert looks.eyes == [(SHIPPED, True)] * 3


def test_the_next_window_holds_the_joints_that_count() -> None:
    """Surer than 0.15, seven of 15 at least; upright where the trunk does not count."""
    joints = Window(60, 60, 96).in_picture(lying())
    sure = np.zeros(15)
    sure[:7] = 0.16
    window = _about(joints, tuple(sure))
    assert window is not None
    assert window.turn_deg == pytest.approx(90.0)
    assert window == window_about(joints[:7], window.turn_deg, 0.06)
    sure[6] = 0.15
    assert _about(joints, tuple(sure)) is None
    sure[:] = 0.5
    sure[1] = 0.1
    window = _about(joints, tuple(sure))
    assert window is not None
    assert window.turn_deg == 0.0


@pytest.mark.parametrize(("trunk_px", "turn_deg"), [(9.9, 0.0), (10.1, 90.0)])
def test_a_trunk_that_points_at_the_camera_tells_no_lean(trunk_px: float, turn_deg: float) -> None:
    """Shorter than a tenth of the longer side of what holds the joints, 100 px of 40 by 100."""
    joints = np.zeros((15, 2))
    joints[1] = trunk_px, 0.0
    sure = np.array([[0.0, 0.0], [40.0, 100.0]])
    assert _turn_deg(joints, sure) == pytest.approx(turn_deg)
