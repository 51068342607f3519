"""Cameras that are moved while a run goes on: where they stand now, and who has confirmed it."""

from typing import Final, NamedTuple

import msgspec
import numpy as np

from common.body.body import Vector
from common.bus.instant import Instant
from common.bus.messages import View, ViewerNumber
from common.rig.camera import Camera, Rig, arrays_of
from common.rig.turned_camera import turn_of, turned
from common.rig.upright import Shift

AS_IT_WAS: Final = Shift(0.0, 0.0, 0.0)
OTHERWISE_PX: Final = 1.0
"""Shift between two pictures of a camera, pixels, above which the camera was moved."""
UNCONFIRMED_LEFT: Final = 0.5
"""Share of the confidence that is left until the person has placed a camera that was moved."""
MOVED_LEFT: Final = 0.05
"""Share of the confidence that is left while the rig in use is one that a camera has left."""


class MovedCameras(NamedTuple):
    """What the viewers report of how their cameras stand."""

    now: tuple[Shift, ...] = (AS_IT_WAS, AS_IT_WAS)
    """Shift of each camera's picture since the start of the run."""
    of_rig: tuple[Shift, ...] = (AS_IT_WAS, AS_IT_WAS)
    """Shift of each camera's picture when the rig in use was computed."""
    unconfirmed: tuple[ViewerNumber, ...] = ()
    """Cameras whose place in it comes from their picture alone, as if they had turned on the
    spot."""

    @property
    def moved(self) -> tuple[ViewerNumber, ...]:
        """The cameras that the rig in use does not have where they stand."""
        shifts = zip(self.now, self.of_rig, strict=True)
        return tuple(
            n
            for n, (now, before) in enumerate(shifts, start=1)
            if far_px(now, before) > OTHERWISE_PX
        )

    @property
    def doubtful(self) -> tuple[ViewerNumber, ...]:
        """These, and those whose new place is not confirmed."""
        return tuple(sorted({*self.moved, *self.unconfirmed}))

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


def init(cameras: int) -> MovedCameras:
    """So many cameras stand as they stood."""
    return MovedCameras((AS_IT_WAS,) * cameras, (AS_IT_WAS,) * cameras)


def step(state: MovedCameras, instant: Instant) -> MovedCameras:
    """One instant more."""
    now = tuple(
        before if view is None or view.fault else _shift(view)
        for view, before in zip(instant.views, state.now, strict=True)
    )
    return state._replace(now=now)


def _shift(view: View) -> Shift:
    return AS_IT_WAS if view.shift is None else view.shift


def told_by(state: MovedCameras, before: Rig | None, rig: Rig) -> MovedCameras:
    """The same from a new rig on: what of it is the cameras' turn alone is not confirmed."""
    unconfirmed: tuple[ViewerNumber, ...] = ()
    if before is not None:
        cameras = zip(before.cameras, rig.cameras, strict=True)
        unconfirmed = tuple(
            n
            for n, (old, new) in enumerate(cameras, start=1)
            if old != new and stays(old, new) and n in state.moved
        )
    return state._replace(of_rig=state.now, unconfirmed=unconfirmed)


def stays(old: Camera, new: Camera) -> bool:
    """Whether a camera is at the same place, however it is turned."""
    return bool(np.allclose(arrays_of(old).centre, arrays_of(new).centre, atol=1e-6))


def turned_rig(rig: Rig, state: MovedCameras) -> Rig:
    """The rig with its cameras turned where they stand, as their pictures show."""
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
