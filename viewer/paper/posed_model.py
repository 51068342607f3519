"""The posed model in one view: scaled orthography around the navel."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from common.body.body import POSE_INDEX, POSE_NAMES, YAW_DEG, Vector
from common.body.kinematics import ALL_LIMBS
from common.body.observation import Facing
from common.bus.messages import ViewerNumber, place_in_rig
from common.raster.bits import Bits, count, pack_words
from common.raster.kernel import CENTRE_X, CENTRE_Y, DEPTH, FOCAL_X, FOCAL_Y, SHIFT, VIEW, match
from common.raster.similarity import Mask
from common.rig.camera import PAPER_ROTATIONS, Camera
from viewer.paper.tritree import search, window


class PosedModel(NamedTuple):
    """A model laid over a silhouette."""

    seen: Bits
    """The silhouette, packed (H, words)."""
    seen_px: int
    width: int
    """Width of the picture, pixels."""
    body: Vector
    pose: Vector
    """The 25 motion parameters; the position is 0, because `view` holds the place in the
    picture."""
    view: Vector
    score: float = 0.0
    matches: int = 0


class Turn(NamedTuple):
    """One angle of a search, and the parameters that follow it."""

    step: Vector
    """(25,): change of each pose parameter with the angle."""
    at: int
    """Index in the pose of the angle itself."""
    moving: int
    """Limbs that move, as bits."""
    parts: tuple[tuple[int, float], ...]
    """The nonzero entries of `step`: (pose parameter, factor)."""


def turn(limbs: tuple[int, ...], **coupled: float) -> Turn:
    """A search direction: pose parameter names with their factors, the leading one first."""
    step = np.zeros(len(POSE_NAMES))
    parts = tuple((POSE_INDEX[name], factor) for name, factor in coupled.items())
    for at, factor in parts:
        step[at] = factor
    return Turn(step, parts[0][0], sum(1 << limb for limb in limbs), parts)


class SearchRange(NamedTuple):
    """Where an angle is searched."""

    width_deg: int
    """Width of the window around the present angle (P41)."""
    stop_deg: int
    """Where the search stops."""
    limits_deg: tuple[float, float]
    """Limits of the joint, or of this posture (P31)."""
    wide: bool = False
    """True where the angle is unknown: search windows then tile the whole range."""


def searched(
    model: PosedModel, how: Turn, within: SearchRange, least_gain: float = -1.0
) -> PosedModel:
    """The model with one angle set to the best that the tritree meets.

    Args:
        model: The model so far.
        how: The angle to turn.
        within: Where to search it.
        least_gain: Smallest gain of the model's score for which the angle changes.
    """
    width_deg, stop_deg, (low, high), wide = within
    centres = np.arange(low + width_deg / 2, high, width_deg) if wide else [model.pose[how.at]]
    best_angle, best_score, matches = model.pose[how.at], -1.0, 0
    for centre in centres:
        bounds = window(float(centre), width_deg, low, high)
        angle, score, more = search(
            model.seen,
            model.seen_px,
            model.width,
            model.body,
            model.pose,
            model.view,
            how.step,
            how.moving,
            *bounds,
            stop_deg,
        )
        matches += more
        if score > best_score:
            best_angle, best_score = angle, score
    if best_score < model.score + least_gain:
        return model._replace(matches=model.matches + matches)
    pose = model.pose.copy()
    for at, factor in how.parts:
        pose[at] = best_angle * factor
    return model._replace(pose=pose, score=best_score, matches=model.matches + matches)


def matched(model: PosedModel) -> PosedModel:
    """The model with the score of the whole body as it stands."""
    body, pose, view = model.body, model.pose, model.view
    value = match(body, pose, view, ALL_LIMBS, model.width, model.seen, model.seen_px)
    return model._replace(score=value, matches=model.matches + 1)


def view_at(rotation: NDArray[np.float64], px_per_m: float, root_px: tuple[float, float]) -> Vector:
    """Scaled orthography: the kernel's view with the navel at a given pixel (section 3.2)."""
    view = np.zeros(VIEW)
    view[:SHIFT] = rotation.ravel()
    view[FOCAL_X] = view[FOCAL_Y] = px_per_m
    view[CENTRE_X], view[CENTRE_Y] = root_px
    view[DEPTH] = 1.0
    return view


def rotation_of(camera: Camera | None, viewer: ViewerNumber) -> NDArray[np.float64]:
    """World to camera: the calibrated rotation, or the paper's for this viewer (C1); for cameras
    that the paper does not have, that of camera 2: no view of theirs is searched."""
    place = min(place_in_rig(viewer), len(PAPER_ROTATIONS) - 1)
    return np.array(PAPER_ROTATIONS[place] if camera is None else camera.R)


def yaw_of(facing: Facing, viewer: ViewerNumber) -> float:
    """Yaw of the trunk, degrees, for a facing in this viewer (P49)."""
    return YAW_DEG[0 if (facing == "facade") == (viewer == 1) else 1]


def model_over(mask: Mask, body: Vector, pose: Vector, view: Vector) -> PosedModel:
    """A model laid over a silhouette, not yet matched."""
    bits = pack_words(mask)
    return PosedModel(bits, count(bits), mask.shape[1], body, pose, view)
