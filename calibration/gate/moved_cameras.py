"""Cameras that are moved while a run goes on: where they stand now, and who has confirmed it."""

from typing import Final, NamedTuple

import msgspec
import numpy as np

from common.body.body import Vector
from common.bus.messages import Report, ViewerNumber
from common.bus.pair import Pair
from common.rig.camera import Camera, Rig, arrays_of
from common.rig.picture_shift import Shift
from common.rig.turned_camera import turn_of, turned

AS_IT_WAS: Final = Shift(0.0, 0.0, 0.0)
OTHERWISE_PX: Final = 1.0
"""Pictures that are shifted by more against each other are of a camera that was moved."""
UNCONFIRMED_LEFT: Final = 0.5
"""Share of the confidence that is left until the person has placed a camera that was moved."""
MOVED_LEFT: Final = 0.05
"""The same while a rig is used that a camera has left."""


class MovedCameras(NamedTuple):
    """What the viewers tell of how their cameras stand."""

    now: tuple[Shift, Shift] = (AS_IT_WAS, AS_IT_WAS)
    """Against the start of the run."""
    of_rig: tuple[Shift, Shift] = (AS_IT_WAS, AS_IT_WAS)
    """The same when the rig in use was told."""
    unconfirmed: tuple[ViewerNumber, ...] = ()
    """Cameras whose place in it was told by their picture alone, as if turned on the spot."""

    @property
    def moved(self) -> tuple[ViewerNumber, ...]:
        """The cameras that the rig in use does not have where they stand."""
        numbers: tuple[ViewerNumber, ...] = (1, 2)
        return tuple(
            n
            for n, now, before in zip(numbers, self.now, self.of_rig, strict=True)
            if far_px(now, before) > OTHERWISE_PX
        )

    @property
    def doubtful(self) -> tuple[ViewerNumber, ...]:
        """These, and those whose new place nobody has confirmed."""
        both = {*self.moved, *self.unconfirmed}
        numbers: tuple[ViewerNumber, ...] = (1, 2)
        return tuple(n for n in numbers if n in both)

    @property
    def left(self) -> float:
        """Share of the confidence that is left."""
        if self.moved:
            return MOVED_LEFT
        return UNCONFIRMED_LEFT if self.unconfirmed else 1.0


def far_px(one: Shift, other: Shift) -> float:
    """How far two shifts are apart, at the edge of a small picture."""
    roll_px = 80.0 * abs(np.radians(one.roll_deg - other.roll_deg))
    return float(max(abs(one.right_px - other.right_px), abs(one.down_px - other.down_px), roll_px))


def step(state: MovedCameras, pair: Pair) -> MovedCameras:
    """One instant more."""
    first, second = (
        before if report is None or report.fault else _shift(report)
        for report, before in zip(pair, state.now, strict=True)
    )
    return state._replace(now=(first, second))


def _shift(report: Report) -> Shift:
    return AS_IT_WAS if report.shift is None else report.shift


def told_by(state: MovedCameras, before: Rig | None, rig: Rig) -> MovedCameras:
    """The same from a new rig on: what of it is the cameras' turn alone is not confirmed."""
    unconfirmed: tuple[ViewerNumber, ...] = ()
    if before is not None:
        numbers: tuple[ViewerNumber, ...] = (1, 2)
        unconfirmed = tuple(
            n
            for n, old, new in zip(numbers, before.cameras, rig.cameras, strict=True)
            if old != new and stays(old, new) and n in state.moved
        )
    return state._replace(of_rig=state.now, unconfirmed=unconfirmed)


def stays(old: Camera, new: Camera) -> bool:
    """Whether a camera is at the same place, however it is turned."""
    return bool(np.allclose(arrays_of(old).centre, arrays_of(new).centre, atol=1e-6))


def turned_rig(rig: Rig, state: MovedCameras) -> Rig:
    """The rig with its cameras turned where they stand, as their pictures tell."""
    cameras = tuple(
        turned(camera, turn_since(camera, before, now))
        if far_px(now, before) > OTHERWISE_PX
        else camera
        for camera, before, now in zip(rig.cameras, state.of_rig, state.now, strict=True)
    )
    return msgspec.structs.replace(rig, cameras=cameras)


def turn_since(camera: Camera, before: Shift, now: Shift) -> Vector:
    """(3, 3) by which what a camera sees has turned from one shift of its picture to another."""
    focal_px = arrays_of(camera).focal_px
    return np.asarray(turn_of(now, focal_px) @ turn_of(before, focal_px).T, float)
