"""The viewer's own landmarks: found where the outline is, and where there is none."""

from functools import lru_cache
from unittest.mock import Mock

import cv2
import numpy as np
import pytest

from common.body.body import JOINT_NAMES
from common.bus.messages import Box, Landmarks
from common.raster.similarity import Mask
from common.rig.camera import project
from common.video.decoding import Image
from synth.motion.motions import MOTION, performance
from synth.person.people import person
from synth.person.skeleton import JOINTS
from synth.picture.exposure import default_rig
from synth.picture.render import Shot, render
from viewer.landmarks.landmark_network import find
from viewer.landmarks.own_landmarks import own_landmarks
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
    empty = next(shots).frame1
    shot = next(shot for i, shot in enumerate(shots, 1) if i == at)
    joints_px = project(RIG.cameras[0], motion.joints_m[at, PICK])
    focal, far_m = RIG.cameras[0].K[0][0], 4.5
    return shot, joints_px, focal * someone.measures["stature_m"] / far_m, empty


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


def test_the_joints_of_somebody_with_an_outline_are_found() -> None:
    shot = acted()[0]
    assert off(own_landmarks(shot.frame1, seen(shot.mask1), None)) < 0.03


def test_somebody_without_an_outline_is_found_in_all_of_the_picture() -> None:
    assert off(own_landmarks(acted()[0].frame1, nobody(), None)) < 0.05


def test_an_outline_that_is_elsewhere_does_not_lead_astray() -> None:
    wrong = np.zeros((240, 320), np.bool_)
    wrong[60:200, 5:50] = True
    assert off(own_landmarks(acted()[0].frame1, seen(wrong), None)) < 0.05


def test_in_an_empty_room_nobody_is_seen() -> None:
    assert own_landmarks(acted()[3], nobody(), None) is None


def test_an_outline_of_which_the_picture_shows_nobody_has_landmarks_that_are_not_sure_at_all() -> (
    None
):
    """A door that opened: the outline is there, and as tall as a person."""
    door = acted()[3].copy()
    cv2.rectangle(door, (200, 40), (250, 190), (60, 90, 130), cv2.FILLED)
    mask = np.zeros((240, 320), np.bool_)
    mask[40:190, 200:250] = True
    found = own_landmarks(door, seen(mask), None)
    assert found is not None
    assert (max(found.confidence), found.facing_confidence) == (0.0, 0.0)


def test_whoever_faces_the_camera_is_told_to() -> None:
    shot = acted()[0]
    found = own_landmarks(shot.frame1, seen(shot.mask1), None)
    assert found is not None
    assert abs(found.facing_deg) < 45
    assert found.facing_confidence > 0.5


def test_a_grey_and_tiny_picture_is_looked_at_too() -> None:
    shot, joints_px, stature_px, _ = acted()
    small = cv2.resize(shot.frame1, (160, 120), interpolation=cv2.INTER_AREA)
    grey = cv2.cvtColor(cv2.cvtColor(small, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)
    mask = cv2.resize(shot.mask1.astype(np.uint8), (160, 120)) > 0
    found = own_landmarks(np.asarray(grey, np.uint8), seen(mask), None)
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
    picture = np.array(np.rot90(shot.frame1, times), np.uint8)
    outline = seen(np.array(np.rot90(shot.mask1, times), np.bool_))
    looks = Mock(wraps=find)
    monkeypatch.setattr("viewer.landmarks.own_landmarks.find", looks)
    found = None
    for more in (4, 1):
        looks.reset_mock()
        found = own_landmarks(picture, outline, found)
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
    found = own_landmarks(shot.frame1, seen(shot.mask1), before)
    assert off(found) < 0.03
