"""One view alone: a fitted stick body becomes a body in the room (thesis 3.1.5; T19 to T22)."""

from collections.abc import Mapping
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body import (
    ANGLE_NAMES,
    ANGLES_IN_POSE,
    JOINT_NAMES,
    LIMBS,
    Vector,
    body_vector,
    rest_pose,
    thesis_bdp,
)
from common.camera import Camera, centre
from common.messages import Body, Facing, Pixel, Point, Status, ViewerNumber
from common.stickman import Stickman
from integrator import signs, smoothing
from integrator.lifting import ENDS, Lifted, Orientation, lift
from integrator.limbs import PLACES, pose_of

LOST_SCORE: Final = 0.35
"""A stick that fits worse than this is not believed."""
LOST_FRAMES: Final = 5
"""After so many frames of it the body is lost."""
UNSEEN: Final = 0.25
"""Share of its confidence that the end of a hidden segment keeps."""
TILTED_DEG: Final = 15.0
"""A segment that leans less hardly moves with its sign."""
TWELVE: Final = [JOINT_NAMES.index(name) for name in PLACES]


class Sight(NamedTuple):
    """The fitted stick body of a frame."""

    frame: int
    captured_s: float
    joints_px: NDArray[np.float64]
    """(15, 2), JOINT_NAMES, r on the left of the picture."""
    breadth: float
    hidden: NDArray[np.bool_]
    """(10,) of LIMBS."""
    score: float
    matches: int
    stature_px: float
    """Height of the person standing upright there."""


class Inputs(NamedTuple):
    """What the user says of a frame (T21, T22)."""

    orientation: Orientation | None = None
    depth: Mapping[str, str] = {}
    """LIMBS name to toward or away."""
    joints_px: Mapping[str, tuple[float, float]] = {}
    """JOINT_NAMES name to its place in the working picture, sides the person's own."""


class State(NamedTuple):
    """What one frame hands to the next."""

    number: ViewerNumber
    camera: Camera
    man: Stickman
    stature_m: float
    perspective: bool
    """Joints nearer to the camera look larger; False: scaled orthography, as printed (T19)."""
    smooth: smoothing.State
    memory: signs.Memory
    pose: Vector | None = None
    last_s: float | None = None
    badly: int = 0


class Settled(NamedTuple):
    """What was decided by itself, and how sure that is (T21, T22)."""

    orientation: str = ""
    orientation_confidence: float = 1.0
    depth_confidence: tuple[float, ...] = (1.0,) * len(LIMBS)


def init(
    number: ViewerNumber,
    camera: Camera,
    man: Stickman,
    stature_m: float,
    perspective: bool,
    period_s: float,
) -> State:
    """A view that has seen nobody."""
    smooth = smoothing.init(len(ANGLE_NAMES), period_s)
    return State(number, camera, man, stature_m, perspective, smooth, signs.init())


def step(state: State, sight: Sight, told: Inputs) -> tuple[State, Body, Settled]:
    """One frame with somebody: signs and orientation, joints in the room, angles.

    Args:
        state: What is remembered.
        sight: The stick body of this frame.
        told: The user's inputs, which go before all else.
    """
    lengths_m = state.man.lengths * state.stature_m
    px_per_m = sight.stature_px / state.stature_m
    picture = (sight.joints_px, sight.breadth, lengths_m, px_per_m)
    choice = signs.choose(state.memory, *picture, told.depth, told.orientation)
    lifted = lift(*picture, choice.signs, choice.orientation)
    memory = signs.remembered(state.memory, lifted.joints_m, choice)
    pixels = _pixels_of(sight, choice)
    for name, place in told.joints_px.items():
        pixels[JOINT_NAMES.index(name)] = place
    joints_m = in_room(state, pixels, lifted, px_per_m)
    body = body_vector(thesis_bdp(state.stature_m))
    before = rest_pose() if state.pose is None else state.pose
    pose = pose_of(joints_m[TWELVE], body, before)
    dt_s = 0.0 if state.last_s is None else max(0.0, sight.captured_s - state.last_s)
    fits = sight.score >= LOST_SCORE
    raw = pose[list(ANGLES_IN_POSE)]
    smooth, angles, _ = smoothing.step(
        state.smooth, raw if fits or state.smooth.P is None else None, dt_s
    )
    state = state._replace(
        smooth=smooth,
        memory=memory,
        pose=pose,
        last_s=sight.captured_s,
        badly=0 if fits else state.badly + 1,
    )
    told_pose = pose.copy()
    told_pose[list(ANGLES_IN_POSE)] = angles
    facing: Facing = "flank" if choice.orientation in ("left", "right") else "facade"
    found = Body(
        frame=sight.frame,
        captured_s=sight.captured_s,
        clock_s=sight.captured_s,
        status=_status(state),
        views="1" if state.number == 1 else "2",
        joints_m=tuple(_point(place) for place in joints_m),
        joints_px=(_pixels(pixels), _pixels(pixels)),
        pose=tuple(told_pose.tolist()),
        angles_raw_deg=tuple(raw.tolist()),
        confidence=_confidence(sight, lifted, choice),
        score=(sight.score, 0.0) if state.number == 1 else (0.0, sight.score),
        facing=(facing, facing),
        bdp=thesis_bdp(state.stature_m),
        matches=sight.matches,
    )
    depth = tuple(float(sure) for sure in choice.confidence)
    return state, found, Settled(choice.orientation, choice.orientation_confidence, depth)


