"""Cameras moved during a run: their current pose, and which poses the person has confirmed."""

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
"""Factor on the confidence until the person has placed a moved camera."""
MOVED_LEFT: Final = 0.05
"""Factor on the confidence while the rig in use is out of date for a camera."""


class MovedCameras(NamedTuple):
    """The viewers' reports of their cameras' shifts."""

    now: tuple[Shift, ...] = (AS_IT_WAS, AS_IT_WAS)
    """Shift of each camera's picture since the start of the run."""
    of_rig: tuple[Shift, ...] = (AS_IT_WAS, AS_IT_WAS)
    """Shift of each camera's picture when the rig in use was computed."""
    unconfirmed: tuple[ViewerNumber, ...] = ()
    """Cameras whose pose in it comes from their picture alone, as a pure rotation."""

    @property
    def moved(self) -> tuple[ViewerNumber, ...]:
        """The cameras whose pose in the rig in use is out of date."""
        shifts = zip(self.now, self.of_rig, strict=True)
        return tuple(
            n
            for n, (now, before) in enumerate(shifts, start=1)
            if far_px(now, before) > OTHERWISE_PX
        )

    @property
    def doubtful(self) -> tuple[ViewerNumber, ...]:
        """The outdated cameras, and those whose new pose is not confirmed."""
        return tuple(sorted({*self.moved, *self.unconfirmed}))

    @property
    def left(self) -> float:
        """Factor on the confidence."""
        if self.moved:
            return MOVED_LEFT
        return UNCONFIRMED_LEFT if self.unconfirmed else 1.0


def far_px(one: Shift, other: Shift) -> float:
    """Distance between two shifts, at the edge of a small picture."""
    roll_px = 80.0 * abs(np.radians(one.roll_deg - other.roll_deg))
    return float(max(abs(one.right_px - other.right_px), abs(one.down_px - other.down_px), roll_px))


def init(cameras: int) -> MovedCameras:
    """The state for that many cameras, none moved."""
    return MovedCameras((AS_IT_WAS,) * cameras, (AS_IT_WAS,) * cameras)


def step(state: MovedCameras, instant: Instant) -> MovedCameras:
    """Process one instant."""
    now = tuple(
        before if view is None or view.fault else _shift(view)
        for view, before in zip(instant.views, state.now, strict=True)
    )
    return state._replace(now=now)


def _shift(view: View) -> Shift:
    return AS_IT_WAS if view.shift is None else view.shift


def told_by(state: MovedCameras, before: Rig | None, rig: Rig) -> MovedCameras:
    """The state from a new rig on; cameras placed by rotation alone are unconfirmed."""
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
    """Whether a camera has the same position, however it is turned."""
    return bool(np.allclose(arrays_of(old).centre, arrays_of(new).centre, atol=1e-6))


def turned_rig(rig: Rig, state: MovedCameras) -> Rig:
    """The rig with its cameras turned in place, as their pictures show."""
    cameras = tuple(
        turned(camera, turn_since(camera, before, now))
        if far_px(now, before) > OTHERWISE_PX
        else camera
        for camera, before, now in zip(rig.cameras, state.of_rig, state.now, strict=True)
    )
    return msgspec.structs.replace(rig, cameras=cameras)


def turn_since(camera: Camera, before: Shift, now: Shift) -> Vector:
    """(3, 3) rotation of the scene in a camera's axes between two shifts of its picture."""
    focal_px = arrays_of(camera).focal_px
    return np.asarray(turn_of(now, focal_px) @ turn_of(before, focal_px).T, float)
