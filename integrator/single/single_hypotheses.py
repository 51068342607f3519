"""Bodies that one silhouette may show: the stick body lifted, and what the outline proposes."""

import math
from collections.abc import Mapping
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from common.body.body import JOINT_NAMES, LIMB_ENDS, LIMBS, Bdp, Vector, rest_pose
from common.body.proportions import body_vector
from common.body.stick_body import Stickman
from common.bus.messages import (
    Fit,
    Report,
    ViewerNumber,
)
from common.notes.notes import Orientation
from common.rig.camera import Camera, Rig, arrays_of, centre, ray
from integrator.fit import joint_refinement
from integrator.pose import joint_limits, smoothing
from integrator.pose.inverse_kinematics import PLACES, pose_of
from integrator.proposal import pose_network, pose_proposal
from integrator.rig.undistortion import undistorted_camera as straight_camera
from integrator.rig.undistortion import undistorted_report as straight_report
from integrator.rig.undistortion import undistorted_rig as straight_rig
from integrator.single import depth_signs, reflection
from integrator.single.lifting import SWAPPED, Lifted, lift
from integrator.single.reflection import Front

UNSEEN: Final = 0.25
"""Share of its confidence that the end of a hidden segment keeps."""
TILTED_DEG: Final = 15.0
"""A segment that leans less hardly moves with its sign."""
TOWARDS: Final = (1.0, -1.0, -1.0)
"""From a camera's axes to those of `Lifted`: up, and to the camera."""
TWELVE: Final = [JOINT_NAMES.index(name) for name in PLACES]
CROWN: Final = 0.155
"""How far the crown lies above the neck, in statures: 0.15 to 0.17 of r01, r04 and made-up people
whose arms are not raised."""
PELVIS, NECK, HEAD = (JOINT_NAMES.index(name) for name in ("pelvis", "neck", "head_top"))


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
    bdp: Bdp
    stature_m: float
    printed: bool
    """As the thesis prints it: scaled orthography (T19), and nothing is proposed."""
    smooth: smoothing.State
    memory: depth_signs.Memory
    recall: pose_proposal.Memory | None = None
    """What the proposals remember."""
    front: Front = Front()
    pose: Vector | None = None
    last_s: float | None = None
    badly: int = 0


class Settled(NamedTuple):
    """What was decided by itself, and how sure that is (T21, T22)."""

    orientation: str = ""
    orientation_confidence: float = 1.0
    depth_confidence: tuple[float, ...] = (1.0,) * len(LIMBS)
    depth_error_deg: tuple[float, ...] = (math.nan,) * len(LIMBS)
    """How far a segment's angle out of the picture changes with a pixel of its length (T19); NaN
    where the pose was not lifted from its segments."""


class Hypothesis(NamedTuple):
    """A body that one silhouette may show."""

    joints_m: NDArray[np.float64]
    """(15, 3) world."""
    pose: Vector
    score: float
    """S of its parts in the picture."""
    confidence: Vector
    """(15,)"""
    settled: Settled


def lifted_body(state: State, report: Report, told: Inputs) -> tuple[State, Hypothesis]:
    """The stick body in the room, its signs and orientation chosen or told."""
    fit = report.fit
    assert fit is not None
    lengths_m = state.man.lengths * state.stature_m
    px_per_m = fit.stature_px / state.stature_m
    picture = (np.array(fit.joints_px), fit.breadth, lengths_m, px_per_m)
    choice = depth_signs.choose(state.memory, *picture, told.depth, told.orientation)
    lifted = lift(*picture, choice.signs, choice.orientation)
    memory = depth_signs.remembered(state.memory, lifted.joints_m, choice)
    state = state._replace(memory=memory)
    pixels = _own_sides(picture[0], choice)
    for name, place in told.joints_px.items():
        pixels[JOINT_NAMES.index(name)] = place
    joints_m = in_room(state, pixels, lifted, px_per_m)
    pose, joints_m = _posed(state, joints_m, told)
    score = fit.score
    if not state.printed:
        score = _match(state, pose, joints_m, report, turning=False).score
    depth = tuple(float(sure) for sure in choice.confidence)
    errors = tuple(float(error) for error in lifted.error_deg)
    settled = Settled(choice.orientation, choice.orientation_confidence, depth, errors)
    return state, Hypothesis(joints_m, pose, score, _sure(fit, lifted, choice), settled)


