"""What the integrator makes of cameras that were moved."""

import cv2
import msgspec
import numpy as np
import pytest
from staging import RIG, report

from calibration.gate import moved_cameras
from calibration.gate.moved_cameras import (
    MOVED_LEFT,
    UNCONFIRMED_LEFT,
    MovedCameras,
    told_by,
    turned_rig,
)
from common.bus.instant import Instant
from common.bus.messages import ViewerNumber
from common.rig.camera import arrays_of, project
from common.rig.turned_camera import angle_deg, shift_of, turned
from common.rig.upright import Shift

TURN = np.asarray(cv2.Rodrigues(np.radians([1.0, 3.0, 0.5]))[0])
SHIFT = shift_of(TURN, arrays_of(RIG.cameras[1]).focal_px)


def after(state: MovedCameras, second: Shift | None) -> MovedCameras:
    return moved_cameras.step(state, Instant((report(1), report(2, shift=second))))


def test_a_moved_camera_is_named_and_hardly_anything_is_believed() -> None:
    state = after(MovedCameras(), SHIFT)
    assert state.moved == state.doubtful == (2,)
    assert state.left == MOVED_LEFT
    assert after(MovedCameras(), Shift(0.3, 0.2, 0.1)).doubtful == ()


def test_the_rig_is_turned_as_the_picture_was() -> None:
    rig = turned_rig(RIG, after(MovedCameras(), SHIFT))
    assert rig.cameras[0] == RIG.cameras[0]
    places_m = np.random.default_rng(1).uniform((-0.5, 0.5, -0.5), (0.5, 1.5, 0.5), (9, 3))
    due = project(turned(RIG.cameras[1], TURN), places_m)
    assert project(rig.cameras[1], places_m) == pytest.approx(due)


def test_a_turned_rig_is_half_believed_until_the_person_has_placed_the_camera() -> None:
    state = after(MovedCameras(), SHIFT)
    turned_only = turned_rig(RIG, state)
    state = told_by(state, RIG, turned_only)
    assert (state.moved, state.doubtful, state.left) == ((), (2,), UNCONFIRMED_LEFT)
    state = after(state, SHIFT)
    assert state.doubtful == (2,)
    second = msgspec.structs.replace(turned_only.cameras[1], t=(0.1, 1.0, 4.1))
    placed = msgspec.structs.replace(turned_only, cameras=(turned_only.cameras[0], second))
    state = told_by(state, turned_only, placed)
    assert (state.doubtful, state.left) == ((), 1.0)


def test_a_second_move_turns_the_rig_by_what_is_new() -> None:
    state = after(MovedCameras(), SHIFT)
    rig = turned_rig(RIG, state)
    state = after(told_by(state, RIG, rig), None)
    back = turned_rig(rig, state)
    assert np.array(back.cameras[1].R) == pytest.approx(np.array(RIG.cameras[1].R), abs=1e-9)


@pytest.mark.parametrize("viewer", [1, 2])
def test_a_view_that_is_silent_or_faulty_stands_where_it_was_last_seen(
    viewer: ViewerNumber,
) -> None:
    moved = report(viewer, shift=SHIFT)
    silent = (Instant((moved, None)), Instant((None, moved)))[viewer - 1]
    state = moved_cameras.step(MovedCameras(), silent)
    assert state.moved == (viewer,)
    covered = report(viewer, fault="covered")
    state = moved_cameras.step(state, Instant(((covered, None), (None, covered))[viewer - 1]))
    assert state.moved == (viewer,)


def test_by_what_a_camera_was_turned_since_is_told() -> None:
    none = Shift(0.0, 0.0, 0.0)
    turn = moved_cameras.turn_since(RIG.cameras[1], none, SHIFT)
    assert angle_deg(turn @ TURN.T) == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize(
    ("one", "other", "far_px"),
    [
        (Shift(3.0, 1.0, 0.0), Shift(1.5, 1.2, 0.0), 1.5),
        (Shift(3.0, -1.0, 0.1), Shift(2.5, 1.2, 0.0), 2.2),
        (Shift(0.1, 0.2, -1.0), Shift(0.0, 0.0, 1.5), 80.0 * np.radians(2.5)),
    ],
    ids=["right", "down", "roll"],
)
def test_shifts_are_as_far_apart_as_they_differ_most(
    one: Shift, other: Shift, far_px: float
) -> None:
    """A roll at the edge of a small picture, 80 pixels from its middle."""
    assert moved_cameras.far_px(one, other) == pytest.approx(far_px)
    assert moved_cameras.far_px(other, one) == pytest.approx(far_px)


@pytest.mark.parametrize(("shift_px", "moved"), [(1.0, ()), (1.01, (2,)), (-1.01, (2,))])
def test_a_camera_has_moved_whose_picture_is_off_by_more_than_a_pixel(
    shift_px: float, moved: tuple[ViewerNumber, ...]
) -> None:
    assert after(MovedCameras(), Shift(0.0, shift_px, 0.0)).moved == moved
    rig = turned_rig(RIG, after(MovedCameras(), Shift(0.0, shift_px, 0.0)))
    assert (rig != RIG) is bool(moved)


def test_a_rig_that_is_new_as_a_whole_or_of_a_camera_that_stood_is_confirmed() -> None:
    state = after(MovedCameras(), SHIFT)
    turned_only = turned_rig(RIG, state)
    assert told_by(state, None, turned_only).unconfirmed == ()
    assert told_by(state, None, turned_only).of_rig == state.now
    assert told_by(MovedCameras(), RIG, turned_only).unconfirmed == ()
    both = moved_cameras.step(
        MovedCameras(), Instant((report(1, shift=SHIFT), report(2, shift=SHIFT)))
    )
    assert told_by(both, RIG, turned_rig(RIG, both)).unconfirmed == (1, 2)
    assert told_by(both, RIG, turned_only).unconfirmed == (2,)
