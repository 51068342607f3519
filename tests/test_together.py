"""Viewers of a clip: each is given its own camera, and who was seen before its first frame."""

import numpy as np
import pytest

from common.body.observation import Landmarks
from common.bus.messages import ViewerNumber
from common.config.settings import Settings
from common.method import DEFAULT, PAPER, Method
from common.rig.camera import Camera, Rig
from common.video.clip_facts import Clip, ClipView, Meta
from runtime.steps.together import viewer_of
from viewer.background.background import learn

SIZE = (80, 60)
EMPTY = learn([np.full((60, 80, 3), 90, np.uint8)])
SOMEBODY = Landmarks(tuple((10.0 + n, 2.0 * n) for n in range(15)), (0.8,) * 15)


def camera(name: str, focal_px: float) -> Camera:
    K = ((focal_px, 0.0, 40.0), (0.0, focal_px, 30.0), (0.0, 0.0, 1.0))
    R = ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
    return Camera(name=name, K=K, R=R, t=(0.0, 1.0, 4.0))


FIRST, SECOND = camera("cam1", 90.0), camera("cam2", 110.0)


def clip_of(*numbers: ViewerNumber, calibrated: bool = True) -> Clip:
    views = tuple(ClipView(n, f"cam{n}.avi", SIZE, SIZE, 15.0, 60) for n in numbers)
    own = tuple((FIRST, SECOND)[n - 1] for n in numbers)
    return Clip("walk", views, 1, Rig(*SIZE, own) if calibrated else None, Meta())


@pytest.mark.parametrize("numbers", [(1, 2), (1,), (2,)])
def test_each_viewer_has_the_camera_of_its_own_number(numbers: tuple[ViewerNumber, ...]) -> None:
    clip = clip_of(*numbers)
    for view in clip.views:
        setup = viewer_of(view, clip, Settings(), DEFAULT, EMPTY).setup
        assert setup.viewer == view.number
        assert setup.camera == (FIRST, SECOND)[view.number - 1]
        assert setup.alone == (len(numbers) == 1)


def test_a_viewer_without_a_calibration_has_no_camera() -> None:
    clip = clip_of(1, 2, calibrated=False)
    assert viewer_of(clip.views[1], clip, Settings(), DEFAULT, EMPTY).setup.camera is None


@pytest.mark.parametrize(("method", "kept"), [(DEFAULT, SOMEBODY), (PAPER, None)])
def test_who_was_seen_before_is_remembered_where_landmarks_are_looked_for(
    method: Method, kept: Landmarks | None
) -> None:
    clip = clip_of(1, 2)
    state = viewer_of(clip.views[0], clip, Settings(), method, EMPTY, SOMEBODY)
    assert state.landmarks.known == kept
    assert state.setup.method is method
    assert viewer_of(clip.views[0], clip, Settings(), method, EMPTY).landmarks.known is None