def proposed_body(
    state: State, report: Report, told: Inputs, dt_s: float
) -> tuple[State, Hypothesis | None]:
    """What the outline proposes, or what has the same outline and agrees with all else.

    None where that faces another side than the user says.
    """
    straight = straight_report(report, state.camera)
    seen = (straight, None) if state.number == 1 else (None, straight)
    rig = straight_rig(Rig(report.width, report.height, (state.camera, state.camera)))
    known = pose_proposal.step(state.recall, state.bdp, rig, seen, dt_s)
    joints_m = _with_trunk(state, known.joints_m)
    yaw = reflection.yaw_deg(state.camera, joints_m)
    front, behind = reflection.front_of(state.front, yaw, told.orientation, dt_s)
    state = state._replace(recall=known.memory, front=front)
    if behind:
        joints_m = reflection.seen_from_behind(state.camera, joints_m)
        yaw = reflection.yaw_deg(state.camera, joints_m)
    if told.orientation and not reflection.agrees(yaw, told.orientation):
        return state, None
    joints_m = reflection.leaning(state.camera, joints_m, told.depth)
    for name, place in told.joints_px.items():
        at = JOINT_NAMES.index(name)
        joints_m[at] = _at_depth(state.camera, place, joints_m[at])
    pose, joints_m = _posed(state, joints_m, told)
    found = _match(state, pose, joints_m, report, turning=False)
    depth = tuple(float(sure) for sure in known.sure[LIMB_ENDS[:, 1]])
    facing = told.orientation or reflection.faces(reflection.yaw_deg(state.camera, found.joints_m))
    settled = Settled(facing, 1.0 if told.orientation else float(known.sure[PELVIS]), depth)
    return state, Hypothesis(found.joints_m, found.pose, found.score, known.sure, settled)


def settled_body(state: State, report: Report, found: Hypothesis, told: Inputs) -> Hypothesis:
    """The hypothesis that was taken, its parts turned to where the outline has them."""
    turning = not told.joints_px
    match = _match(state, found.pose, found.joints_m, report, turning)
    return found._replace(joints_m=match.joints_m, pose=match.pose, score=match.score)


def remembered(state: State, found: Hypothesis) -> State:
    """Where segments point and the body faces, for the frames whose outline needs a stick body."""
    seen_m = found.joints_m @ arrays_of(state.camera).R.T * TOWARDS
    facing = reflection.faces(reflection.yaw_deg(state.camera, found.joints_m))
    sure = found.settled.orientation_confidence
    return state._replace(memory=depth_signs.witnessed(state.memory, seen_m, facing, sure))


def _with_trunk(state: State, found: NDArray[np.float64]) -> NDArray[np.float64]:
    """The 15 joints of 12 that are proposed, neck and crown in line with the trunk."""
    joints_m = np.empty((len(JOINT_NAMES), 3))
    joints_m[pose_proposal.AT] = found
    joints_m[PELVIS] = found[pose_network.HIPS].mean(axis=0)
    middle = found[pose_network.SHOULDERS].mean(axis=0)
    up = (middle - joints_m[PELVIS]) / max(float(np.linalg.norm(middle - joints_m[PELVIS])), 1e-9)
    joints_m[NECK] = middle + up * state.man.lengths[11] * state.stature_m
    joints_m[HEAD] = joints_m[NECK] + up * CROWN * state.stature_m
    return joints_m


def _posed(
    state: State, joints_m: NDArray[np.float64], told: Inputs
) -> tuple[Vector, NDArray[np.float64]]:
    """The pose of joints, within the limits that joints have unless the user said where they are.

    The print has limits in the picture's plane alone.
    """
    before, body = rest_pose() if state.pose is None else state.pose, body_vector(state.bdp)
    pose: Vector = pose_of(joints_m[TWELVE], body, before)
    if state.printed or told.joints_px:
        return pose, joints_m
    return joint_limits.within(body, pose, before, joints_m)


def _match(
    state: State, pose: Vector, joints_m: NDArray[np.float64], report: Report, turning: bool
) -> joint_refinement.Match:
    camera, straight = straight_camera(state.camera), straight_report(report, state.camera)
    start = joint_refinement.PosedBody(pose, joints_m)
    return joint_refinement.matched(camera, state.bdp, state.man, straight, start, turning)


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
    depths_m = depth_m - towards_m if not state.printed else np.full(len(pixels), depth_m)
    seen = np.concatenate([plane * depths_m[:, None], (depth_m - towards_m)[:, None]], axis=1)
    room: NDArray[np.float64] = centre(camera) + seen @ np.array(camera.R)
    return room


def _at_depth(camera: Camera, pixel: tuple[float, float], place_m: Vector) -> NDArray[np.float64]:
    """What a pixel shows at the depth of a place."""
    forward = np.array(camera.R)[2]
    depth_m = float(forward @ (place_m - centre(camera)))
    along = ray(camera, pixel)
    found: NDArray[np.float64] = centre(camera) + along * depth_m / float(forward @ along)
    return found


def _own_sides(joints_px: NDArray[np.float64], choice: depth_signs.Choice) -> NDArray[np.float64]:
    """The stick's joints under the person's own sides."""
    return joints_px[SWAPPED] if choice.orientation.startswith("backward") else joints_px.copy()


def _sure(fit: Fit, lifted: Lifted, choice: depth_signs.Choice) -> Vector:
    """How sure each joint is: of the fit, of what is hidden, and of the sign where it matters."""
    sure = np.full(len(JOINT_NAMES), fit.score)
    for limb, (near, far) in enumerate(LIMB_ENDS):
        own = UNSEEN if fit.hidden[limb] else 1.0
        if abs(lifted.tilt_deg[limb]) > TILTED_DEG:
            own *= float(choice.confidence[limb])
        sure[far] = (sure[near] if limb > 1 else sure[far]) * own
    return sure