def nobody(state: State, frame: int, captured_s: float) -> tuple[State, Body, Settled]:
    """A frame without anybody: what was learnt of the body is kept, its pose is not."""
    fresh = smoothing.init(len(ANGLE_NAMES), state.smooth.period_s)
    state = state._replace(smooth=fresh, memory=signs.init(), pose=None, badly=0)
    body = Body(
        frame=frame, captured_s=captured_s, clock_s=captured_s, status="empty", views="none"
    )
    return state, body, Settled()


def in_room(
    state: State, pixels: NDArray[np.float64], lifted: Lifted, px_per_m: float
) -> NDArray[np.float64]:
    """The joints in the world, (15, 3) metres, at the depth at which the person is so tall."""
    camera = state.camera
    K = np.array(camera.K)
    depth_m = K[1, 1] / px_per_m
    plane = (pixels - K[:2, 2]) / np.array([K[0, 0], K[1, 1]])
    if any(camera.distortion):
        plane = cv2.undistortPoints(pixels[:, None], K, np.array(camera.distortion))[:, 0]
    towards_m = lifted.joints_m[:, 2]
    depths_m = depth_m - towards_m if state.perspective else np.full(len(pixels), depth_m)
    seen = np.concatenate([plane * depths_m[:, None], (depth_m - towards_m)[:, None]], axis=1)
    room: NDArray[np.float64] = centre(camera) + seen @ np.array(camera.R)
    return room


def _pixels_of(sight: Sight, choice: signs.Choice) -> NDArray[np.float64]:
    """The stick's joints under the person's own sides."""
    if not choice.orientation.startswith("backward"):
        return sight.joints_px.copy()
    swapped = [
        JOINT_NAMES.index({"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:])
        for name in JOINT_NAMES
    ]
    return sight.joints_px[swapped]


def _confidence(sight: Sight, lifted: Lifted, choice: signs.Choice) -> tuple[float, ...]:
    """How sure each joint is: of the fit, of what is hidden, and of the sign where it matters."""
    sure = np.full(len(JOINT_NAMES), min(1.0, max(0.0, sight.score)))
    for limb, (near, far) in enumerate(ENDS):
        own = UNSEEN if sight.hidden[limb] else 1.0
        if abs(lifted.tilt_deg[limb]) > TILTED_DEG:
            own *= float(choice.confidence[limb])
        sure[far] = (sure[near] if limb > 1 else sure[far]) * own
    return tuple(float(value) for value in sure)


def _status(state: State) -> Status:
    if state.badly >= LOST_FRAMES:
        return "lost"
    return "predicted" if state.badly else "tracking"


def _point(place: Vector) -> Point:
    x, y, z = (float(value) for value in place)
    return (x, y, z)


def _pixels(pixels: NDArray[np.float64]) -> tuple[Pixel, ...]:
    return tuple((float(u), float(v)) for u, v in pixels)
